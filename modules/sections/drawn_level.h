#pragma once
// What the steps from drawn contours to sections share: internal to the module.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "model/contours.h"
#include "model/stack.h"

namespace stackmesh {

/// All labels' polygons at one height. Labels are known by the index of their contour file.
struct DrawnLevel {
  double z_mm = 0;                             ///< height along the stacking axis
  std::vector<const ContourSection*> of_file;  ///< null: the file has none at this height
  std::vector<std::size_t> index_in_file;      ///< of that section among those of its file, from 0
};

/// The segment of a drawn contour that begins at one of its points.
struct SourceSegment {
  std::size_t file, polygon, point;
};

/// The integer grid onto which drawn contours are rounded, in the plane of a section.
struct DrawnGrid {
  double x0_mm = 0, y0_mm = 0;  ///< place of the grid point (0, 0), in the coordinates of the contours
  double unit_mm = 1;           ///< a power of two

  GridPoint nearest(const std::array<double, 2>& p_mm) const {
    return {static_cast<std::int32_t>(std::lround((p_mm[0] - x0_mm) / unit_mm)),
            static_cast<std::int32_t>(std::lround((p_mm[1] - y0_mm) / unit_mm))};
  }
  std::array<double, 2> place_of(GridPoint p) const { return {x0_mm + unit_mm * p.x, y0_mm + unit_mm * p.y}; }
};

}  // namespace stackmesh
