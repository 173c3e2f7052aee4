#pragma once
#include <string>
#include <vector>

#include "model/label_volume.h"

namespace stackmesh {

/// Reads label names and colours from a table: a Slicer colour table (`number name R G B A`, .ctbl or .txt) or an
/// ITK-SNAP label description (`number R G B A V M "name"`). Number 0 is passed over.
/// @throws Error(input) naming file and line
std::vector<LabelInfo> read_label_table(const std::string& path);

/// Gives the labels the names (and colours) of the table; those that it does not have keep what they have.
void apply_label_table(const std::vector<LabelInfo>& table, std::vector<LabelInfo>& labels);

}  // namespace stackmesh
