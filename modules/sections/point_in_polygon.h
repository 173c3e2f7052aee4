#pragma once
#include <array>
#include <vector>

namespace stackmesh {

/// True where the closed polygon runs round the point (even-odd; on its edge either). Internal to the module.
inline bool is_inside(const std::array<double, 2>& p, const std::vector<std::array<double, 2>>& polygon) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++)
    if ((polygon[i][1] > p[1]) != (polygon[j][1] > p[1]) &&
        p[0] <
            (polygon[j][0] - polygon[i][0]) * (p[1] - polygon[i][1]) / (polygon[j][1] - polygon[i][1]) + polygon[i][0])
      inside = !inside;
  return inside;
}

}  // namespace stackmesh
