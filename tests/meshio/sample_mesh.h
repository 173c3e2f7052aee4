#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "meshio/write_mesh.h"
#include "model/complex.h"
#include "model/tet_mesh.h"

namespace stackmesh {

/// A block of n x n x n cells, six tets each, in oblique coordinates with full mantissas. Label 3 is the low
/// half in x, label 7 the high half, and label 12 a block inside that touches both and not the background.
/// Every second interface triangle is given the other way round (below and above swapped, wound backwards),
/// and one point is used by nothing.
inline TetMesh sample_mesh(int n = 4) {
  TetMesh mesh;
  const auto id = [n](int i, int j, int k) { return (k * (n + 1) + j) * (n + 1) + i; };
  const double c = std::cos(0.3), s = std::sin(0.3);
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const double x = i * 0.7 - 1, y = j / 3.0, z = k * 1.1 - 2e-5;
        mesh.points.push_back({c * x - s * y - 123.4, s * x + c * y, z});
      }
  const auto label = [n](int i, int j, int k) {
    const auto inside = [n](int a) { return a >= n / 4 && a < n - n / 4; };
    return inside(i) && inside(j) && inside(k) ? 12 : i < n / 2 ? 3 : 7;
  };
  constexpr int paths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        for (int p = 0; p < 6; ++p) {
          std::array<int, 3> at = {i, j, k};
          std::array<std::int32_t, 4> tet = {id(i, j, k), 0, 0, 0};
          for (int step = 0; step < 3; ++step) {
            ++at[paths[p][step]];
            tet[step + 1] = id(at[0], at[1], at[2]);
          }
          if (p >= 3) std::swap(tet[2], tet[3]);
          mesh.tets.push_back(tet);
          mesh.labels.push_back(label(i, j, k));
        }
  // A face seen from inside its tet, wound outward, with the labels of both its sides.
  struct Side {
    std::array<std::int32_t, 3> v;
    Label in = 0, out = 0;
  };
  std::map<std::array<std::int32_t, 3>, Side> sides;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const auto& a = mesh.tets[t];
    for (const auto& face : {std::array<std::int32_t, 3>{a[1], a[2], a[3]},
                             {a[0], a[3], a[2]},
                             {a[0], a[1], a[3]},
                             {a[0], a[2], a[1]}}) {
      auto key = face;
      std::sort(key.begin(), key.end());
      const auto [at, fresh] = sides.insert({key, {face, mesh.labels[t], 0}});
      if (!fresh) at->second.out = mesh.labels[t];
    }
  }
  for (const auto& [key, side] : sides) {
    if (side.in == side.out) continue;
    if (mesh.faces.size() % 2 == 0)
      mesh.faces.push_back({side.v, side.in, side.out});
    else
      mesh.faces.push_back({{side.v[0], side.v[2], side.v[1]}, side.out, side.in});
  }
  mesh.points.push_back({1e6, 1e6, 1e6});
  return mesh;
}

/// The sample with mid-side nodes, each a little off the middle of its edge, in its own direction.
inline TetMesh second_order_sample(int n = 4) {
  TetMesh mesh = sample_mesh(n);
  std::map<std::array<std::int32_t, 2>, std::int32_t> nodes;
  mesh.mid.resize(mesh.tets.size());
  constexpr int edges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (int k = 0; k < 6; ++k) {
      const std::int32_t a = mesh.tets[t][edges[k][0]], b = mesh.tets[t][edges[k][1]];
      const auto [at, fresh] = nodes.insert({{std::min(a, b), std::max(a, b)}, static_cast<std::int32_t>(mesh.points.size())});
      if (fresh) {
        const double way = 0.01 * std::sin(static_cast<double>(mesh.points.size()));
        mesh.points.push_back(0.5 * (mesh.points[a] + mesh.points[b]) + way * Vec3{1, -2, 3});
      }
      mesh.mid[t][k] = at->second;
    }
  return mesh;
}

inline InterfaceComplex sample_surface(const TetMesh& mesh) {
  return {mesh.points, mesh.faces};
}

inline std::vector<LabelInfo> sample_labels() {
  return {{0, ""}, {3, "femur left"}, {7, ""}, {12, "femur left"}};
}

inline double six_volumes(Vec3 a, Vec3 b, Vec3 c) {
  return dot(a, cross(b, c));
}

/// The label's volume, from its tets.
inline double tet_volume(const TetMesh& mesh, Label label) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (mesh.labels[t] != label) continue;
    const auto& v = mesh.tets[t];
    const Vec3 o = mesh.points[v[0]];
    sum += six_volumes(mesh.points[v[1]] - o, mesh.points[v[2]] - o, mesh.points[v[3]] - o) / 6;
  }
  return sum;
}

inline std::string read_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

}  // namespace stackmesh
