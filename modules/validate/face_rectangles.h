#pragma once
#include <algorithm>
#include <vector>

#include "validate/box_tree.h"
#include "validate/label_runs.h"

namespace stackmesh {

/// An axis-parallel box along W, U, V of the runs; a rectangle where it has no thickness along one of them.
struct Rectangle {
  Vec3 low, high;
};

inline double rectangle_distance2(const Vec3& p, const Rectangle& r) {
  const double x = std::max({0.0, r.low.x - p.x, p.x - r.high.x}), y = std::max({0.0, r.low.y - p.y, p.y - r.high.y}),
               z = std::max({0.0, r.low.z - p.z, p.z - r.high.z});
  return x * x + y * y + z * z;
}

/// The strips of a label's voxel faces as rectangles.
std::vector<Rectangle> rectangles_of(const LabelRuns& runs, const std::vector<FaceStrip>& strips);

std::vector<Box> boxes_of(const std::vector<Rectangle>& rectangles);

}  // namespace stackmesh
