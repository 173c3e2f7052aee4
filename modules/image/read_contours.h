#pragma once
#include <array>
#include <string>
#include <vector>

#include "model/geometry.h"

namespace stackmesh {

/// A closed polygon: x, y in mm; the last point joins the first. At least three distinct points, none
/// repeated in a row.
struct ContourPolygon {
  std::vector<std::array<double, 2>> points;
};

/// The polygons of a plane cut. Which side is inside is decided by nesting, not by their sense of rotation.
struct ContourSection {
  double z_mm = 0;
  std::vector<ContourPolygon> polygons;  ///< may be empty: a section in which the structure is absent
};

/// One structure drawn as plane contours.
struct ContourFile {
  std::string path;
  Label label = 1;                       ///< 0: only a name was given, the caller numbers it
  std::string name;                      ///< "" when none was given
  std::vector<ContourSection> sections;  ///< ascending in z_mm, all different
  std::vector<std::string> warnings;     ///< what was odd but could be mended
};

/// True for "FILE.cnt" and "LABEL=FILE.cnt".
bool is_contour_input(const std::string& path);

/// Reads a .cnt file: `S <sections>`, then per section `v <vertices> z <height>` and each closed polygon in
/// `{ }`, one `x y` a line, mm. The argument is "heart.cnt" (label 1), "3=heart.cnt" or "Heart=heart.cnt"
/// (label 0).
/// @throws Error(input) naming file and line, or section and contour.
ContourFile read_contour_file(const std::string& path_or_pair);

}  // namespace stackmesh
