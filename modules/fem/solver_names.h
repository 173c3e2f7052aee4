#pragma once
#include <string>
#include <vector>

#include "model/label_volume.h"

namespace stackmesh {

/// A name for each label that every solver takes as a set's: letters, digits and `_`, beginning with a letter, at most
/// 40 characters, distinct whatever the letter case; `label_<number>` where it has none.
std::vector<LabelInfo> solver_names(std::vector<LabelInfo> labels);

/// Makes a text fit for the name of a set: letters, digits and `_`, beginning with a letter.
std::string sanitised_name(const std::string& text);

}  // namespace stackmesh
