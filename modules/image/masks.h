#pragma once
#include <string>
#include <vector>

#include "model/label_volume.h"

namespace stackmesh {

/// Joins one mask volume per structure, in the order given, to labels 1..N named by the files. @throws
/// Error(input)
LabelVolume read_masks(const std::vector<std::string>& files, bool allow_outside = false);

}  // namespace stackmesh
