#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

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

}  // namespace stackmesh
