#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "model/label_volume.h"

namespace stackmesh {

/// Stacks PNG/TIFF label images in the order given (a TIFF's pages one after another). @throws Error(input)
LabelVolume read_slices(const std::vector<std::string>& files, const std::optional<std::array<double, 3>>& spacing_mm);

}  // namespace stackmesh
