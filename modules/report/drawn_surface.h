#pragma once
// A surface as the page draws it, before it is packed: internal to the module.
#include <array>
#include <cstdint>
#include <vector>

#include "report/surface_values.h"

namespace stackmesh {

/// A point of a DisplayGrid.
using GridCell = std::array<std::uint16_t, 3>;

struct DrawnTriangle {
  std::array<std::int32_t, 3> v;
  std::int32_t below, above;  ///< places in the page's LabelIndex; the normal points from below to above
  std::uint8_t angle;         ///< the smallest one, a quarter of a degree a step, at most 255
  TriangleValues values;      ///< of a solver model
};

/// Vertices to draw, and triangles between them.
struct DrawnSurface {
  std::vector<GridCell> points;
  std::vector<float> distances_mm;  ///< of each vertex to the labels' boundary, or none
  std::vector<DrawnTriangle> triangles;
};

}  // namespace stackmesh
