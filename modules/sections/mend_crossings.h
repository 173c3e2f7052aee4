#pragma once
// Contours of a drawn section that cross others of their label: internal to the module.
#include <set>
#include <vector>

#include "model/edge_grid.h"
#include "sections/drawn_level.h"

namespace stackmesh {

/// Contours of one label that cross themselves or each other at a height are replaced by their union, where little of
/// it is drawn over twice. Whether they cross is decided on the given coordinates, exactly: what only rounding makes
/// cross is left to snap rounding.
/// @param repair false: a crossing is refused
/// @param segments of the level's contours, grid units; those that cross are replaced @param sources where each is from
/// @return indices of the files whose contours were united
/// @throws Error(input) naming file, section and contour where a crossing is refused, or leaves too much in doubt
std::set<std::size_t> mend_crossings(const std::vector<LabelContours>& files, const DrawnLevel& level,
                                     const DrawnGrid& grid, bool repair, std::vector<GridSegment>& segments,
                                     std::vector<SourceSegment>& sources);

}  // namespace stackmesh
