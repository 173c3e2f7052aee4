#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "report/packed.h"

namespace stackmesh {

/// A directed piece of a plane curve between two labels (by their index), from one node to another.
struct CurveSegment {
  std::int32_t left = 0, right = 0;
  std::uint64_t from = 0, to = 0;  ///< names of its nodes; equal names join segments
  std::array<double, 2> a = {0, 0}, b = {0, 0};
};

/// A plane curve on a grid of whole numbers; it is closed when its first point is its last.
struct Polyline {
  std::int32_t left = 0, right = 0;
  std::vector<std::array<std::int32_t, 2>> points;
};

/// Joins segments at their nodes, rounds their points to multiples of `unit` and leaves points out that the rest
/// passes within `tolerance` (both in the segments' unit). Segments between a label and itself are dropped.
std::vector<Polyline> join_segments(std::vector<CurveSegment> segments, double unit, double tolerance);

/// Count, then per polyline: left, right, points, and the points as signed steps from their predecessor.
void pack(const std::vector<Polyline>& lines, Bytes& bytes);

}  // namespace stackmesh
