#pragma once
#include <cstdint>
#include <vector>

#include "contour/arcs.h"
#include "contour/slices.h"
#include "model/label_volume.h"

namespace stackmesh {

/// The 6-connected components of all labels of a volume, as runs along the volume's x.
class VoxelComponents {
 public:
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

/// Adds the corners of slice k (as corner keys) at which one of its components touches another one of the
/// same label in a neighbouring slice, by an edge or a corner of voxels. Were contours simplified there, the
/// two could grow together.
void touching_corners(const VoxelComponents& components, const Slice& slice, int k, const Slice& other,
                      int other_k, std::vector<std::uint64_t>& corners);

/// The key of pixel corner (x, y).
inline std::uint64_t corner_key(int x, int y) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32) | static_cast<std::uint32_t>(x);
}

}  // namespace stackmesh
