#pragma once
// A surface drawn with fewer triangles, whatever it is like: internal to the module.
#include "report/drawn_surface.h"

namespace stackmesh {

/// Joins the vertices of each cubic cell that bound the same labels, at their mean. Triangles that fall on each other
/// become one. What is kept of those that are joined are the largest distance and the smallest angle. Patches may come
/// apart where they meet.
/// @param cell_units width of a cell in units of the grid
DrawnSurface join_cells(const DrawnSurface& fine, double cell_units);

}  // namespace stackmesh
