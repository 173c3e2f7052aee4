#include "shapes.h"

#include <algorithm>
#include <map>

namespace stackmesh::test {

void add_box(InterfaceComplex& complex, Vec3 low, Vec3 high, Label label, Label outside) {
  const std::int32_t n = static_cast<std::int32_t>(complex.points.size());
  for (int i = 0; i < 8; ++i)
    complex.points.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads) {
    complex.triangles.push_back({{n + q[0], n + q[1], n + q[2]}, label, outside});
    complex.triangles.push_back({{n + q[0], n + q[2], n + q[3]}, label, outside});
  }
}

InterfaceComplex box(Vec3 low, Vec3 high, Label label) {
  InterfaceComplex c;
  c.space = Space::lps;
  add_box(c, low, high, label);
  return c;
}

InterfaceComplex weld(const InterfaceComplex& complex) {
  InterfaceComplex out;
  out.space = Space::lps;
  std::map<std::array<double, 3>, std::int32_t> numbers;
  std::vector<std::int32_t> to;
  for (const Vec3& p : complex.points) {
    const auto found = numbers.emplace(std::array<double, 3>{p.x, p.y, p.z}, static_cast<std::int32_t>(numbers.size()));
    if (found.second) out.points.push_back(p);
    to.push_back(found.first->second);
  }
  out.triangles = complex.triangles;
  for (auto& t : out.triangles)
    for (auto& v : t.v) v = to[v];
  return out;
}

InterfaceComplex icosphere(double radius, int level, Label label, Vec3 centre) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vec3> points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                              {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<std::array<std::int32_t, 3>> faces = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int l = 0; l < level; ++l) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const auto found = middles.emplace(std::minmax(a, b), static_cast<std::int32_t>(points.size()));
      if (found.second) points.push_back(0.5 * (points[a] + points[b]));
      return found.first->second;
    };
    std::vector<std::array<std::int32_t, 3>> finer;
    for (const auto& f : faces) {
      const std::int32_t a = middle(f[0], f[1]), b = middle(f[1], f[2]), c = middle(f[2], f[0]);
      finer.push_back({f[0], a, c});
      finer.push_back({f[1], b, a});
      finer.push_back({f[2], c, b});
      finer.push_back({a, b, c});
    }
    faces.swap(finer);
    for (Vec3& p : points) p = (1 / norm(p)) * p;
  }
  InterfaceComplex out;
  out.space = Space::lps;
  for (const Vec3& p : points) out.points.push_back(centre + (radius / norm(p)) * p);
  for (const auto& f : faces) out.triangles.push_back({f, label, 0});
  return out;
}

InterfaceComplex voxel_surface(const LabelVolume& volume) {
  InterfaceComplex out;
  out.space = Space::lps;
  std::map<std::array<int, 3>, std::int32_t> numbers;
  const auto label = [&](std::array<int, 3> v) -> Label {
    for (int k = 0; k < 3; ++k)
      if (v[k] < 0 || v[k] >= volume.size[k]) return 0;
    return volume.labels[volume.voxels[volume.index(v[0], v[1], v[2])]].number;
  };
  const bool mirrored = dot(cross(volume.axes[0], volume.axes[1]), volume.axes[2]) < 0;
  std::array<int, 3> v;
  for (v[2] = -1; v[2] < volume.size[2]; ++v[2])
    for (v[1] = -1; v[1] < volume.size[1]; ++v[1])
      for (v[0] = -1; v[0] < volume.size[0]; ++v[0])
        for (int k = 0; k < 3; ++k) {
          std::array<int, 3> w = v;
          ++w[k];
          const Label below = label(v), above = label(w);
          if (below == above) continue;
          std::int32_t quad[4];
          const int du[4] = {0, 1, 1, 0}, dv[4] = {0, 0, 1, 1};
          for (int c = 0; c < 4; ++c) {
            std::array<int, 3> p = w;  // corner p stands for index p - 0.5
            p[(k + 1) % 3] += du[c], p[(k + 2) % 3] += dv[c];
            const auto found = numbers.emplace(p, static_cast<std::int32_t>(numbers.size()));
            if (found.second) out.points.push_back(volume.world(p[0] - 0.5, p[1] - 0.5, p[2] - 0.5));
            quad[c] = found.first->second;
          }
          if (mirrored) std::swap(quad[1], quad[3]);
          out.triangles.push_back({{quad[0], quad[1], quad[2]}, below, above});
          out.triangles.push_back({{quad[0], quad[2], quad[3]}, below, above});
        }
  return out;
}

LabelVolume empty_volume(int nx, int ny, int nz, int labels) {
  LabelVolume v;
  v.size = {nx, ny, nz};
  v.voxels.assign(static_cast<std::size_t>(nx) * ny * nz, 0);
  for (int l = 0; l <= labels; ++l) v.labels.push_back({l, ""});
  return v;
}

void fill(LabelVolume& volume, std::array<int, 3> low, std::array<int, 3> high, int label) {
  for (int k = low[2]; k < high[2]; ++k)
    for (int j = low[1]; j < high[1]; ++j)
      for (int i = low[0]; i < high[0]; ++i) volume.voxels[volume.index(i, j, k)] = static_cast<std::uint16_t>(label);
}

TetMesh two_tets() {
  TetMesh m;
  m.space = Space::lps;
  m.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}};
  m.tets = {{0, 1, 2, 3}, {0, 2, 1, 4}};
  m.labels = {1, 2};
  m.faces = {{{1, 2, 3}, 1, 0}, {{0, 3, 2}, 1, 0}, {{0, 1, 3}, 1, 0}, {{0, 2, 1}, 1, 2},
             {{2, 1, 4}, 2, 0}, {{0, 4, 1}, 2, 0}, {{0, 2, 4}, 2, 0}};
  return m;
}

}  // namespace stackmesh::test
