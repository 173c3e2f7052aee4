#pragma once
#include "base/monitor.h"
#include "model/faired_labels.h"
#include "model/label_volume.h"

namespace stackmesh {

/// How closely faired interfaces keep to the voxels.
struct FairOptions {
  /// how far a contour may leave the middle between pixel centres; at most 0.5: every voxel centre keeps its label
  double band_px = 0.5;
  /// slices of the volume that are interpolated between each two real ones: the band does not hold there
  int virtual_per_gap = 0;
  bool surface = true;  ///< also the interfaces as a whole
  int threads = 0;      ///< 0: all
};

/// Finds the smoothest interfaces that still separate the voxel centres (docs/fairing.md): a net with one vertex for
/// each cell of eight voxel centres that are not all alike, bent as little as its cells allow, cut at the planes of the
/// slices. Each vertex of a contour then lies strictly between its four pixel centres, so every centre keeps its label
/// and no two contours can cross. Deterministic for any number of threads.
/// @param volume the labels; every voxel centre keeps its own
/// @param stacking_axis 0 x, 1 y, 2 z
/// @param options band in pixels, and what to give
/// @param progress is told how far it is, and may cancel
FairedLabels fair_labels(const LabelVolume& volume, int stacking_axis, const FairOptions& options, Monitor& progress);

}  // namespace stackmesh
