#include "model/stack.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace stackmesh {
namespace {

__int128 twice_area(GridPoint p, GridPoint q) {
  return static_cast<__int128>(p.x) * q.y - static_cast<__int128>(q.x) * p.y;
}

double mm2(const Stack& stack, __int128 twice) {
  return 0.5 * static_cast<double>(twice) * stack.grid_x_mm * stack.grid_y_mm;
}

}  // namespace

double label_area_mm2(const Stack& stack, const Section& section, Label label) {
  __int128 twice = 0;
  for (const SectionEdge& e : section.edges) {
    const int sign = (e.left == label ? 1 : 0) - (e.right == label ? 1 : 0);
    if (sign == 0) continue;
    twice += sign * twice_area(section.points[e.a], section.points[e.b]);
  }
  return mm2(stack, twice);
}

double enclosed_area_mm2(const Stack& stack, const Section& section, Label label) {
  std::vector<std::array<std::int32_t, 2>> sides;  // the label on their left, by their first point
  for (const SectionEdge& e : section.edges) {
    if (e.left == e.right) continue;
    if (e.left == label) sides.push_back({e.a, e.b});
    if (e.right == label) sides.push_back({e.b, e.a});
  }
  std::sort(sides.begin(), sides.end());
  std::vector<char> used(sides.size(), 0);
  const auto unused_from = [&](std::int32_t point) {
    auto it = std::lower_bound(sides.begin(), sides.end(), std::array<std::int32_t, 2>{point, -1});
    while (it != sides.end() && (*it)[0] == point && used[it - sides.begin()]) ++it;
    return it != sides.end() && (*it)[0] == point ? it : sides.end();
  };
  __int128 twice = 0;
  for (const auto& first : sides) {
    __int128 loop = 0;
    for (auto it = unused_from(first[0]); it != sides.end(); it = unused_from((*it)[1])) {
      used[it - sides.begin()] = 1;
      loop += twice_area(section.points[(*it)[0]], section.points[(*it)[1]]);
    }
    if (loop > 0) twice += loop;  // holes run the other way
  }
  return mm2(stack, twice);
}

double end_half_gap_mm(const Stack& stack, bool high) {
  if (stack.end_gap_mm > 0) return 0.5 * stack.end_gap_mm;
  const std::size_t n = stack.sections.size();
  if (n < 2) return 0.5 * stack.pixel_mm;
  std::size_t beside = high ? n - 2 : 1;  // the next real section
  while (stack.sections[beside].interpolated && beside > 0 && beside + 1 < n) high ? --beside : ++beside;
  return 0.5 * std::abs(stack.sections[beside].z_mm - stack.sections[high ? n - 1 : 0].z_mm);
}

}  // namespace stackmesh
