#include "model/stack.h"

#include <cmath>

namespace stackmesh {

double label_area_mm2(const Stack& stack, const Section& section, Label label) {
  __int128 twice = 0;
  for (const SectionEdge& e : section.edges) {
    const int sign = (e.left == label ? 1 : 0) - (e.right == label ? 1 : 0);
    if (sign == 0) continue;
    const GridPoint p = section.points[e.a], q = section.points[e.b];
    twice += sign * (static_cast<__int128>(p.x) * q.y - static_cast<__int128>(q.x) * p.y);
  }
  return 0.5 * static_cast<double>(twice) * stack.grid_x_mm * stack.grid_y_mm;
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
