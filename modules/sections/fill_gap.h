#pragma once
#include <array>

#include "sections/islands.h"
#include "sections/keep_components.h"

namespace stackmesh::interpolate {

/// A gap between two slices: its own two and their outer neighbours (null at the stack's ends), all cropped
/// alike.
struct Gap {
  const Pixels *before = nullptr, *low = nullptr, *high = nullptr, *after = nullptr;
  std::array<double, 2> neighbours_rel = {1, 1};  ///< the gaps beneath and above, as a share of this one
  double end_at = 0.5;                            ///< share of the gap at which a part without counterpart closes,
  double gap_mm = 0;  ///< where this is 0; else parts close where their areas in the two slices before say
};

/// How far a virtual layer's pixels are inside or outside, in pixels, 0 where it is not known.
struct LayerDepth {
  std::vector<float> tissue;  ///< distance to the outline of the tissue
  std::vector<float> label;   ///< by how much the pixel's label wins over the next one
};

/// The virtual layers of a gap between its real ones, evenly spaced, components kept.
/// @param depth if given, one entry for each virtual layer.
GapLayers fill_gap(const Gap& gap, int per_gap, double tension, const std::array<double, 2>& pixel_mm,
                   std::vector<LayerDepth>* depth = nullptr);

}  // namespace stackmesh::interpolate
