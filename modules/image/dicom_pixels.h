#pragma once
#include <string>
#include <vector>

namespace stackmesh {

/// The values of one grey DICOM image, with slope and intercept applied, row by row. Pixels as they are come through DCMTK;
/// compressed ones go to GDCM in a file of their own that holds nothing else, as GDCM ends the program on damaged headers.
/// @throws Error(input) naming the file, and the transfer syntax where it cannot be decoded
std::vector<double> read_dicom_pixels(const std::string& path, int rows, int columns);

}  // namespace stackmesh
