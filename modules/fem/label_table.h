#pragma once
#include <string>
#include <vector>

#include "model/label_volume.h"

namespace stackmesh {

/// Reads label names and colours from a table: a Slicer colour table (`number name R G B A`, .ctbl or .txt) or an ITK-SNAP label
/// description (`number R G B A V M "name"`). Number 0 is passed over.
/// @throws Error(input) naming file and line
std::vector<LabelInfo> read_label_table(const std::string& path);

/// Gives the labels the names (and colours) of the table; those that it does not have keep what they have.
void apply_label_table(const std::vector<LabelInfo>& table, std::vector<LabelInfo>& labels);

/// A name for each label that every solver takes as a set's: letters, digits and `_`, beginning with a letter, at most 40
/// characters, distinct whatever the letter case; `label_<number>` where it has none.
std::vector<LabelInfo> solver_names(std::vector<LabelInfo> labels);

/// Makes a text fit for the name of a set: letters, digits and `_`, beginning with a letter.
std::string sanitised_name(const std::string& text);

}  // namespace stackmesh
