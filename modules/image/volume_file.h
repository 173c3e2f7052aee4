#pragma once
#include <array>
#include <string>

#include "image/file_names.h"
#include "model/intensity_volume.h"
#include "model/label_volume.h"

namespace stackmesh {

/// Reads one volume file; it may hold nothing but background. `labels` is the order of priority where the file
/// holds segments that overlap; those that it does not name are then left out. `allow_outside`: a detached header may
/// name files outside of its folder. @throws Error(input)
LabelVolume read_volume_file(const std::string& path, FileFormat format, const std::string& labels = "",
                             bool allow_outside = false);

/// Reads the intensities of one volume file. @throws Error(input)
IntensityVolume read_intensity_file(const std::string& path, FileFormat format, bool allow_outside = false);

/// The nearest orthonormal axes to nearly orthonormal ones (headers carry rounded cosines).
/// @throws Error(input) naming `path` where they are off by more than 1e-4.
std::array<Vec3, 3> orthonormal_axes(std::array<Vec3, 3> axes, const std::string& path);

}  // namespace stackmesh
