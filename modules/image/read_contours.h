#pragma once
#include <string>

#include "model/contours.h"

namespace stackmesh {

/// True for "FILE.cnt" and "LABEL=FILE.cnt".
bool is_contour_input(const std::string& path);

/// Reads a .cnt file: `S <sections>`, then per section `v <vertices> z <height>` and each closed polygon in
/// `{ }`, one `x y` a line, mm. The argument is "heart.cnt" (label 1), "3=heart.cnt" or "Heart=heart.cnt"
/// (label 0).
/// @throws Error(input) naming file and line, or section and contour.
LabelContours read_contour_file(const std::string& path_or_pair);

}  // namespace stackmesh
