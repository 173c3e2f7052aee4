#pragma once
#include <array>

#include "interpolate/islands.h"
#include "interpolate/keep_components.h"

namespace stackmesh::interpolate {

/// A gap between two slices: its own two and their outer neighbours (null at the stack's ends), all cropped
/// alike.
struct Gap {
  const Pixels *before = nullptr, *low = nullptr, *high = nullptr, *after = nullptr;
};

/// The virtual layers of a gap between its real ones, components kept.
GapLayers fill_gap(const Gap& gap, int per_gap, double tension, const std::array<double, 2>& pixel_mm);

}  // namespace stackmesh::interpolate
