#pragma once
#include <cstdint>
#include <vector>

namespace stackmesh::interpolate {

/// The slices of one gap, each pixel with its group (0: background); the first and the last one are real.
struct GapLayers {
  int width = 0, height = 0;
  std::vector<std::vector<std::int32_t>> group;
  std::vector<std::uint16_t> label;  ///< of a group
};

/// Mends the virtual layers so that each group hangs together with its real islands, and no two groups of one
/// label touch by a face. Given: pixels of one group in both real slices have it in all layers. What offends
/// is given to the background or, where it lies inside tissue, to a neighbour. @return voxels that were
/// changed.
std::size_t keep_components(GapLayers& gap);

}  // namespace stackmesh::interpolate
