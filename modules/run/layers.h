#pragma once
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "model/label_volume.h"
#include "model/layers.h"

namespace stackmesh {

/// What --layer requests: labels by number or name.
using LayerTexts = std::vector<std::pair<std::string, LayerSize>>;

/// @param labels all that are meshed; voids among them
/// @throws Error(usage) for a label that is not there, is a void, or is named twice
std::map<Label, LayerSize> resolve_layers(const LayerTexts& texts, const std::vector<LabelInfo>& labels,
                                          const std::set<Label>& voids);

}  // namespace stackmesh
