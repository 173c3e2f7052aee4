#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/warning.h"
#include "model/edge_grid.h"
#include "model/stack.h"

namespace stackmesh {

/// A piece of segment `source` after noding, oriented along it.
struct NodedEdge {
  std::int32_t a = 0, b = 0, source = 0;
};

/// The segments of one section after noding: they meet each other, and those of the neighbouring sections, at
/// common end points only.
struct NodedSegments {
  std::vector<GridPoint> points;
  std::vector<NodedEdge> edges;
};

/// True hot-pixel snap rounding (\cite hobby1999, \cite guibas1998) of every section together with its
/// two neighbours. Hot pixels are all end points and the pixels of all crossings; every segment is routed
/// through the hot pixels of its own and both neighbouring sections that it traverses, and what it is routed
/// through is hot for its neighbours in turn (a fixpoint over original segments, so nothing creeps).
/// Segments are exact integers with |coordinates| <= 2^28. This replaces the paper's intersection points
/// (3.2.1), snapping (3.2.1) and hanging-node repair (3.5) of \cite wang2005.
std::vector<NodedSegments> node_segments(const std::vector<std::vector<GridSegment>>& sections, int threads);

/// What rounding changed in a stack.
struct SnapRoundingReport {
  std::size_t added_vertices = 0;  ///< contour vertices that a neighbour or a crossing brought in
  std::vector<Warning> warnings;
};

/// Snap-rounds the stack's sections in place; edges that fall together are merged by composing their labels.
/// @throws Error(input) when contours of a section cross in a way that no labelling of the plane explains.
SnapRoundingReport snap_round(Stack& stack, int threads);

}  // namespace stackmesh
