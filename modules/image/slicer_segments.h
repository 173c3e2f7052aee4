#pragma once
#include <array>
#include <string>
#include <vector>

#include "base/warning.h"
#include "image/text_header.h"
#include "model/label_volume.h"

namespace stackmesh {

/// A segment of a 3D Slicer segmentation (.seg.nrrd): the voxels of one layer that have one value.
struct SlicerSegment {
  LabelInfo label;
  int layer = 0;
  Label value = 1;
};

/// What the header of a .seg.nrrd says; no segments where it is another NRRD file.
struct SlicerSegmentation {
  std::vector<SlicerSegment> segments;
  /// the file is cropped there
  std::array<bool, 3> goes_on_low = {false, false, false}, goes_on_high = {false, false, false};
  std::vector<Warning> warnings;
};

/// @param size voxels along x, y, z; `layers` is 1 for a file of three dimensions.
/// @throws Error(input) naming the field
SlicerSegmentation read_slicer_segments(const TextHeader& header, const std::array<double, 3>& size, int layers,
                                        const std::string& path);

}  // namespace stackmesh
