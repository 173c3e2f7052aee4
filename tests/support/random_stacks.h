#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "model/contours.h"
#include "model/label_volume.h"

namespace stackmesh::testing_support {

/// A small label volume that is awkward on purpose; the seed chooses kind, size, labels (up to 8), gap-to-pixel
/// ratio (0.1 to 10): smooth blobs, voxel noise, near copies (coincident edges), boxes and holes that come and go,
/// branching tubes, corner touches, empty sections between.
LabelVolume random_volume(std::uint64_t seed);

/// Contours of one to three labels whose sections are near copies of each other: jitter from 1e-1 down to 1e-14
/// of an edge, also exact copies.
std::vector<LabelContours> random_contours(std::uint64_t seed);

/// A volume of 2 to 7 voxels along each axis from any bytes, for the fuzzer: three bytes of sizes, one of labels (1 to
/// 7), three of spacings (0.5 to 4 mm, in steps, mostly 1), then two voxels a byte; what is not there is background.
/// One voxel at least is labelled.
LabelVolume volume_of_bytes(const std::uint8_t* data, std::size_t size);

/// A volume from a list of slices, each a list of rows of digits ("0110"); spacing 1 x 1 x gap mm.
LabelVolume volume_of(const std::vector<std::vector<const char*>>& slices, double gap_mm = 1);

}  // namespace stackmesh::testing_support
