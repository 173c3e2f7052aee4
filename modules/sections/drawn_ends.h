#pragma once
// Heights and ends of drawn labels, before their contours become sections: internal to the module.
#include <vector>

#include "model/contours.h"
#include "model/stack.h"
#include "sections/polygons.h"

namespace stackmesh {

/// Sections of one label at nearly one height (same_height_mm, a hundredth of its gap) become one.
void join_sections(LabelContours& file, double same_height_mm);

/// Gives one height to what different labels have at nearly the same one: same_height_mm, or 3 % of the smallest usual
/// gap.
void align_heights(std::vector<LabelContours>& files, double same_height_mm);

/// How each label ends, by its own contours. Where other labels have contours beyond its last one that its end reaches,
/// or the end would come out elsewhere in the common stack, the label gets interpolated contours there: copies up to a
/// flat end (with one on the end itself), the sections of its dome up to a round one.
std::vector<DrawnEnds> extend_ends(std::vector<LabelContours>& files, const ContourStackOptions& options);

}  // namespace stackmesh
