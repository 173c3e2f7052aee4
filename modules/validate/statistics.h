#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "model/geometry.h"

namespace stackmesh {

/// The smallest of the values that are no less than a share of `fraction` of them (nearest rank). Reorders.
inline double percentile(std::vector<double>& values, double fraction) {
  if (values.empty()) return 0;
  const double rank = std::ceil(fraction * static_cast<double>(values.size())) - 1;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::max(0.0, rank));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

inline constexpr double kDegrees = 57.295779513082320877;

/// Of a triangle: it lies opposite the shortest side.
inline double smallest_angle_deg(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 side[3] = {b - a, c - b, a - c};
  int shortest = 0;
  for (int k = 1; k < 3; ++k)
    if (dot(side[k], side[k]) < dot(side[shortest], side[shortest])) shortest = k;
  const Vec3 u = side[(shortest + 1) % 3], v = -1 * side[(shortest + 2) % 3];
  return kDegrees * std::atan2(norm(cross(u, v)), dot(u, v));
}

}  // namespace stackmesh
