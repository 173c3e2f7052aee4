#pragma once
#include <array>
#include <cstdint>
#include <map>

#include "model/stack.h"
#include "sections/islands.h"

namespace stackmesh::interpolate {

/// A raster over the plane of a stack, in grid units.
struct Raster {
  /// centre of pixel (0, 0); half-integers, so that no contour point lies on a row
  double x0 = 0, y0 = 0;
  std::array<std::int32_t, 2> unit = {1, 1};  ///< pixel along x and y
  int width = 0, height = 0;
};

/// The label of each pixel centre in a section, by crossings along the rows; the section's contours go with it.
/// @param index_of the number to write for a label
Pixels rasterise(const Section& section, const Raster& raster, const std::map<Label, std::uint16_t>& index_of);

}  // namespace stackmesh::interpolate
