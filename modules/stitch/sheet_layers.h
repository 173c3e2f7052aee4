#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "base/disjoint_sets.h"

namespace stackmesh {

/// A layer for each sheet of a slab, so that of two sheets that meet over a coincident edge the lower one is in the
/// lower layer.
/// @param below (lower sheet, higher sheet): what is wished for, in any order
/// @param same sheets that share their rims are of one layer; sheets whose orders contradict each other in a cycle join
/// them
std::vector<int> sheet_layers(std::vector<std::pair<std::int32_t, std::int32_t>> below, DisjointSets same);

}  // namespace stackmesh
