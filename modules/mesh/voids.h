#pragma once
#include <cstdint>
#include <set>
#include <vector>

#include "model/complex.h"

namespace stackmesh {

/// A complex whose voids are empty: they bound the other labels and are background to whatever fills it.
struct Hollowed {
  /// points as before; triangles with a filled label on one side or both, in their order
  InterfaceComplex complex;
  std::vector<std::int32_t> original;  ///< per triangle: which it was
  std::vector<Label> behind;           ///< per triangle: the void on its open side, 0 where there is none
};
/// Makes background of the voids; triangles between two voids, or a void and the background, are left out. Without
/// voids the complex stays as it is.
Hollowed hollowed(const InterfaceComplex& complex, const std::set<Label>& voids);

/// Gives the open sides of a hollowed complex's triangles, or of equal parts of each in their order, the void behind
/// them.
void name_voids(std::vector<InterfaceTriangle>& triangles, const std::vector<Label>& behind);

}  // namespace stackmesh
