#pragma once
#include <cstdint>
#include <vector>

#include "contour/arcs.h"

namespace stackmesh {

/// The 6-connected components of all labels of a stack of slices, as runs along x.
class VoxelComponents {
 public:
  /// Slices must be added in order of the stack; all of one size.
  void add(const Slice& slice);
  /// The component's number of a voxel that is not background.
  std::int32_t of(int x, int y, int slice);

 private:
  struct Run {
    std::int32_t x0, x1;  // [x0, x1)
    std::uint16_t label;
  };
  std::int32_t find(std::int32_t run);
  void join_rows(std::size_t row, std::size_t other);

  int height_ = 0;
  std::vector<Run> runs_;
  std::vector<std::int32_t> parent_;
  std::vector<std::size_t> row_start_ = {0};
};

}  // namespace stackmesh
