#pragma once
#include <string>

#include "model/label_volume.h"

namespace stackmesh {

/// Reads a DICOM SEG: binary, fractional (cut at half of its largest value, with a warning) or a label map. Frames are
/// placed by their plane positions, segments become labels with their numbers, names and colours, and overlaps go by
/// join_segments(). The grid ends at the first and last frame, which are not taken for the image's border.
/// @throws Error(input) naming the file, and the frame or segment
LabelVolume read_segmentation(const std::string& path, const std::string& labels);

}  // namespace stackmesh
