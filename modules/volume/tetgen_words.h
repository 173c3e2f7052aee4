#pragma once
// Private to the module: what TetGen says of a surface that it refuses.
#include <cstdint>
#include <string>
#include <vector>

#include "volume/compact.h"

namespace stackmesh::volume {

/// What TetGen complained about, as one line; empty if it did not complain. Monitor, point numbers (they are
/// not the complex's) and hints are left out.
std::string complaint(const std::string& text);

/// The triangles that TetGen names by their corners, "[a, b, c] #facet", or whose edges it names, "(a, b)".
std::vector<std::int32_t> named_triangles(const std::string& text, const Compact& input);

}  // namespace stackmesh::volume
