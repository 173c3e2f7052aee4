#pragma once
#include <cstdint>
#include <vector>

#include "sections/fill_gap.h"

namespace stackmesh::interpolate {

/// The layers of a gap whose labels lie within one another: each level of nesting is interpolated with all that lies
/// inside it, and keeps a part of the wall's thickness from the level round it, so that what is inside in both slices
/// is inside between them. Holes count as labels of their own here.
struct NestedLayers {
  struct Layer {
    std::vector<std::int32_t> part;  ///< 0: background, holes as well
    std::vector<std::int8_t> level;  ///< of the label at a pixel; -1: outside, 0: nothing round it
    /// per level: distance to its outline, pixels, positive inside, up to 8
    std::vector<std::vector<float>> inside;
    std::vector<std::vector<float>> label_depth;  ///< per level, as LayerDepth::label
  };
  std::vector<std::uint16_t> label;  ///< of a part
  std::vector<Layer> layer;          ///< the virtual ones
  /// pixels at which two neighbouring layers are more than one level of nesting apart
  std::size_t breaks = 0;
  bool nested = false;  ///< the gap has more than one level
};

struct NestedOptions {
  int per_gap = 0;
  double tension = 0.25;
  std::array<double, 2> pixel_mm = {1, 1};
  double end_at = 0.5;          ///< share of the gap at which a part without counterpart closes,
  double inner_end_rel = 0.65;  ///< and of that for a part that lies in another one which ends as well
};

/// Interpolates a gap; `breaks` tells whether its layers are too few for the walls.
NestedLayers fill_nested_gap(const Gap& gap, const NestedOptions& options);

}  // namespace stackmesh::interpolate
