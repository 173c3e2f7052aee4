#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/complex.h"

namespace stackmesh {

/// Places where the labels of triangles contradict each other although nothing crosses.
struct LabelConflicts {
  std::size_t count = 0;
  /// triangle numbers, ascending in each pair; (t, t): the outside of a piece is no background
  std::vector<std::array<std::int32_t, 2>> pairs;
};

/// Finds sheets that passed through each other at a common edge, and pieces that lie in the wrong label. A closed
/// complex without self-intersections bounds a partition of space exactly when there are none:
/// - around every edge, what a triangle names on one side is what the next one names there (angles compared exactly);
/// - along a ray from every edge-connected piece, each triangle names on its near side what the last one named on its
/// far side, and
///   beyond the last lies the background.
/// @param complex closed and free of self-intersections; otherwise conflicts say little
LabelConflicts find_label_conflicts(const InterfaceComplex& complex, int threads, std::size_t limit);

}  // namespace stackmesh
