#pragma once
#include <string>
#include <vector>

#include "model/geometry.h"

namespace stackmesh {

/// The directions and pixel size that all frames of a DICOM image share.
struct DicomGrid {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, normal{0, 0, 1};  ///< along a row, down a column, from slice to slice; LPS, orthonormal
  double pixel_x_mm = 1, pixel_y_mm = 1;

  DicomGrid() = default;
  /// From ImageOrientationPatient (six cosines) and PixelSpacing (between rows, between columns). @throws Error(input)
  DicomGrid(const std::vector<double>& orientation, const std::vector<double>& pixel_spacing, const std::string& where);

  /// @throws Error(input) unless another frame has the same directions and pixel size.
  void require_same(const std::vector<double>& orientation, const std::vector<double>& pixel_spacing,
                    const std::string& where) const;
  /// @throws Error(input) unless a frame's first pixel lies above (or beneath) that of another frame.
  void require_above(Vec3 first, Vec3 position, const std::string& where) const;
  double height(Vec3 position) const { return dot(position, normal); }
};

}  // namespace stackmesh
