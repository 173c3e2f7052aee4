#include "sections/contour_names.h"

#include <cstdio>

namespace stackmesh {

std::string name_of(const LabelContours& file) {
  return file.name.empty() ? "label " + std::to_string(file.label) : "'" + file.name + "'";
}

std::string formatted(double value, const char* conversion) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, conversion, value);
  return buffer;
}

std::string list_heights(const std::vector<double>& z_mm) {
  std::string text;
  for (std::size_t i = 0; i < z_mm.size() && i < 8; ++i) text += (i > 0 ? ", " : "") + formatted(z_mm[i], "%.6g");
  return z_mm.size() > 8 ? text + " and " + std::to_string(z_mm.size() - 8) + " more" : text;
}

}  // namespace stackmesh
