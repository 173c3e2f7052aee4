#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/complex.h"
#include "model/geometry.h"

namespace stackmesh {

/// A tetrahedral mesh with a label per tet, and the interface triangles it was filled from or keeps.
struct TetMesh {
  std::vector<Vec3> points;                          ///< mm; the points of the complex come first, unchanged
  std::vector<std::array<std::int32_t, 4>> tets;     ///< det(b-a, c-a, d-a) > 0
  std::vector<Label> labels;                         ///< one per tet, never 0
  std::vector<InterfaceTriangle> faces;              ///< interface and boundary triangles
};

}  // namespace stackmesh
