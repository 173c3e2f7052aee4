#pragma once
#include <cstdint>
#include <vector>

#include "validate/face_rectangles.h"
#include "validate/label_runs.h"

namespace stackmesh {

/// Cells of the dual grid, side by side along W. The cell (w, u, v) is the box between the voxel centres (w, u, v) and
/// (w + 1, u + 1, v + 1); cells begin at -1, as the grid has background all round.
struct BandStrip {
  std::int32_t begin, end, u, v;  ///< cells [begin, end) of the row (u, v)
};

/// The band of every label, by index into volume.labels: the cells that have a voxel centre of the label and one of
/// something else among their eight corners. A surface of the label that separates its centres from all others can lie
/// in it, and one that leaves it is further off than the voxels allow.
std::vector<std::vector<BandStrip>> find_bands(const LabelRuns& runs, std::size_t labels, int threads);

/// Their boxes, mm along W, U, V of the runs; each wider by `wider_mm` on either side of an axis.
std::vector<Rectangle> boxes_of_band(const LabelRuns& runs, const std::vector<BandStrip>& band, const Vec3& wider_mm);

}  // namespace stackmesh
