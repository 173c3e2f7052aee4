#pragma once
#include <string>
#include <vector>

namespace stackmesh {

/// The stored values of one grey DICOM image, row by row, and what they stand for: slope * value + intercept.
struct DicomPixels {
  std::vector<double> stored;
  double slope = 1, intercept = 0;
  bool is_scaled() const { return slope != 1 || intercept != 0; }
  /// Slope and intercept applied.
  std::vector<double> rescaled();
};

/// Pixels as they are come through DCMTK;
/// compressed ones go to GDCM in a file of their own that holds nothing else, as GDCM ends the program on damaged
/// headers.
/// @throws Error(input) naming the file, and the transfer syntax where it cannot be decoded
DicomPixels read_dicom_pixels(const std::string& path, int rows, int columns);

}  // namespace stackmesh
