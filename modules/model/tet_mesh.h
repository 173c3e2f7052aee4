#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "model/complex.h"
#include "model/geometry.h"

namespace stackmesh {

/// The edges of a tet by its corners, in the order of the mid-side nodes of a 10-node tet (as VTK, Abaqus and
/// CalculiX number them).
constexpr int kTetEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

/// A tetrahedral mesh with a label per tet, and the interface triangles it was filled from or keeps.
struct TetMesh {
  std::vector<Vec3> points;                          ///< mm; the points of the complex come first, unchanged
  std::vector<std::array<std::int32_t, 4>> tets;     ///< det(b-a, c-a, d-a) > 0
  std::vector<Label> labels;                         ///< one per tet, never 0
  std::vector<InterfaceTriangle> faces;              ///< interface and boundary triangles
  std::vector<std::array<std::int32_t, 6>> mid;      ///< second order: the point on each edge, kTetEdges; else empty
};

/// Exchanges corners 2 and 3 of a tet, and its mid-side nodes with them: a mirrored tet is positive again.
inline void turn_round(TetMesh& mesh, std::size_t tet) {
  std::swap(mesh.tets[tet][2], mesh.tets[tet][3]);
  if (mesh.mid.empty()) return;
  std::swap(mesh.mid[tet][1], mesh.mid[tet][4]);
  std::swap(mesh.mid[tet][2], mesh.mid[tet][3]);
}

}  // namespace stackmesh
