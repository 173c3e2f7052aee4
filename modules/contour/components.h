#pragma once
#include <cstdint>
#include <vector>

#include "model/slices.h"
#include "model/voxel_components.h"

namespace stackmesh {

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
