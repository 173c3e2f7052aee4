#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/stack.h"

namespace stackmesh {

/// How the end of a label's part is closed where the neighbouring section has nothing to stitch it to.
enum class EndShape : std::uint8_t {
  round,    ///< a dome
  flat,     ///< straight walls, then a plane half a gap beyond the section (the outer voxel face)
  on_plane  ///< a plane on the section itself (plane cuts)
};

/// How an end of a label's part is closed in one slab.
struct SlabEnd {
  Label label = 0;
  EndShape shape = EndShape::round;
  double scale = 1;  ///< of a round end: its height against that of one that stands for the whole slab
};

/// Two noded neighbouring sections and all that stitching them needs to know.
struct SlabInput {
  const Section* lower = nullptr;
  const Section* upper = nullptr;
  double z_low_mm = 0, z_high_mm = 0;
  double scale_x = 1, scale_y = 1;  ///< grid units to the metric of the triangulation; few bits, so products are exact
  double round_holds_rel = 0.5;     ///< what a round end holds: this share of the gap over its area
  /// Shape of an end of a part with that label in the lower (upward end) or upper (downward end) section.
  std::vector<SlabEnd> upward_ends, downward_ends;  ///< sorted by label; absent: round
};

/// What one slab contributes. Vertex numbers: 0 .. n_lower-1 are the lower section's points, then the upper
/// section's, then `points`.
struct SlabSurface {
  struct Point {
    double x, y, z;  ///< x, y in the triangulation's metric; z in mm
  };
  struct Triangle {
    std::array<std::int32_t, 3> v;
    Label below, above;  ///< normal from below to above
  };
  std::vector<Point> points;
  std::vector<Triangle> triangles;
  std::size_t added_points = 0;  ///< points of the plane that neither section has
};

/// Stitches one slab (\cite wang2005, sections 3.2 to 3.4; docs/stitching.md): one constrained Delaunay
/// triangulation of both sections, labels (l, u) per triangle by flooding, a sheet over every triangle with
/// l != u, walls where neighbouring columns differ.
/// @throws Error(input) where the labels of a section's edges contradict each other.
SlabSurface stitch_slab(const SlabInput& input);

}  // namespace stackmesh
