#pragma once
#include <cstdint>
#include <vector>

#include "model/slices.h"
#include "model/voxel_components.h"

namespace stackmesh {

/// A corner of a slice's pixels at which a component touches another one of its label.
struct TouchingCorner {
  std::uint64_t key;  ///< corner_key
  /// of the pixels of this slice that touch: bit dx + 2 dy for the one on sides dx, dy of the corner (0 low, 1 high)
  std::uint8_t quadrants;
  bool operator<(const TouchingCorner& o) const { return key < o.key; }
};

/// Adds the corners of slice k at which one of its components touches another one of the same label in a neighbouring
/// slice, by an edge or a corner of voxels. Were contours simplified there, the two could grow together; were they left
/// where they are, the label would touch itself along an edge.
void touching_corners(const VoxelComponents& components, const Slice& slice, int k, const Slice& other, int other_k,
                      std::vector<TouchingCorner>& corners);

/// Sorts them, one for each corner.
void unite(std::vector<TouchingCorner>& corners);

/// The key of pixel corner (x, y).
inline std::uint64_t corner_key(int x, int y) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32) | static_cast<std::uint32_t>(x);
}

}  // namespace stackmesh
