#pragma once
#include <cstdint>
#include <vector>

#include "model/tet_mesh.h"

namespace stackmesh {

/// Elements of a mesh by the sign of their Jacobian determinant, at corners, mid-side nodes and integration points.
struct ElementQuality {
  /// per element, of its corners: 1 for the regular one, 0 when flat, negative when inside out
  std::vector<double> scaled_jacobian;
  std::vector<std::int32_t> non_positive;  ///< elements with a determinant that is not positive, ascending
};

/// @param mesh linear or second order
ElementQuality element_quality(const TetMesh& mesh);

}  // namespace stackmesh
