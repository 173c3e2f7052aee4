#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <tuple>

namespace stackmesh::shapes {

void add_quad(InterfaceComplex& complex, int a, int b, int c, int d, Label below, Label above) {
  complex.triangles.push_back({{a, b, c}, below, above});
  complex.triangles.push_back({{a, c, d}, below, above});
}

InterfaceComplex voxels(int nx, int ny, int nz, Vec3 spacing, const std::function<Label(int, int, int)>& label) {
  InterfaceComplex complex;
  std::map<std::array<int, 3>, int> ids;
  const auto at = [&](int i, int j, int k) -> Label {
    return i < 0 || j < 0 || k < 0 || i >= nx || j >= ny || k >= nz ? 0 : label(i, j, k);
  };
  const auto id = [&](int i, int j, int k) {
    const auto [it, isnew] = ids.try_emplace({i, j, k}, static_cast<int>(complex.points.size()));
    if (isnew) complex.points.push_back({i * spacing.x, j * spacing.y, k * spacing.z});
    return it->second;
  };
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i) {
        const Label here = at(i, j, k);
        if (const Label b = at(i - 1, j, k); b != here)
          add_quad(complex, id(i, j, k), id(i, j + 1, k), id(i, j + 1, k + 1), id(i, j, k + 1), b, here);
        if (const Label b = at(i, j - 1, k); b != here)
          add_quad(complex, id(i, j, k), id(i, j, k + 1), id(i + 1, j, k + 1), id(i + 1, j, k), b, here);
        if (const Label b = at(i, j, k - 1); b != here)
          add_quad(complex, id(i, j, k), id(i + 1, j, k), id(i + 1, j + 1, k), id(i, j + 1, k), b, here);
      }
  return complex;
}

void add_box(InterfaceComplex& complex, Vec3 low, Vec3 high, Label inside, Label outside) {
  const int o = static_cast<int>(complex.points.size());
  for (int i = 0; i < 8; ++i)
    complex.points.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  add_quad(complex, o + 0, o + 2, o + 3, o + 1, inside, outside);
  add_quad(complex, o + 4, o + 5, o + 7, o + 6, inside, outside);
  add_quad(complex, o + 0, o + 1, o + 5, o + 4, inside, outside);
  add_quad(complex, o + 2, o + 6, o + 7, o + 3, inside, outside);
  add_quad(complex, o + 0, o + 4, o + 6, o + 2, inside, outside);
  add_quad(complex, o + 1, o + 3, o + 7, o + 5, inside, outside);
}

InterfaceComplex sphere(int levels, double radius, Label inside, Label outside) {
  InterfaceComplex c;
  const double g = (1 + std::sqrt(5.0)) / 2;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-g, g})
      for (const Vec3 p : {Vec3{0, a, b}, Vec3{a, b, 0}, Vec3{b, 0, a}}) c.points.push_back(p);
  for (int i = 0; i < 12; ++i)  // faces: three points two apart from each other
    for (int j = i + 1; j < 12; ++j)
      for (int k = j + 1; k < 12; ++k) {
        const Vec3 p = c.points[i], q = c.points[j], r = c.points[k];
        if (std::max({norm(p - q), norm(q - r), norm(r - p)}) > 2.1) continue;
        const bool outward = dot(p, cross(q, r)) > 0;
        c.triangles.push_back({{i, outward ? j : k, outward ? k : j}, inside, outside});
      }
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [at, fresh] = middles.insert({std::minmax(a, b), static_cast<int>(c.points.size())});
      if (fresh) c.points.push_back(0.5 * (c.points[a] + c.points[b]));
      return at->second;
    };
    std::vector<InterfaceTriangle> finer;
    for (const auto& t : c.triangles) {
      const int ab = middle(t.v[0], t.v[1]), bc = middle(t.v[1], t.v[2]), ca = middle(t.v[2], t.v[0]);
      for (const auto& v :
           {std::array{t.v[0], ab, ca}, std::array{t.v[1], bc, ab}, std::array{t.v[2], ca, bc}, std::array{ab, bc, ca}})
        finer.push_back({{v[0], v[1], v[2]}, inside, outside});
    }
    c.triangles = finer;
    for (Vec3& p : c.points) p = (1 / norm(p)) * p;
  }
  for (Vec3& p : c.points) p = (radius / norm(p)) * p;
  return c;
}

std::map<Label, double> volumes(const TetMesh& mesh) {
  std::map<Label, double> out;
  for (std::size_t i = 0; i < mesh.tets.size(); ++i) {
    const auto& t = mesh.tets[i];
    const Vec3 a = mesh.points[t[0]];
    out[mesh.labels[i]] += dot(mesh.points[t[1]] - a, cross(mesh.points[t[2]] - a, mesh.points[t[3]] - a)) / 6;
  }
  return out;
}

void expect_fills(const TetMesh& mesh, const InterfaceComplex& complex) {
  ASSERT_GE(mesh.points.size(), complex.points.size());
  EXPECT_EQ(0, std::memcmp(mesh.points.data(), complex.points.data(), complex.points.size() * sizeof(Vec3)));
  ASSERT_EQ(mesh.labels.size(), mesh.tets.size());
  ASSERT_EQ(mesh.faces.size(), complex.triangles.size());

  // Every tet face, as its corners sorted, with the sign of its order and the label behind it.
  struct Side {
    std::array<int, 3> key;
    int sign;
    Label label;
  };
  const auto side = [](int a, int b, int c, Label label) {
    std::array<int, 3> key = {a, b, c};
    int sign = 1;
    for (const auto& [i, j] : {std::pair{0, 1}, {1, 2}, {0, 1}})
      if (key[i] > key[j]) std::swap(key[i], key[j]), sign = -sign;
    return Side{key, sign, label};
  };
  std::vector<Side> sides;
  std::vector<bool> used(mesh.points.size(), false);
  std::size_t inverted = 0, background = 0;
  for (std::size_t i = 0; i < mesh.tets.size(); ++i) {
    const auto& t = mesh.tets[i];
    const Vec3 a = mesh.points[t[0]];
    inverted += !(dot(mesh.points[t[1]] - a, cross(mesh.points[t[2]] - a, mesh.points[t[3]] - a)) > 0);
    background += mesh.labels[i] == 0;
    for (const int v : t) used[v] = true;
    // outward
    sides.push_back(side(t[0], t[2], t[1], mesh.labels[i]));
    sides.push_back(side(t[0], t[1], t[3], mesh.labels[i]));
    sides.push_back(side(t[1], t[2], t[3], mesh.labels[i]));
    sides.push_back(side(t[0], t[3], t[2], mesh.labels[i]));
  }
  EXPECT_EQ(inverted, 0u);
  EXPECT_EQ(background, 0u);
  for (std::size_t i = complex.points.size(); i < mesh.points.size(); ++i)
    EXPECT_TRUE(used[i]) << "added point " << i << " belongs to no tet";

  // A triangle's `below` must look out through it, its `above` through its back: together with the tets' own
  // sides they cancel in pairs, unless both tets have one label.
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.key, a.label, a.sign) < std::tie(b.key, b.label, b.sign);
  });
  std::map<std::array<int, 3>, std::vector<Side>> boundary;
  std::size_t unpaired = 0;
  for (std::size_t i = 0, j = 0; i < sides.size(); i = j) {
    for (; j < sides.size() && sides[j].key == sides[i].key; ++j) {
    }
    if (j - i == 2 && sides[i].label == sides[i + 1].label && sides[i].sign != sides[i + 1].sign) continue;
    unpaired += j - i > 2;
    for (std::size_t s = i; s < j; ++s) boundary[sides[s].key].push_back(sides[s]);
  }
  EXPECT_EQ(unpaired, 0u);
  std::size_t wrong = 0;
  for (const InterfaceTriangle& f : mesh.faces) {
    if (f.below == f.above) continue;
    for (const Side& expected : {side(f.v[0], f.v[1], f.v[2], f.below), side(f.v[0], f.v[2], f.v[1], f.above)}) {
      if (expected.label == 0) continue;
      auto& found = boundary[expected.key];
      const auto it = std::find_if(found.begin(), found.end(),
                                   [&](const Side& s) { return s.sign == expected.sign && s.label == expected.label; });
      if (it == found.end()) {
        ++wrong;
      } else {
        found.erase(it);
      }
    }
  }
  for (const auto& [key, left] : boundary) wrong += left.size();
  EXPECT_EQ(wrong, 0u) << "tet faces that bound a label but are no triangle of the complex, or the reverse";
}

}  // namespace stackmesh::shapes
