#pragma once
// Shape functions of tets with 4 or 10 nodes, in barycentric coordinates of the corners.
#include <array>

#include "model/tet_mesh.h"

namespace stackmesh {

/// The position of a point of an element, and the determinant of the map there (6 times the volume, where it is
/// constant).
struct TetPoint {
  Vec3 position;
  double determinant = 0;
};

/// Derivatives of the position by each barycentric coordinate.
inline std::array<Vec3, 4> tet_derivatives(const TetMesh& mesh, std::size_t tet, const std::array<double, 4>& l) {
  const auto& t = mesh.tets[tet];
  std::array<Vec3, 4> d;
  for (int k = 0; k < 4; ++k) d[k] = (mesh.mid.empty() ? 1 : 4 * l[k] - 1) * mesh.points[t[k]];
  if (mesh.mid.empty()) return d;
  for (int e = 0; e < 6; ++e) {
    const int a = kTetEdges[e][0], b = kTetEdges[e][1];
    const Vec3 m = mesh.points[mesh.mid[tet][e]];
    d[a] = d[a] + (4 * l[b]) * m;
    d[b] = d[b] + (4 * l[a]) * m;
  }
  return d;
}

inline TetPoint tet_point(const TetMesh& mesh, std::size_t tet, const std::array<double, 4>& l) {
  const auto& t = mesh.tets[tet];
  const std::array<Vec3, 4> d = tet_derivatives(mesh, tet, l);
  TetPoint out;
  for (int k = 0; k < 4; ++k)
    out.position = out.position + (mesh.mid.empty() ? l[k] : l[k] * (2 * l[k] - 1)) * mesh.points[t[k]];
  if (!mesh.mid.empty())
    for (int e = 0; e < 6; ++e)
      out.position = out.position + (4 * l[kTetEdges[e][0]] * l[kTetEdges[e][1]]) * mesh.points[mesh.mid[tet][e]];
  out.determinant = dot(cross(d[1] - d[0], d[2] - d[0]), d[3] - d[0]);
  return out;
}

}  // namespace stackmesh
