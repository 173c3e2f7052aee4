#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "model/label_layer.h"
#include "model/stack.h"

namespace stackmesh {

struct VirtualLayerOptions {
  std::vector<int> per_gap;                   ///< virtual layers in each gap of the stack, evenly spaced; 0: none
  std::array<std::int32_t, 2> unit = {1, 1};  ///< pixel of the raster along x and y, in grid units, 64 or more
  double tension = 0.25;                      ///< as InterpolateOptions::tension
  int threads = 0;                            ///< 0: all
};

/// Interpolates label layers between the sections of a stack, as add_virtual_slices does between slices, but from
/// the exact contours: distances are those to the contours, and each layer knows where between two pixel centres
/// a border runs. Sections may be unevenly spaced. Layers come one by one, from several threads:
/// take(gap, index in the gap from 0, layer).
/// @throws Error(usage) for numbers that make no sense.
void interpolate_sections(const Stack& stack, const VirtualLayerOptions& options,
                          const std::function<void(std::size_t, int, const LabelLayer&)>& take);

/// How many virtual sections each gap gets if it is to be about feature_mm wide, where it is above 1.5 of them.
std::vector<int> virtual_sections_per_gap(const Stack& stack, double feature_mm);

}  // namespace stackmesh
