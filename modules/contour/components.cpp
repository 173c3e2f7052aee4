#include "contour/components.h"

#include <algorithm>

namespace stackmesh {

void VoxelComponents::add(const Slice& slice) {
  height_ = slice.height;
  for (int y = 0; y < slice.height; ++y) {
    for (int x = 0; x < slice.width;) {
      const std::uint16_t label = slice.at(x, y);
      const int start = x;
      while (x < slice.width && slice.at(x, y) == label) ++x;
      if (label == 0) continue;
      parent_.push_back(static_cast<std::int32_t>(runs_.size()));
      runs_.push_back({start, x, label});
    }
    row_start_.push_back(runs_.size());
    const std::size_t row = row_start_.size() - 2;
    if (y > 0) join_rows(row, row - 1);
    if (row >= static_cast<std::size_t>(height_)) join_rows(row, row - height_);
  }
}

void VoxelComponents::join_rows(std::size_t row, std::size_t other) {
  std::size_t i = row_start_[row], j = row_start_[other];
  while (i < row_start_[row + 1] && j < row_start_[other + 1]) {
    if (runs_[i].label == runs_[j].label && runs_[i].x0 < runs_[j].x1 && runs_[j].x0 < runs_[i].x1) {
      const std::int32_t a = find(static_cast<std::int32_t>(i)), b = find(static_cast<std::int32_t>(j));
      parent_[std::max(a, b)] = std::min(a, b);
    }
    if (runs_[i].x1 < runs_[j].x1) ++i;
    else ++j;
  }
}

std::int32_t VoxelComponents::find(std::int32_t run) {
  while (parent_[run] != run) run = parent_[run] = parent_[parent_[run]];
  return run;
}

void VoxelComponents::finish() {
  for (std::size_t run = 0; run < runs_.size(); ++run) parent_[run] = parent_[parent_[run]];  // parents come first
}

std::int32_t VoxelComponents::of(int x, int y, int slice) const {
  const std::size_t row = static_cast<std::size_t>(slice) * height_ + y;
  const auto end = runs_.begin() + static_cast<std::ptrdiff_t>(row_start_[row + 1]);
  const auto it = std::partition_point(runs_.begin() + static_cast<std::ptrdiff_t>(row_start_[row]), end,
                                       [&](const Run& r) { return r.x1 <= x; });
  return parent_[it - runs_.begin()];
}

void touching_corners(const VoxelComponents& components, const Slice& slice, int k, const Slice& other, int other_k,
                      std::vector<std::uint64_t>& corners) {
  for (int y = 0; y < slice.height; ++y)
    for (int x = 0; x < slice.width; ++x) {
      const std::uint16_t label = slice.at(x, y);
      if (label == 0 || other.at(x, y) == label) continue;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if (other.at(x + dx, y + dy) != label || components.of(x, y, k) == components.of(x + dx, y + dy, other_k)) continue;
          // The corners that pixel (x, y) shares with its neighbour.
          for (int cy = std::max(0, dy); cy <= std::min(1, 1 + dy); ++cy)
            for (int cx = std::max(0, dx); cx <= std::min(1, 1 + dx); ++cx) corners.push_back(corner_key(x + cx, y + cy));
        }
    }
}

}  // namespace stackmesh
