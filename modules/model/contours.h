#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/warning.h"
#include "model/geometry.h"

namespace stackmesh {

/// A closed polygon in the plane of its section; the last point joins the first. mm.
struct ContourPolygon {
  std::vector<std::array<double, 2>> points;  ///< x, y in the plane, mm
};

/// The polygons of one label at one height. Nesting decides what is inside (even-odd).
struct ContourSection {
  double z_mm = 0;                       ///< height along the stacking axis
  std::vector<ContourPolygon> polygons;  ///< none: the label is not there
  bool interpolated = false;             ///< made between the sections that the file has
};

/// The contours of one label, as one file or one structure of a file holds them. Orientation and order of the polygons
/// are free.
struct LabelContours {
  std::string path;                                                  ///< file, for messages; "": in memory
  Label label = 1;                                                   ///< 0: the caller numbers it
  std::string name;                                                  ///< "": none
  std::optional<std::array<std::uint8_t, 3>> colour = std::nullopt;  ///< red, green, blue
  std::vector<ContourSection> sections;                              ///< ascending z
  std::vector<Warning> warnings;                                     ///< what reading found odd but could mend
};

}  // namespace stackmesh
