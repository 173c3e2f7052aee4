#include "image/dicom_grid.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "image/volume_header.h"

namespace stackmesh {

DicomGrid::DicomGrid(const std::vector<double>& o, const std::vector<double>& pixel_spacing, const std::string& where) {
  x = {o[0], o[1], o[2]};
  y = {o[3], o[4], o[5]};
  if (!(std::abs(norm(x) - 1) < 1e-2 && std::abs(norm(y) - 1) < 1e-2 && std::abs(dot(x, y)) < 1e-3))
    fail_input("the image's directions are not at right angles or not of unit length", where, "export the image again");
  x = (1 / norm(x)) * x;
  y = y - dot(x, y) * x;
  y = (1 / norm(y)) * y;
  normal = cross(x, y);
  require_spacing(pixel_spacing.data(), 2, where);
  pixel_y_mm = pixel_spacing[0];  // between rows
  pixel_x_mm = pixel_spacing[1];
}

void DicomGrid::require_same(const std::vector<double>& o, const std::vector<double>& pixel_spacing,
                             const std::string& where) const {
  const Vec3 a{o[0], o[1], o[2]}, b{o[3], o[4], o[5]};
  if (norm(a - x) > 1e-3 || norm(b - y) > 1e-3)
    fail_input("the frames or slices lie in different directions", where, "give images of one direction");
  if (std::abs(pixel_spacing[0] - pixel_y_mm) > 1e-4 * pixel_y_mm ||
      std::abs(pixel_spacing[1] - pixel_x_mm) > 1e-4 * pixel_x_mm)
    fail_input("the frames or slices have different pixel sizes", where, "give images of one pixel size");
}

void DicomGrid::require_above(Vec3 first, Vec3 position, const std::string& where) const {
  const Vec3 d = position - first;
  const double aside = norm(d - dot(d, normal) * normal), up = std::abs(dot(d, normal));
  if (aside > 0.05 * std::min(pixel_x_mm, pixel_y_mm) + 2e-4 * up)
    fail_input("the frames or slices do not stand above each other (a sheared grid, as of a tilted gantry)", where,
               "resample the image to a rectangular grid");
}

}  // namespace stackmesh
