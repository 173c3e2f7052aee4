// GIPL, and what all headers share.
#include "image/volume_header.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

#include "base/error.h"
#include "base/warning.h"

namespace stackmesh {
namespace {

constexpr const char* again = "copy or export the file again";

[[noreturn]] void damaged(const std::string& what, const std::string& path) {
  fail_input(what, path, again);
}

template <class T>
T number_at(const std::vector<unsigned char>& bytes, std::size_t offset, bool swap) {
  unsigned char raw[sizeof(T)];
  std::memcpy(raw, bytes.data() + offset, sizeof(T));
  if (swap) std::reverse(raw, raw + sizeof(T));
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return value;
}

}  // namespace

/// GIPL: big-endian, 256 bytes. Its axes are left, posterior, superior.
VolumeHeader read_gipl_header(const std::string& path) {
  VolumeHeader header;
  bool compressed = false;
  const std::vector<unsigned char> h = read_start(path, 256, compressed);
  if (h.size() < 256) damaged("the file is truncated: no complete GIPL header", path);
  const bool swap = !is_big_endian_machine();
  const auto magic = number_at<std::uint32_t>(h, 252, swap);
  if (magic != 719555000u && magic != 4026526128u)
    damaged("this is no GIPL file, or its header is damaged or of the wrong byte order", path);
  header.data.count = 1;
  for (int d = 0; d < 4; ++d) {
    const int n = number_at<std::uint16_t>(h, 2 * d, swap);
    if (n == 0 && d < 2) damaged("the header is damaged: dimension " + std::to_string(d + 1) + " is 0", path);
    if (d == 3 && n > 1)
      fail_input("the image has more than three dimensions", path, "give one three-dimensional label volume");
    if (d < 3) header.size[d] = std::max(n, 1);
    header.data.count *= static_cast<std::uint64_t>(std::max(n, 1));
  }
  for (int d = 0; d < 3; ++d) header.spacing_mm[d] = number_at<float>(h, 10 + 4 * d, swap);
  require_spacing(header.spacing_mm.data(), 3, path);
  header.origin_mm = {number_at<double>(h, 204, swap), number_at<double>(h, 212, swap),
                      number_at<double>(h, 220, swap)};
  const int type = number_at<std::uint16_t>(h, 8, swap);
  switch (type) {
    case 7:
      header.data.type = VoxelType::i8;
      break;
    case 8:
      header.data.type = VoxelType::u8;
      break;
    case 15:
      header.data.type = VoxelType::i16;
      break;
    case 16:
      header.data.type = VoxelType::u16;
      break;
    case 31:
      header.data.type = VoxelType::u32;
      break;
    case 32:
      header.data.type = VoxelType::i32;
      break;
    case 64:
      header.data.type = VoxelType::f32;
      break;
    case 65:
      header.data.type = VoxelType::f64;
      break;
    default:
      fail_input("voxels of GIPL type " + std::to_string(type) + " are no labels", path,
                 "store the labels as whole numbers");
  }
  header.data.big_endian = true;
  header.data.encoding = compressed ? VoxelEncoding::deflate : VoxelEncoding::raw;
  DataPart part;
  part.path = path;
  part.skip = 256;
  header.data.parts = {part};
  return header;
}

std::vector<std::uint64_t> whole_sizes(const std::vector<double>& sizes, double dimensions, const std::string& path) {
  if (sizes.empty() || static_cast<double>(sizes.size()) != dimensions)
    damaged("the header is damaged: " + std::to_string(sizes.size()) + " sizes for " +
                std::to_string(static_cast<int>(dimensions)) + " dimensions",
            path);
  std::vector<std::uint64_t> whole;
  double voxels = 1;
  for (double n : sizes) {
    if (!(n >= 1 && n < 2147483648.0) || n != std::floor(n))
      damaged("the header is damaged: a size is no whole number above 0", path);
    voxels *= n;
    whole.push_back(static_cast<std::uint64_t>(n));
  }
  if (voxels > 1e15) damaged("the header is damaged: its sizes are absurd", path);
  return whole;
}

void require_spacing(const double* spacing, std::size_t count, const std::string& path) {
  for (std::size_t i = 0; i < count; ++i)
    if (!(spacing[i] >= 1e-12 && spacing[i] <= 1e12)) {  // in the file's unit; check_grid looks again, at mm
      std::ostringstream text;
      text << "the voxel size is " << spacing[i] << " along axis " << i + 1;
      fail_input(text.str(), path, "give the file a finite voxel size above 0, between 1e-12 and 1e12");
    }
}

VolumeHeader read_volume_header(const std::string& path, FileFormat format, bool allow_outside) {
  VolumeHeader header = format == FileFormat::nifti  ? read_nifti_header(path)
                        : format == FileFormat::gipl ? read_gipl_header(path)
                        : format == FileFormat::nrrd ? read_nrrd_volume_header(path, allow_outside)
                                                     : read_metaimage_header(path, allow_outside);
  if (!std::isfinite(norm(header.origin_mm))) damaged("the origin is not finite", path);
  check_voxel_data(header.data, path, header.warnings);
  return header;
}

}  // namespace stackmesh
