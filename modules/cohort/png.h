#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace stackmesh {

/// A picture of red, green and blue bytes, rows from the top, as a PNG file. Precondition: rgb has 3 * width * height
/// bytes.
std::string png_of(const std::vector<std::uint8_t>& rgb, int width, int height);

}  // namespace stackmesh
