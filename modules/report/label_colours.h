#pragma once
#include <string>
#include <vector>

#include "model/label_volume.h"

namespace stackmesh {

/// A colour "#rrggbb" for each label: its own where it carries one, else one that tells it from its neighbours in
/// the list; grey for the background.
std::vector<std::string> label_colours(const std::vector<LabelInfo>& labels);

}  // namespace stackmesh
