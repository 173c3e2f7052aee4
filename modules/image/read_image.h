#pragma once
#include <string>

#include "model/intensity_volume.h"

namespace stackmesh {

/// What the user can say about an image that does not say it itself.
struct ReadImageOptions {
  std::string series;          ///< series instance UID where a DICOM folder holds several; default: it must hold one
  bool allow_outside = false;  ///< a detached header may name data files outside of its folder
};

/// Reads the intensities of one three-dimensional image (.nii .nii.gz .nrrd .nhdr .mha .mhd .gipl .gipl.gz) or of a
/// DICOM series (its folder, or one of its files), with the slope and intercept that its header gives applied.
/// @return grid and directions in LPS mm as the file gives them (oblique and left-handed too); finite values
/// @throws Error(input) naming the file when it is missing, damaged, no scalar image, holds a value that is not finite,
/// or its grid is not rectangular
IntensityVolume read_image(const std::string& path, const ReadImageOptions& options = {});

}  // namespace stackmesh
