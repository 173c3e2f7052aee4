#pragma once
#include <string>
#include <vector>

#include "model/contours.h"
#include "model/stack.h"

namespace stackmesh {

/// Makes sections out of contour polygons: a constrained triangulation of each section's polygons, regions
/// grown in it, and nesting by region [Wang et al. 2005, 3.1]. Orientation of the input is free. Where labels
/// overlap, the inner (smaller) one wins. The grid is a power of two mm, about 1e-5 of the box.
/// @throws Error(input) naming file, section and contour where contours of one label cross themselves or each
/// other, where labels share a number, or where fewer than two sections hold contours.
Stack sections_from_contours(const std::vector<ContourFile>& files, std::vector<std::string>& warnings);

}  // namespace stackmesh
