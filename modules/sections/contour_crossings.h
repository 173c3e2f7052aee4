#pragma once
// Contours of one label that cross themselves or each other: internal to the module.
#include <vector>

#include "model/stack.h"

namespace stackmesh {

/// Contours united: everything that any of them goes round, however often and whichever way.
struct UnitedContours {
  std::vector<std::vector<GridPoint>> loops;  ///< boundary of the union, to be read even-odd
  double area = 0;                            ///< of the union, grid units squared
  double disputed = 0;                        ///< of that, where even-odd would have said outside
};

/// Unites contours that cross. Exact but for the rounding of crossings to the grid.
UnitedContours unite_contours(const std::vector<std::vector<GridPoint>>& contours);

}  // namespace stackmesh
