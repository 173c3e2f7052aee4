#include "model/intensity_volume.h"

#include <algorithm>
#include <cmath>

namespace stackmesh {
namespace {

/// A grain of a voxel, so that a point on the image's own face is inside whatever the rounding.
constexpr double kHalf = 0.5 + 1e-9;

bool inside(const std::array<int, 3>& size, Vec3 v) {
  return v.x >= -kHalf && v.y >= -kHalf && v.z >= -kHalf && v.x <= size[0] - 1 + kHalf && v.y <= size[1] - 1 + kHalf &&
         v.z <= size[2] - 1 + kHalf;
}

}  // namespace

bool IntensityVolume::contains(Vec3 p) const {
  return inside(size, voxel_of(p));
}

std::optional<double> IntensityVolume::sample(Vec3 p) const {
  const Vec3 v = voxel_of(p);
  if (!inside(size, v)) return std::nullopt;
  const double at[3] = {v.x, v.y, v.z};
  int low[3], high[3];
  double t[3];
  for (int d = 0; d < 3; ++d) {
    const double x = std::clamp<double>(at[d], 0, size[d] - 1);
    low[d] = static_cast<int>(std::floor(x));
    high[d] = std::min(low[d] + 1, size[d] - 1);
    t[d] = x - low[d];
  }
  const auto along_x = [&](int j, int k) {
    return (1 - t[0]) * values[index(low[0], j, k)] + t[0] * values[index(high[0], j, k)];
  };
  const auto along_y = [&](int k) { return (1 - t[1]) * along_x(low[1], k) + t[1] * along_x(high[1], k); };
  return (1 - t[2]) * along_y(low[2]) + t[2] * along_y(high[2]);
}

}  // namespace stackmesh
