#include "contour/components.h"

#include <algorithm>
#include <array>

namespace stackmesh {

VoxelComponents::VoxelComponents(const LabelVolume& volume, const StackAxes& axes)
    : axes_(axes), height_(volume.size[1]) {
  const int width = volume.size[0];
  const std::size_t rows = static_cast<std::size_t>(height_) * volume.size[2];
  row_start_.reserve(rows + 1);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::uint16_t* voxels = volume.voxels.data() + row * width;
    for (int x = 0, end; x < width; x = end) {
      end = run_end(voxels, x, width);
      if (voxels[x] == 0) continue;
      parent_.push_back(static_cast<std::int32_t>(runs_.size()));
      runs_.push_back({x, end, voxels[x]});
    }
    row_start_.push_back(runs_.size());
    if (row % height_ > 0) join_rows(row, row - 1);
    if (row >= static_cast<std::size_t>(height_)) join_rows(row, row - height_);
  }
  for (std::size_t run = 0; run < runs_.size(); ++run) parent_[run] = parent_[parent_[run]];
}

void VoxelComponents::join_rows(std::size_t row, std::size_t other) {
  std::size_t i = row_start_[row], j = row_start_[other];
  while (i < row_start_[row + 1] && j < row_start_[other + 1]) {
    if (runs_[i].label == runs_[j].label && runs_[i].x0 < runs_[j].x1 && runs_[j].x0 < runs_[i].x1) {
      const std::int32_t a = find(static_cast<std::int32_t>(i)), b = find(static_cast<std::int32_t>(j));
      parent_[std::max(a, b)] = std::min(a, b);
    }
    if (runs_[i].x1 < runs_[j].x1)
      ++i;
    else
      ++j;
  }
}

std::int32_t VoxelComponents::find(std::int32_t run) {
  while (parent_[run] != run) run = parent_[run] = parent_[parent_[run]];
  return run;
}

std::int32_t VoxelComponents::of(int x, int y, int slice) const {
  std::array<int, 3> voxel;
  voxel[axes_.u] = x;
  voxel[axes_.v] = y;
  voxel[axes_.w] = slice;
  const std::size_t row = static_cast<std::size_t>(voxel[2]) * height_ + voxel[1];
  const auto end = runs_.begin() + static_cast<std::ptrdiff_t>(row_start_[row + 1]);
  const auto it = std::partition_point(runs_.begin() + static_cast<std::ptrdiff_t>(row_start_[row]), end,
                                       [&](const Run& r) { return r.x1 <= voxel[0]; });
  return parent_[it - runs_.begin()];
}

namespace {

/// True if (x, y) of the slice and (x + dx, y + dy) of the other one hang together by voxels between the two.
bool joined_nearby(const Slice& slice, const Slice& other, int x, int y, int dx, int dy) {
  const std::uint16_t label = slice.at(x, y);
  const auto in = [&](const Slice& s, int sx, int sy) { return s.at(sx, sy) == label; };
  if (dx == 0 || dy == 0) return in(slice, x + dx, y + dy);
  return (in(slice, x + dx, y) && (in(other, x + dx, y) || in(slice, x + dx, y + dy))) ||
         (in(slice, x, y + dy) && (in(other, x, y + dy) || in(slice, x + dx, y + dy)));
}

/// A voxel of the slice goes on into the other slice, where its label's next component touches it by a
/// corner.
void touching_beside(const VoxelComponents& components, const Slice& slice, const Slice& other, int other_k,
                     std::vector<std::uint64_t>& corners) {
  for (int y = 0; y + 1 < other.height; ++y) {
    const std::uint16_t* low = &other.pixels[static_cast<std::size_t>(y) * other.width];
    const std::uint16_t* high = low + other.width;
    for (int x = 0; x + 1 < other.width; ++x) {
      if (x + 4 <= other.width && four_pixels(low + x) == four_pixels(high + x)) {
        x += 3;
        continue;
      }
      if (low[x] == low[x + 1] || low[x] == high[x] || low[x + 1] == high[x + 1] || high[x] == high[x + 1])
        continue;
      for (int left : {0, 1}) {  // the diagonals (x, y)-(x + 1, y + 1) and (x + 1, y)-(x, y + 1)
        const int right = 1 - left;
        const std::uint16_t label = low[x + left];
        if (label == 0 || high[x + right] != label) continue;
        if (slice.at(x + left, y) != label && slice.at(x + right, y + 1) != label) continue;
        if (components.of(x + left, y, other_k) != components.of(x + right, y + 1, other_k))
          corners.push_back(corner_key(x + 1, y + 1));
      }
    }
  }
}

}  // namespace

void touching_corners(const VoxelComponents& components, const Slice& slice, int k, const Slice& other,
                      int other_k, std::vector<std::uint64_t>& corners) {
  touching_beside(components, slice, other, other_k, corners);
  for (int y = 0; y < slice.height; ++y) {
    const std::uint16_t* row = &slice.pixels[static_cast<std::size_t>(y) * slice.width];
    const std::uint16_t* across = &other.pixels[static_cast<std::size_t>(y) * slice.width];
    for (int x = 0; x < slice.width; ++x) {
      if (x + 4 <= slice.width &&
          (four_pixels(row + x) == 0 || four_pixels(row + x) == four_pixels(across + x))) {
        x += 3;
        continue;
      }
      const std::uint16_t label = row[x];
      if (label == 0 || across[x] == label) continue;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if (other.at(x + dx, y + dy) != label || joined_nearby(slice, other, x, y, dx, dy) ||
              components.of(x, y, k) == components.of(x + dx, y + dy, other_k))
            continue;
          // The corners that pixel (x, y) shares with its neighbour.
          for (int cy = std::max(0, dy); cy <= std::min(1, 1 + dy); ++cy)
            for (int cx = std::max(0, dx); cx <= std::min(1, 1 + dx); ++cx)
              corners.push_back(corner_key(x + cx, y + cy));
        }
    }
  }
}

}  // namespace stackmesh
