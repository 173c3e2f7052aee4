#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "model/complex.h"
#include "validate/boundaries.h"
#include "validate/label_runs.h"

namespace stackmesh {

/// What walking every grid line through a complex tells, by index into volume.labels.
struct GridWalk {
  std::vector<std::size_t> input, mesh,
      both;                         ///< voxel centres of the label: in the input, in the mesh, in both
  std::vector<std::int32_t> solid;  ///< per piece of the boundaries: the smallest piece of the same solid
  std::vector<std::pair<std::int32_t, std::int32_t>>
      meets;  ///< (input component, solid) that share a voxel centre of the right label
  /// Per row of the boundaries, whatever label it stands for:
  std::vector<std::size_t> row_centres;  ///< voxel centres in it
  std::vector<Vec3> row_middle;          ///< their mean, along W, U, V in voxels
  std::vector<std::size_t> overlap;      ///< at [row * labels + label]: of those, in that label of the input
};

/// Follows each line of voxel centres, from crossing to crossing, through the labels of the complex. The
/// lines are a tiny fraction of a pixel beside the centres, so that they hit no edge. `grid_points`: the
/// complex's points along W, U, V (LabelRuns::to_grid); `row_label`: index into volume.labels for each row of
/// the boundaries, or -1. With `step` above 1 only every step-th plane is walked, and `input` counts those.
GridWalk walk_grid(const InterfaceComplex& complex, const Boundaries& boundaries, const LabelRuns& runs,
                   const std::vector<Vec3>& grid_points, const std::vector<std::int32_t>& row_label, std::size_t labels,
                   int threads, int step = 1);

}  // namespace stackmesh
