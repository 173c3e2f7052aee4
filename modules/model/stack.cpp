#include "model/stack.h"

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
  const std::size_t k = high ? n - 2 : 0;
  return 0.5 * (stack.sections[k + 1].z_mm - stack.sections[k].z_mm);
}

}  // namespace stackmesh
