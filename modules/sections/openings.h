#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace stackmesh {

/// An edge of an inner label's outline that reaches the outline of the label round it.
struct OpenEdge {
  std::int32_t a = 0, b = 0;           ///< its points, by which edges connect
  std::array<double, 2> from{}, to{};  ///< their places in the section, mm
};

/// The openings that connected edges make in a section, the largest first: " 20 mm2 at (1.0, 2.0, 3), ...". A section
/// stands for `thickness_mm` of height, so an opening's area is its length times that. Twelve are named, and the others
/// counted.
std::string list_openings(const std::vector<OpenEdge>& edges, double z_mm, double thickness_mm);

}  // namespace stackmesh
