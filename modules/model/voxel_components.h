#pragma once
#include <cstdint>
#include <vector>

#include "model/label_volume.h"
#include "model/slices.h"

namespace stackmesh {

/// The 6-connected components of all labels of a volume, as runs along the volume's x.
class VoxelComponents {
 public:
  /// `axes` are those of the stack, in which of() is asked.
  VoxelComponents(const LabelVolume& volume, const StackAxes& axes);
  /// The component's number of a voxel that is not background, in the stack's axes.
  std::int32_t of(int x, int y, int slice) const;

 private:
  struct Run {
    std::int32_t x0, x1;  // [x0, x1)
    std::uint16_t label;
  };
  std::int32_t find(std::int32_t run);
  void join_rows(std::size_t row, std::size_t other);

  StackAxes axes_;
  int height_ = 0;
  std::vector<Run> runs_;
  std::vector<std::int32_t> parent_;  // a root is its own; never after its child
  std::vector<std::size_t> row_start_ = {0};
};

}  // namespace stackmesh
