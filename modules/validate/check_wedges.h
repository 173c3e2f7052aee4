#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/tet_mesh.h"

namespace stackmesh {

/// What one wedge, or pyramid, is like.
struct WedgeShape {
  /// smallest over its corners: determinant over the product of the three edges, 1 for the regular one; of second
  /// order times the smallest determinant over that of the straight element there
  double scaled_jacobian = 0;
  double volume_mm3 = 0;  ///< within its curved sides
  /// a corner's exact orientation, or the determinant at an integration point (of second order at every node, too), is
  /// not positive
  bool inverted = false;
};

/// @param wedge in mesh.wedges
WedgeShape wedge_shape(const TetMesh& mesh, std::size_t wedge);

/// The triangles of a wedge, or pyramid, outward.
template <class Visit>
void each_wedge_triangle(const std::array<std::int32_t, 6>& w, Visit visit) {
  visit(std::array<std::int32_t, 3>{w[0], w[2], w[1]});
  visit(std::array<std::int32_t, 3>{w[3], w[4], w[5]});
  if (w[2] != w[5]) return;
  visit(std::array<std::int32_t, 3>{w[1], w[2], w[4]});
  visit(std::array<std::int32_t, 3>{w[2], w[0], w[3]});
}

/// The sides of four corners that are not shared by exactly two wedges or pyramids of one label, one on either side:
/// ascending corners.
std::vector<std::array<std::int32_t, 4>> unshared_sides(const TetMesh& mesh);

}  // namespace stackmesh
