#pragma once
#include <array>
#include <cstdint>

#include "model/geometry.h"

namespace stackmesh {

/// The corners of a triangle.
using Corners3 = std::array<Vec3, 3>;

/// Which corners two triangles share by index: `count`, and their places in each.
struct SharedCorners {
  int count = 0;                        ///< 0 to 3
  std::array<int, 3> in_s = {0, 0, 0};  ///< the first `count` are places 0, 1, 2 of corners of s
  std::array<int, 3> in_t = {0, 0, 0};  ///< places of the same corners in t
};
SharedCorners shared_corners(const std::array<std::int32_t, 3>& s, const std::array<std::int32_t, 3>& t);

/// True when a plane keeps two triangles without a common corner at least `gap` apart (gap well above
/// rounding); false when no such plane was found.
bool certainly_apart(const Corners3& s, const Corners3& t, double gap);

/// True when the triangles (of non-zero area) meet beyond the corners that they share by index. Exact.
bool triangles_meet(const Corners3& s, const Corners3& t, const SharedCorners& shared);

/// The nearest points of two triangles that do not meet, and their distance, squared.
struct NearestPoints {
  Vec3 on_s;               ///< of the first triangle
  Vec3 on_t;               ///< of the second one
  double squared = 1e300;  ///< of their distance, mm2
};
NearestPoints nearest_points(const Corners3& s, const Corners3& t);
inline double squared_distance(const Corners3& s, const Corners3& t) {
  return nearest_points(s, t).squared;
}

/// Cosine of the angle between the half planes of two triangles at their common edge; 1: folded onto each
/// other.
double sheet_cosine(const Corners3& s, const Corners3& t, const SharedCorners& shared);

/// Smallest angle of a triangle, radians; 0 for one without area.
double smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c);

/// Nearest point of a triangle.
Vec3 nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);
/// Nearest point of a segment.
Vec3 nearest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b);

}  // namespace stackmesh
