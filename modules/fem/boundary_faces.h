#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/solver_model.h"

namespace stackmesh {

/// A face of a tet that has another label, or nothing, on its other side.
struct BoundaryFace {
  TetFace at;                       ///< the element and which of its faces
  Label in = 0;                     ///< of its tet
  Label out = 0;                    ///< on the other side; 0: nothing is meshed there
  Label behind = 0;                 ///< where that is nothing: the void there, 0 for the background
  std::array<std::int32_t, 3> v{};  ///< corners, seen from outside anticlockwise
  std::int32_t twin = -1;           ///< the same face seen from the other side; -1: background
  Vec3 normal;                      ///< unit, out of its tet, in the space of the mesh; zero for an area of 0
  Vec3 centre;                      ///< mean of the corners, mm, in the space of the mesh
  double area_mm2 = 0;              ///< of the plane triangle
};

/// All faces between labels and to the background, by ascending tet; an interface has two, one a side.
/// @throws Error(input) where three tets share a face
std::vector<BoundaryFace> boundary_faces(const TetMesh& mesh);

/// Nodes of faces (with mid-side nodes), ascending.
std::vector<std::int32_t> nodes_of_faces(const TetMesh& mesh, const std::vector<TetFace>& faces);

/// Corners and (in a second-order mesh) mid-side nodes of a face, outward.
std::array<std::int32_t, 6> outward_nodes(const TetMesh& mesh, TetFace face);

}  // namespace stackmesh
