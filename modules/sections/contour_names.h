#pragma once
// How messages about drawn contours name labels and heights: internal to the module.
#include <string>
#include <vector>

#include "model/contours.h"

namespace stackmesh {

/// The label's name in quotes, or "label 3" where it has none.
std::string name_of(const LabelContours& file);

/// The value as std::printf writes it with that conversion for a double.
std::string formatted(double value, const char* conversion = "%g");

/// "-3.5, 0, 3.5 and 4 more": the first eight heights, mm.
std::string list_heights(const std::vector<double>& z_mm);

}  // namespace stackmesh
