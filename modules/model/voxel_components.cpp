#include "model/voxel_components.h"

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
    if (runs_[i].x1 < runs_[j].x1) ++i;
    else ++j;
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

}  // namespace stackmesh
