#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <random>
#include <set>

#include "base/error.h"
#include "shapes.h"
#include "volume/fill_volume.h"
#include "volume/raise_order.h"

namespace stackmesh {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

TetMesh fill(const InterfaceComplex& complex) {
  FillOptions options;
  options.radius_edge = 1.4;
  FillResult result = fill_volume(complex, options);
  EXPECT_EQ(result.status, FillResult::Status::verified) << result.message;
  return std::move(result.mesh);
}

/// x(l) of a 10-node tet, straight from the shape functions.
Vec3 place(const TetMesh& mesh, std::size_t t, const std::array<double, 4>& l) {
  Vec3 x;
  for (int i = 0; i < 4; ++i) x = x + l[i] * (2 * l[i] - 1) * mesh.points[mesh.tets[t][i]];
  for (int k = 0; k < 6; ++k) x = x + 4 * l[kEdges[k][0]] * l[kEdges[k][1]] * mesh.points[mesh.mid[t][k]];
  return x;
}

/// The Jacobian determinant by central differences, exact for a quadratic map but for rounding.
double determinant(const TetMesh& mesh, std::size_t t, const std::array<double, 4>& l) {
  constexpr double h = 1e-3;
  Vec3 d[3];
  for (int k = 0; k < 3; ++k) {
    auto up = l, down = l;
    up[k + 1] += h, up[0] -= h, down[k + 1] -= h, down[0] += h;
    d[k] = 1 / (2 * h) * (place(mesh, t, up) - place(mesh, t, down));
  }
  return dot(d[0], cross(d[1], d[2]));
}

/// Smallest determinant over the straight one, at corners, edges and random places.
double worst_determinant(const TetMesh& mesh) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<std::array<double, 4>> places;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      std::array<double, 4> l = {};
      l[i] += 0.5, l[j] += 0.5;
      places.push_back(l);
    }
  for (int i = 0; i < 50; ++i) {
    std::array<double, 4> l;
    double sum = 0;
    for (double& x : l) x = -std::log(1 - uniform(random)), sum += x;
    for (double& x : l) x /= sum;
    places.push_back(l);
  }
  double worst = 1;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const auto& v = mesh.tets[t];
    const Vec3 a = mesh.points[v[0]];
    const double straight = dot(mesh.points[v[1]] - a, cross(mesh.points[v[2]] - a, mesh.points[v[3]] - a));
    for (const auto& l : places) worst = std::min(worst, determinant(mesh, t, l) / straight);
  }
  return worst;
}

/// Volume within the curved sides, by a fine sum of the determinant.
double curved_volume(const TetMesh& mesh) {
  double volume = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    double sum = -0.8 * determinant(mesh, t, {0.25, 0.25, 0.25, 0.25});
    for (int i = 0; i < 4; ++i) {
      std::array<double, 4> l = {1 / 6., 1 / 6., 1 / 6., 1 / 6.};
      l[i] = 0.5;
      sum += 0.45 * determinant(mesh, t, l);
    }
    volume += sum / 6;
  }
  return volume;
}

/// A closed prism over a regular polygon: its mantle is smooth, its caps are flat.
InterfaceComplex cylinder(int n, int layers, double radius, double height) {
  InterfaceComplex c;
  for (int k = 0; k <= layers; ++k)
    for (int i = 0; i < n; ++i)
      c.points.push_back(
          {radius * std::cos(2 * kPi * i / n), radius * std::sin(2 * kPi * i / n), 0.3 + height * k / layers});
  const auto id = [n](int k, int i) { return k * n + i % n; };
  for (int k = 0; k < layers; ++k)
    for (int i = 0; i < n; ++i) shapes::add_quad(c, id(k, i), id(k, i + 1), id(k + 1, i + 1), id(k + 1, i), 1, 0);
  const int low = static_cast<int>(c.points.size());
  c.points.push_back({0, 0, 0.3});
  c.points.push_back({0, 0, c.points[id(layers, 0)].z});
  for (int i = 0; i < n; ++i) {
    c.triangles.push_back({{low, id(0, i + 1), id(0, i)}, 1, 0});
    c.triangles.push_back({{low + 1, id(layers, i), id(layers, i + 1)}, 1, 0});
  }
  return c;
}

void expect_one_node_per_edge(const TetMesh& mesh, std::size_t corners) {
  std::map<std::pair<int, int>, int> nodes;
  std::set<int> used;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (int k = 0; k < 6; ++k) {
      const auto [a, b] = std::minmax(mesh.tets[t][kEdges[k][0]], mesh.tets[t][kEdges[k][1]]);
      const auto [at, fresh] = nodes.insert({{a, b}, mesh.mid[t][k]});
      EXPECT_EQ(at->second, mesh.mid[t][k]);
      EXPECT_EQ(used.insert(mesh.mid[t][k]).second, fresh) << "a node on two edges";
      EXPECT_GE(mesh.mid[t][k], static_cast<int>(corners));
    }
  EXPECT_EQ(mesh.points.size(), corners + nodes.size());
}

TEST(RaiseOrder, SphereComesCloserToItsVolume) {
  for (const int level : {1, 2, 3}) {
    const TetMesh linear = fill(shapes::sphere(level, 10));
    double flat = 0;
    for (const auto& [label, v] : shapes::volumes(linear)) flat += v;
    const OrderResult r = raise_order(linear);
    const double exact = 4 * kPi * 1000 / 3;
    EXPECT_LT(std::abs(curved_volume(r.mesh) - exact), (exact - flat) / 20) << "level " << level << ", flat " << flat;
    EXPECT_EQ(r.limited_nodes, 0u);
    EXPECT_EQ(r.curved_nodes, std::size_t{30} << (2 * level));
    expect_one_node_per_edge(r.mesh, linear.points.size());
  }
}

TEST(RaiseOrder, CornersAndCellsStayAsTheyAre) {
  const TetMesh linear = fill(shapes::sphere(2, 1));
  const OrderResult r = raise_order(linear);
  EXPECT_EQ(0, std::memcmp(linear.points.data(), r.mesh.points.data(), linear.points.size() * sizeof(Vec3)));
  EXPECT_EQ(linear.tets, r.mesh.tets);
  EXPECT_EQ(linear.labels, r.mesh.labels);
}

TEST(RaiseOrder, StraightEdgesOfABoxStayStraight) {
  InterfaceComplex box;
  shapes::add_box(box, {0, 0, 0}, {1, 2, 3}, 1);
  const OrderResult r = raise_order(fill(box));
  EXPECT_EQ(r.curved_nodes, 0u);
  EXPECT_EQ(r.jacobian_min_rel, 1);
  for (std::size_t t = 0; t < r.mesh.tets.size(); ++t)
    for (int k = 0; k < 6; ++k) {
      const Vec3 m = r.mesh.points[r.mesh.mid[t][k]];
      const Vec3 s = 0.5 * (r.mesh.points[r.mesh.tets[t][kEdges[k][0]]] + r.mesh.points[r.mesh.tets[t][kEdges[k][1]]]);
      EXPECT_EQ(0, std::memcmp(&m, &s, sizeof m));
    }
}

TEST(RaiseOrder, FlatCapsStayPlaneAndTheirRimBecomesACircle) {
  const InterfaceComplex complex = cylinder(16, 4, 5, 8);
  const OrderResult r = raise_order(fill(complex));
  std::set<std::pair<int, int>> rim;
  for (int i = 0; i < 16; ++i) rim.insert(std::minmax(i, (i + 1) % 16));
  int rims = 0, caps = 0;
  for (std::size_t t = 0; t < r.mesh.tets.size(); ++t)
    for (int k = 0; k < 6; ++k) {
      const int a = r.mesh.tets[t][kEdges[k][0]], b = r.mesh.tets[t][kEdges[k][1]];
      const Vec3 m = r.mesh.points[r.mesh.mid[t][k]];
      if (r.mesh.points[a].z == 0.3 && r.mesh.points[b].z == 0.3) {
        EXPECT_EQ(m.z, 0.3);
        ++caps;
      }
      if (rim.count(std::minmax(a, b))) {
        EXPECT_NEAR(std::hypot(m.x, m.y), 5, 0.002);
        ++rims;
      }
    }
  EXPECT_GE(rims, 16);
  EXPECT_GE(caps, 32);
  EXPECT_NEAR(curved_volume(r.mesh), kPi * 25 * 8, 0.002 * kPi * 25 * 8);  // the prism lacks 2.6 %
}

TEST(RaiseOrder, NodesAreHeldBackWhereAnElementWouldTurnInsideOut) {
  // Coarse spheres, one just inside the other: a node that followed the inner one would pass the outer facets.
  InterfaceComplex shell = shapes::sphere(1, 10);
  const InterfaceComplex inner = shapes::sphere(1, 9.7);
  const int offset = static_cast<int>(shell.points.size());
  shell.points.insert(shell.points.end(), inner.points.begin(), inner.points.end());
  for (InterfaceTriangle t : inner.triangles) {
    for (auto& v : t.v) v += offset;
    shell.triangles.push_back({t.v, 0, 1});
  }
  FillResult filled = fill_volume(shell);
  ASSERT_EQ(filled.status, FillResult::Status::verified) << filled.message;
  OrderOptions free;
  free.jacobian_rel = 1e-6;
  const OrderResult r = raise_order(filled.mesh), all = raise_order(filled.mesh, free);
  EXPECT_GT(r.limited_nodes, 0u);
  EXPECT_GT(r.curved_nodes, 0u);
  EXPECT_GE(r.jacobian_min_rel, 0.2);
  EXPECT_GE(worst_determinant(r.mesh), r.jacobian_min_rel - 1e-6) << "the bound must hold everywhere";
  EXPECT_GT(worst_determinant(all.mesh), 0);
  EXPECT_LE(all.limited_nodes, r.limited_nodes);
}

TEST(RaiseOrder, JacobiansOfRoughSurfacesArePositiveEverywhere) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-0.25, 0.25);
  for (int round = 0; round < 3; ++round) {
    InterfaceComplex rough = shapes::sphere(2, 3);
    for (Vec3& p : rough.points) p = (1 + 0.5 * uniform(random)) * p;
    const OrderResult r = raise_order(fill(rough));
    EXPECT_GT(r.curved_nodes, 100u);
    EXPECT_GE(worst_determinant(r.mesh), 0.2 - 1e-6);
  }
}

TEST(RaiseOrder, ScalesWithTheMeshAndIgnoresThreads) {
  TetMesh mesh = fill(shapes::sphere(2, 3));
  OrderOptions one;
  one.threads = 1;
  const TetMesh a = raise_order(mesh).mesh, b = raise_order(mesh, one).mesh;
  EXPECT_EQ(a.mid, b.mid);
  EXPECT_EQ(0, std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof(Vec3)));
  for (Vec3& p : mesh.points) p = 2.0 * p;
  const TetMesh twice = raise_order(mesh).mesh;
  for (std::size_t i = 0; i < a.points.size(); ++i) EXPECT_EQ(2 * a.points[i].x, twice.points[i].x);
}

TEST(RaiseOrder, OfASurfaceOfRestoredVolumeTheNodesMoveOntoTheTrueSphere) {
  // The flat triangles hold what a sphere of radius 10 holds, so their corners lie outside of it.
  for (const int level : {1, 2, 3}) {
    SCOPED_TRACE(level);
    InterfaceComplex sphere = shapes::sphere(level, 10);
    const auto volume_of = [](const TetMesh& mesh) { return shapes::volumes(mesh).at(1); };
    const double exact = 4 * kPi * 1000 / 3, grow = std::cbrt(exact / volume_of(fill(sphere)));
    for (Vec3& p : sphere.points) p = grow * p;
    const TetMesh linear = fill(sphere);
    ASSERT_NEAR(volume_of(linear), exact, 1e-9 * exact);
    OrderOptions restored;
    restored.volumes_restored = true;
    const OrderResult r = raise_order(linear, restored), stiff = raise_order(linear);
    EXPECT_EQ(r.moved_corners, sphere.points.size());
    EXPECT_NEAR(curved_volume(r.mesh), exact, 1e-6 * exact);
    EXPECT_GT(curved_volume(stiff.mesh), exact * (1 + 0.5 * 3 * (grow - 1)));  // the overshoot that this mends
    EXPECT_GE(worst_determinant(r.mesh), 0.2 - 1e-6);
    const auto farthest = [&](const TetMesh& mesh) {
      double most = 0;
      std::set<std::pair<int, int>> edges;
      for (const InterfaceTriangle& f : mesh.faces)
        for (int k = 0; k < 3; ++k) edges.insert(std::minmax(f.v[k], f.v[(k + 1) % 3]));
      for (std::size_t t = 0; t < mesh.tets.size(); ++t)
        for (int k = 0; k < 6; ++k)
          if (edges.count(std::minmax(mesh.tets[t][kEdges[k][0]], mesh.tets[t][kEdges[k][1]])))
            for (const int v : {mesh.mid[t][k], mesh.tets[t][kEdges[k][0]], mesh.tets[t][kEdges[k][1]]})
              most = std::max(most, std::abs(norm(mesh.points[v]) - 10));
      return most;
    };
    EXPECT_LT(farthest(r.mesh), 0.2 * farthest(stiff.mesh));
  }
}

TEST(RaiseOrder, OfRestoredVolumesEveryLabelKeepsItsOwnAndCapsStayPlane) {
  const InterfaceComplex complex = cylinder(24, 6, 6, 9);
  TetMesh linear = fill(complex);
  OrderOptions restored;
  restored.volumes_restored = true;
  const OrderResult r = raise_order(linear, restored);
  const double flat = shapes::volumes(linear).at(1);
  EXPECT_NEAR(curved_volume(r.mesh), flat, 1e-4 * flat);
  EXPECT_GT(r.moved_corners, 0u);
  for (std::size_t p = 0; p < linear.points.size(); ++p)
    if (linear.points[p].z == 0.3 || linear.points[p].z == complex.points[24 * 6].z) {
      EXPECT_EQ(r.mesh.points[p].z, linear.points[p].z);
    }
  // Two spheres, one in the other: the inner side is of two labels.
  InterfaceComplex nested = shapes::sphere(2, 10, 1);
  InterfaceComplex inner = shapes::sphere(1, 5, 2, 1);
  const int offset = static_cast<int>(nested.points.size());
  nested.points.insert(nested.points.end(), inner.points.begin(), inner.points.end());
  for (InterfaceTriangle t : inner.triangles) {
    for (auto& v : t.v) v += offset;
    nested.triangles.push_back(t);
  }
  linear = fill(nested);
  const TetMesh both = raise_order(linear, restored).mesh;
  for (const Label label : {1, 2}) {
    TetMesh part = both;
    part.tets.clear(), part.mid.clear();
    for (std::size_t t = 0; t < both.tets.size(); ++t)
      if (both.labels[t] == label) part.tets.push_back(both.tets[t]), part.mid.push_back(both.mid[t]);
    EXPECT_NEAR(curved_volume(part), shapes::volumes(linear).at(label), 1e-5 * shapes::volumes(linear).at(label))
        << label;
  }
}

TEST(RaiseOrder, RefusesASecondTimeAndPointsThatAreNotThere) {
  const TetMesh raised = raise_order(fill(shapes::sphere(0, 1))).mesh;
  EXPECT_THROW(raise_order(raised), Error);
  TetMesh bad = fill(shapes::sphere(0, 1));
  bad.tets[0][2] = 1000;
  EXPECT_THROW(raise_order(bad), Error);
}

}  // namespace
}  // namespace stackmesh
