#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/warning.h"
#include "model/stack.h"

namespace stackmesh {

/// Puts virtual sections between the sections of a stack, which stay as they are, to the last digit
/// (docs/interpolate.md). Sections may be unevenly spaced. Where a label or hole lies within another label in two
/// neighbouring sections, there are as many between as keep it inside, whatever was requested; and a round end of the
/// stack that holds one gets sections beyond the last drawn one, in which both close, the inner one first.
/// @param stack gets them between and beyond its own, ascending by height
/// @param per_gap virtual sections in every gap; unset: as many as make a gap about as wide as a typical feature of
/// the contours (contour_feature_mm), where it is above 1.5 of them, none where its two sections are all but the same
/// @param threads 0: all of the machine; the result does not depend on it
/// @param warnings gets gaps where contours do not allow that nesting is kept, with the area of the opening
/// @return how many were added
std::size_t add_virtual_sections(Stack& stack, std::optional<int> per_gap, int threads, std::vector<Warning>& warnings);

/// What counts as a pixel of contour input, mm: a 64th of a typical contour's length or width, but not below the
/// typical edge. Where virtual sections so close would hold more than about half a million points, it is longer.
double contour_feature_mm(const Stack& stack);

}  // namespace stackmesh
