#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "model/label_volume.h"

namespace stackmesh {

/// The layers of slice k: each holds size[0] * size[1] entries, 0 for nothing or 1 + an index into the segments.
using SliceLayers = std::function<std::vector<std::vector<std::uint16_t>>(int k)>;

/// Segments that may overlap to one label a voxel. Those that `labels` names are kept (empty: all); where they overlap,
/// the one named first wins, or without names the smaller one; a segment that would all but vanish under a larger one
/// goes before it. Fills voxels and labels of `volume` (whose size is set), with a warning of how much overlaps.
/// @throws Error(input) for a segment that was requested and has no voxel, Error(usage)
void join_segments(const std::vector<LabelInfo>& segments, const SliceLayers& layers, const std::string& labels,
                   const std::string& path, LabelVolume& volume);

}  // namespace stackmesh
