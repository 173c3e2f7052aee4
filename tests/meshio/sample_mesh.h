#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "blocks.h"
#include "meshio/write_mesh.h"
#include "model/complex.h"
#include "model/tet_mesh.h"

namespace stackmesh {

/// A block of n x n x n cells, six tets each, in oblique coordinates with full mantissas. Label 3 is the low
/// half in x, label 7 the high half, and label 12 a block inside that touches both and not the background.
/// Every second interface triangle is given the other way round (below and above swapped, wound backwards),
/// and one point is used by nothing.
inline TetMesh sample_mesh(int n = 4) {
  const auto label = [n](int i, int j, int k) {
    const auto inside = [n](int a) { return a >= n / 4 && a < n - n / 4; };
    return inside(i) && inside(j) && inside(k) ? 12 : i < n / 2 ? 3 : 7;
  };
  TetMesh mesh = blocks::block(n, n, n, {1, 1, 1}, label);
  const double c = std::cos(0.3), s = std::sin(0.3);
  for (Vec3& p : mesh.points) {
    const double x = p.x * 0.7 - 1, y = p.y / 3.0;
    p = {c * x - s * y - 123.4, s * x + c * y, p.z * 1.1 - 2e-5};
  }
  // A face seen from inside its tet, wound outward, with the labels of both its sides.
  struct Side {
    std::array<std::int32_t, 3> v;
    Label in = 0, out = 0;
  };
  std::map<std::array<std::int32_t, 3>, Side> sides;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const auto& a = mesh.tets[t];
    for (const auto& face :
         {std::array<std::int32_t, 3>{a[1], a[2], a[3]}, {a[0], a[3], a[2]}, {a[0], a[1], a[3]}, {a[0], a[2], a[1]}}) {
      auto key = face;
      std::sort(key.begin(), key.end());
      const auto [at, fresh] = sides.insert({key, {face, mesh.labels[t], 0}});
      if (!fresh) at->second.out = mesh.labels[t];
    }
  }
  for (const auto& [key, side] : sides) {
    if (side.in == side.out) continue;
    if (mesh.faces.size() % 2 == 0) mesh.faces.push_back({side.v, side.in, side.out});
    else mesh.faces.push_back({{side.v[0], side.v[2], side.v[1]}, side.out, side.in});
  }
  mesh.points.push_back({1e6, 1e6, 1e6});
  return mesh;
}

/// The mesh with mid-side nodes, each a little off the middle of its edge, in its own direction.
inline TetMesh second_order(TetMesh mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> nodes;
  for (const auto& t : mesh.tets) {
    std::array<std::int32_t, 6> mid{};
    for (int e = 0; e < 6; ++e) {
      const auto key = std::minmax(t[kTetEdges[e][0]], t[kTetEdges[e][1]]);
      const auto [at, fresh] = nodes.insert({key, static_cast<std::int32_t>(mesh.points.size())});
      if (fresh) {
        const double way = 0.01 * std::sin(static_cast<double>(mesh.points.size()));
        mesh.points.push_back(0.5 * (mesh.points[key.first] + mesh.points[key.second]) + way * Vec3{1, -2, 3});
      }
      mid[e] = at->second;
    }
    mesh.mid.push_back(mid);
  }
  return mesh;
}

inline TetMesh second_order_sample(int n = 4) {
  return second_order(sample_mesh(n));
}

inline InterfaceComplex sample_surface(const TetMesh& mesh) {
  return {mesh.points, mesh.faces, mesh.space};
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
