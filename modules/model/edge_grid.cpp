#include "model/edge_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace stackmesh {

EdgeGrid::EdgeGrid(const std::vector<GridSegment>& segments) {
  if (segments.empty()) {
    start_.assign(2, 0);
    return;
  }
  std::int64_t x1 = segments[0].a.x, y1 = segments[0].a.y, extent = 0;
  x0_ = x1;
  y0_ = y1;
  for (const GridSegment& s : segments) {
    x0_ = std::min<std::int64_t>(x0_, std::min(s.a.x, s.b.x));
    y0_ = std::min<std::int64_t>(y0_, std::min(s.a.y, s.b.y));
    x1 = std::max<std::int64_t>(x1, std::max(s.a.x, s.b.x));
    y1 = std::max<std::int64_t>(y1, std::max(s.a.y, s.b.y));
    extent += std::max(std::abs(static_cast<std::int64_t>(s.a.x) - s.b.x),
                       std::abs(static_cast<std::int64_t>(s.a.y) - s.b.y));
  }
  x0_ -= 1;
  y0_ -= 1;
  const std::int64_t count = static_cast<std::int64_t>(segments.size());
  while ((std::int64_t{1} << shift_) * count < extent) ++shift_;
  const auto cells = [&] { return (((x1 + 1 - x0_) >> shift_) + 1) * (((y1 + 1 - y0_) >> shift_) + 1); };
  while (cells() > 4 * count + 64) ++shift_;
  nx_ = ((x1 + 1 - x0_) >> shift_) + 1;
  ny_ = ((y1 + 1 - y0_) >> shift_) + 1;

  start_.assign(static_cast<std::size_t>(nx_ * ny_) + 1, 0);
  for (const GridSegment& s : segments) for_each_cell(s, [&](std::size_t cell) { ++start_[cell + 1]; });
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  items_.resize(start_.back());
  std::vector<std::int32_t> next(start_.begin(), start_.end() - 1);
  for (std::size_t i = 0; i < segments.size(); ++i)
    for_each_cell(segments[i], [&](std::size_t cell) { items_[next[cell]++] = static_cast<std::int32_t>(i); });
}

}  // namespace stackmesh
