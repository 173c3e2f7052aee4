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

/// The layer of each label that --layer names.
/// @param texts labels as --label takes them, with the size of their layer
/// @param labels all that are meshed; voids among them
/// @param voids labels that are not filled
/// @throws Error(usage) for a label that is not there, is a void, or is named twice
std::map<Label, LayerSize> resolve_layers(const LayerTexts& texts, const std::vector<LabelInfo>& labels,
                                          const std::set<Label>& voids);

}  // namespace stackmesh
