#include "sections/section_edges.h"

namespace stackmesh {

std::int32_t SectionEdges::number_of(GridPoint p) {
  const std::uint64_t key =
      (static_cast<std::uint64_t>(static_cast<std::uint32_t>(p.x)) << 32) | static_cast<std::uint32_t>(p.y);
  const auto [it, fresh] = numbers_.emplace(key, static_cast<std::int32_t>(section_.points.size()));
  if (fresh) section_.points.push_back(p);
  return it->second;
}

void SectionEdges::add(const std::vector<GridPoint>& points, Label left, Label right) {
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const std::int32_t from = number_of(points[i]), to = number_of(points[i + 1]);
    section_.edges.push_back({from, to, left, right});
  }
}

}  // namespace stackmesh
