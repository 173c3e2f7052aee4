#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/geometry.h"

namespace stackmesh {

/// A triangle between two labels; its normal (right-hand rule) points from `below` into `above`.
struct InterfaceTriangle {
  std::array<std::int32_t, 3> v = {0, 0, 0};  ///< corners: indices of InterfaceComplex::points
  Label below = 0;                            ///< where the normal comes from; 0: the background
  Label above = 0;                            ///< where it points to; never equal to `below`
};

/// The interfaces of all labels as one triangle soup with shared vertices: conforming at junctions by
/// construction. A label's closed surface is the set of its triangles, those with `above` == label reversed.
struct InterfaceComplex {
  std::vector<Vec3> points;                  ///< mm
  std::vector<InterfaceTriangle> triangles;  ///< no two on the same corners
  Space space = Space::stack;                ///< of the points; model/space.h brings them to another
};

/// How far a surface has come: as stitched, smoothed, or smoothed and remeshed.
enum class SurfaceLevel { stitched, smoothed, enhanced };

inline const char* to_text(SurfaceLevel level) {
  return level == SurfaceLevel::enhanced ? "enhanced" : level == SurfaceLevel::smoothed ? "smoothed" : "stitched";
}

}  // namespace stackmesh
