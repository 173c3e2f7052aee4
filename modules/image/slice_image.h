#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/warning.h"
#include "image/voxel_data.h"

namespace stackmesh {

/// One slice: the numbers that the file stores, row by row, whatever it says of their colours.
struct SliceImage {
  std::uint64_t width = 0, height = 0;
  VoxelType type = VoxelType::u8;
  std::vector<unsigned char> values;  ///< width * height numbers in this machine's byte order
};

/// One number a pixel of several: they must be alike ("grey in truth"), a last one of opacity does not count.
/// @param colours how many of a pixel's `samples` are colours; @throws Error(input) naming the first pixel where they
/// differ
void take_grey(const unsigned char* pixels, std::uint64_t count, int samples, int colours, std::size_t bytes,
               std::uint64_t row, unsigned char* out, const std::string& where);

/// Decodes a PNG file: grey as it is stored (1 to 16 bits, not stretched), colour where it is grey in truth. Every
/// row must be there, and the check sum of every chunk right. @throws Error(input)
SliceImage read_png(const std::vector<unsigned char>& bytes, const std::string& path);

/// Calls page(image, number from 1, is there more than one) for every page of a TIFF file; palettes and "white is zero"
/// do not change the stored numbers. @throws Error(input) naming file and page
void read_tiff(const std::string& path, std::vector<Warning>& warnings,
               const std::function<void(SliceImage&&, int, bool)>& page);

}  // namespace stackmesh
