#pragma once
// Contours of one label in one section that are drawn more than once: internal to the module.
#include <cstddef>
#include <vector>

#include "model/contours.h"

namespace stackmesh {

/// Removes polygons that repeat an earlier one of the section: with the same points (from another one on, or the other
/// way round), or so near that the two cannot mean a wall: nowhere further apart than a hundredth of their extent and
/// 0.15 mm, or a fiftieth of it where they cross. A polygon that goes round itself twice goes round once.
/// @return how many were removed
std::size_t remove_copies(std::vector<ContourPolygon>& polygons);

}  // namespace stackmesh
