#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/complex.h"

namespace stackmesh {

/// What meets where it must not. Counts are complete; lists hold the first `limit` entries in ascending
/// order.
struct SelfIntersections {
  std::size_t count = 0;                           ///< pairs, plus one for each degenerate triangle
  std::size_t degenerate = 0;                      ///< triangles whose corners lie on one line
  std::vector<std::array<std::int32_t, 2>> pairs;  ///< triangle numbers, first < second; equal for a degenerate one
};

/// Tests every pair of triangles that could meet, exactly (see triangles_collide). A degenerate triangle is
/// counted by itself and not paired. The result does not depend on `threads`.
SelfIntersections find_self_intersections(const InterfaceComplex& complex, int threads, std::size_t limit);

}  // namespace stackmesh
