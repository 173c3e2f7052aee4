#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "model/label_layer.h"
#include "model/stack.h"

namespace stackmesh {

/// How many layers, on which raster.
struct VirtualLayerOptions {
  std::vector<int> per_gap;                   ///< virtual layers in each gap of the stack, evenly spaced; 0: none
  std::vector<char> watch;                    ///< gaps where nesting is looked after; empty: all that get layers
  std::array<std::int32_t, 2> unit = {1, 1};  ///< pixel of the raster along x and y, in grid units, 64 or more
  double tension = 0.25;                      ///< as InterpolateOptions::tension
  double low_end_mm = 0;   ///< beyond the first section: layers in which all labels close at that distance
  double high_end_mm = 0;  ///< the same beyond the last section
  int end_layers = 0;      ///< how many there, if any
  int threads = 0;         ///< 0: all
};

/// A gap where labels that lie within others in both sections cannot be kept inside between them.
struct OpenGap {
  std::size_t gap = 0;  ///< number of the gap, from 0
  double area_mm2 = 0;  ///< over which the wall is open
};

/// Interpolates label layers between the sections of a stack, as add_virtual_slices does between slices, but from
/// the exact contours: distances are those to the contours, and each layer knows where between two pixel centres
/// a border runs. Sections may be unevenly spaced. A label or hole that lies within another label in both sections
/// stays inside it (interpolate/nested_gap.h); where that takes more layers than requested, the gap gets more. Layers
/// come gap by gap from several threads, those of a gap in order, the first and last gap being those beyond the stack:
/// take(gap from 0, layer).
/// @return the gaps where nesting breaks whatever the number of layers
/// @throws Error(usage) for numbers that make no sense.
std::vector<OpenGap> interpolate_sections(const Stack& stack, const VirtualLayerOptions& options,
                                          const std::function<void(std::size_t, const LabelLayer&)>& take);

/// How many virtual sections each gap gets if it is to be about feature_mm wide, where it is above 1.5 of them.
std::vector<int> virtual_sections_per_gap(const Stack& stack, double feature_mm);

}  // namespace stackmesh
