#include "sections/far_sections.h"

#include <algorithm>
#include <cstdio>

namespace stackmesh {
namespace {

constexpr double kFar = 100;

}  // namespace

std::string long_voxels(const LabelVolume& volume) {
  const auto [least, most] = std::minmax_element(volume.spacing_mm.begin(), volume.spacing_mm.end());
  if (*most <= kFar * *least) return "";
  char text[120];
  std::snprintf(text, sizeof text, "voxels are %.4g mm long along one axis and %.4g mm along another", *most, *least);
  return text;
}

std::string far_sections(const Stack& stack, const InterfaceComplex& stitched) {
  double low_x = 1e300, high_x = -1e300, low_y = 1e300, high_y = -1e300, gap = 0;
  for (const Vec3& p : stitched.points) {
    low_x = std::min(low_x, p.x), high_x = std::max(high_x, p.x);
    low_y = std::min(low_y, p.y), high_y = std::max(high_y, p.y);
  }
  for (std::size_t k = 1; k < stack.sections.size(); ++k)
    gap = std::max(gap, stack.sections[k].z_mm - stack.sections[k - 1].z_mm);
  const double width = std::max(high_x - low_x, high_y - low_y);
  if (stitched.points.empty() || gap <= kFar * width) return "";
  char text[120];
  std::snprintf(text, sizeof text, "two sections lie %.4g mm apart, and all of them are %.4g mm wide", gap, width);
  return text;
}

}  // namespace stackmesh
