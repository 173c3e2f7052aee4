#include "image/array_labels.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/memory.h"
#include "image/palette.h"
#include "image/volume_file.h"
#include "image/volume_header.h"

namespace stackmesh {
namespace {

template <class T>
void convert(const void* values, LabelVolume& volume, const std::string& name) {
  Palette palette;
  const auto where = [&](std::size_t at) {
    const std::size_t nx = volume.size[0], ny = volume.size[1];
    return std::pair<std::string, std::string>(name, "voxel [" + std::to_string(at % nx) + ", " +
                                                         std::to_string(at / nx % ny) + ", " +
                                                         std::to_string(at / nx / ny) + "]");
  };
  palette.convert(static_cast<const T*>(values), volume.voxels.data(), volume.voxels.size(), where);
  palette.finish(volume, name);
}

}  // namespace

LabelVolume labels_of_array(const void* values, VoxelType type, const std::array<int, 3>& size,
                            const std::string& name) {
  LabelVolume volume;
  volume.kind = "array";
  volume.anatomical = false;
  volume.size = size;
  std::size_t count = 1;
  for (int d = 0; d < 3; ++d) {
    if (size[d] <= 0)
      fail_input("the array is empty: it has no voxels along its axis " + std::to_string(d), name,
                 "give an array of three dimensions that are all above 0");
    count *= static_cast<std::size_t>(size[d]);
  }
  require_memory(2 * count, "the labels of " + std::to_string(count) + " voxels", name, "crop the array");
  volume.voxels.resize(count);
  switch (type) {
    case VoxelType::u8:
      convert<std::uint8_t>(values, volume, name);
      break;
    case VoxelType::i8:
      convert<std::int8_t>(values, volume, name);
      break;
    case VoxelType::u16:
      convert<std::uint16_t>(values, volume, name);
      break;
    case VoxelType::i16:
      convert<std::int16_t>(values, volume, name);
      break;
    case VoxelType::u32:
      convert<std::uint32_t>(values, volume, name);
      break;
    case VoxelType::i32:
      convert<std::int32_t>(values, volume, name);
      break;
    case VoxelType::u64:
      convert<std::uint64_t>(values, volume, name);
      break;
    case VoxelType::i64:
      convert<std::int64_t>(values, volume, name);
      break;
    case VoxelType::f32:
      convert<float>(values, volume, name);
      break;
    case VoxelType::f64:
      convert<double>(values, volume, name);
      break;
  }
  check_label_volume(volume, name);
  return volume;
}

void place_volume(LabelVolume& volume, const std::array<Vec3, 4>& columns,
                  const std::optional<std::array<double, 3>>& spacing_mm, const std::string& name) {
  std::array<Vec3, 3> axes;
  for (int d = 0; d < 3; ++d) {
    volume.spacing_mm[d] = spacing_mm ? (*spacing_mm)[d] : norm(columns[d]);
    if (!std::isfinite(norm(columns[d])) || norm(columns[d]) <= 0)
      fail_input("column " + std::to_string(d) + " of the affine is zero or not finite", name,
                 "give the affine of an image: index to mm, of shape (4, 4)");
    axes[d] = unit(columns[d]);
  }
  require_spacing(volume.spacing_mm.data(), 3, name);
  volume.axes = orthonormal_axes(axes, name);
  volume.origin_mm = columns[3] + Vec3{0, 0, 0};  // -0 becomes 0
  if (!std::isfinite(norm(volume.origin_mm)))
    fail_input("the origin of the affine is not finite", name,
               "give the affine of an image: index to mm, of shape (4, 4)");
  volume.anatomical = true;
}

}  // namespace stackmesh
