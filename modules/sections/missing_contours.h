#pragma once
// Contours between the heights that a label has: internal to the module.
#include <vector>

#include "model/contours.h"

namespace stackmesh {

/// The contours of one label at a height between two of its sections: the two are stitched, and the surface is cut at
/// that height, so that the result is what the stitched surface has there.
ContourSection contours_between(const ContourSection& low, const ContourSection& high, double z_mm);

/// The contours of the dome in which a label ends, `way_mm` beyond its last section, which stands for a gap of that
/// length; a dome of slices is higher than one of plane cuts (docs/stitching.md, Ends).
ContourSection dome_section(const ContourSection& last, double gap_mm, bool slices, double way_mm);

}  // namespace stackmesh
