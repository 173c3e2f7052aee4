#pragma once
#include <optional>

#include "model/stack.h"

namespace stackmesh {

/// Puts virtual sections between the sections of a stack, which stay as they are, to the last digit
/// (docs/interpolate.md). Sections may be unevenly spaced.
/// @param per_gap virtual sections in every gap; unset: as many as make a gap about as wide as a typical feature of
/// the contours (contour_feature_mm), where it is above 1.5 of them
/// @return how many were added
std::size_t add_virtual_sections(Stack& stack, std::optional<int> per_gap, int threads);

/// What counts as a pixel of contour input, mm: a 64th of a typical contour's length or width, but not below the
/// typical edge. Where virtual sections so close would hold more than about half a million points, it is longer.
double contour_feature_mm(const Stack& stack);

}  // namespace stackmesh
