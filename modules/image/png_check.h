#pragma once
#include <string>
#include <vector>

namespace stackmesh {

/// Checks a PNG down to its pixel rows and returns it with only the chunks that pixels need. OpenCV gives a
/// partly filled image for a file that was cut, and libpng prints to stderr on damage and on odd colour
/// profiles.
/// @throws Error(input) when it is damaged or truncated, or has a colour palette.
std::vector<unsigned char> checked_png(const std::vector<unsigned char>& bytes, const std::string& path);

}  // namespace stackmesh
