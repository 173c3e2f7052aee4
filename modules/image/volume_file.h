#pragma once
#include <string>

#include "image/file_names.h"
#include "model/intensity_volume.h"
#include "model/label_volume.h"

namespace stackmesh {

/// Reads one volume file through ITK; it may hold nothing but background. @throws Error(input)
LabelVolume read_volume_file(const std::string& path, FileFormat format);

/// Reads the intensities of one volume file through ITK. @throws Error(input)
IntensityVolume read_intensity_file(const std::string& path, FileFormat format);

}  // namespace stackmesh
