#include "image/volume_file.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "base/error.h"
#include "base/memory.h"
#include "base/warning.h"
#include "image/palette.h"
#include "image/segments.h"
#include "image/volume_header.h"
#include "model/label_volume.h"

namespace stackmesh {

std::array<Vec3, 3> orthonormal_axes(std::array<Vec3, 3> a, const std::string& path) {
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) {
      const double error = std::abs(dot(a[i], a[j]) - (i == j ? 1 : 0));
      worst = error <= worst ? worst : error;  // keeps a NaN
    }
  if (!(worst <= 2e-4))
    fail_input("the voxel grid is sheared: its directions are not at right angles or not of unit length", path,
               "resample the labels to a rectangular grid with nearest neighbour");
  for (int pass = 0; worst > 1e-15 && pass < 3; ++pass) {
    // One step of the polar decomposition treats all axes alike: A <- A (3 I - A^T A) / 2.
    const std::array<Vec3, 3> b = a;
    for (int i = 0; i < 3; ++i) {
      a[i] = 1.5 * b[i];
      for (int j = 0; j < 3; ++j) a[i] = a[i] - 0.5 * dot(b[j], b[i]) * b[j];
    }
  }
  for (Vec3& v : a) v = v + Vec3{0, 0, 0};  // -0 becomes 0
  return a;
}

namespace {

const char* kind_of(FileFormat format) {
  switch (format) {
    case FileFormat::nifti:
      return "nifti";
    case FileFormat::nrrd:
      return "nrrd";
    case FileFormat::gipl:
      return "gipl";
    default:
      return "metaimage";
  }
}

template <class Volume>
void take_grid(const VolumeHeader& header, Volume& volume, const std::string& path) {
  volume.size = header.size;
  volume.spacing_mm = header.spacing_mm;
  require_spacing(volume.spacing_mm.data(), 3, path);
  volume.origin_mm = header.origin_mm + Vec3{0, 0, 0};  // -0 becomes 0
  volume.axes = orthonormal_axes(header.axes, path);
  check_grid(volume.spacing_mm, volume.origin_mm, path);
}

std::size_t voxels_of(const VolumeHeader& header) {
  return static_cast<std::size_t>(header.size[0]) * header.size[1] * header.size[2];
}

/// Calls read(T()) with the type of the voxels.
template <class Read>
void by_type(VoxelType type, Read read) {
  switch (type) {
    case VoxelType::u8:
      return read(std::uint8_t());
    case VoxelType::i8:
      return read(std::int8_t());
    case VoxelType::u16:
      return read(std::uint16_t());
    case VoxelType::i16:
      return read(std::int16_t());
    case VoxelType::u32:
      return read(std::uint32_t());
    case VoxelType::i32:
      return read(std::int32_t());
    case VoxelType::u64:
      return read(std::uint64_t());
    case VoxelType::i64:
      return read(std::int64_t());
    case VoxelType::f32:
      return read(float());
    case VoxelType::f64:
      return read(double());
  }
}

/// All values, of which those that are not finite may stand for nothing.
template <class T>
void read_values(const VolumeHeader& header, const std::string& path, T* values, std::vector<Warning>& warnings) {
  read_voxel_data(header.data, path, values, warnings);
  if constexpr (std::is_floating_point_v<T>) {
    std::size_t bad = 0;
    for (std::uint64_t i = 0; header.nan_is_zero && i < header.data.count; ++i)
      if (!std::isfinite(values[i])) values[i] = 0, ++bad;
    if (bad > 0)
      warnings.push_back(warning_at(
          WarningCode::values_changed, path,
          std::to_string(bad) + (bad == 1 ? " value that is" : " values that are") + " not finite, taken as 0"));
  }
}

class LabelReader {
 public:
  LabelReader(const VolumeHeader& header, const std::string& path, LabelVolume& volume)
      : header_(header), path_(path), volume_(volume) {}

  void run() {
    by_type(header_.data.type, [&](auto t) { read(t); });
    palette_.finish(volume_, path_);
  }

 private:
  Palette::Where where(std::size_t first = 0) const {
    return [this, first](std::size_t offset) {
      const std::size_t i = first + offset, x = i % volume_.size[0], y = i / volume_.size[0] % volume_.size[1],
                        z = i / volume_.size[0] / volume_.size[1];
      return std::pair<std::string, std::string>(
          path_, "voxel (" + std::to_string(x) + ", " + std::to_string(y) + ", " + std::to_string(z) + ")");
    };
  }

  /// Values of one or two bytes are read straight into the result's own memory.
  template <class T>
  void read(T) {
    const std::size_t count = voxels_of(header_);
    if (sizeof(T) <= 2 && !header_.is_scaled()) {
      require_memory(2 * count, "the labels of " + std::to_string(count) + " voxels", path_, "crop the volume");
      volume_.voxels.resize(count);
      T* raw = reinterpret_cast<T*>(reinterpret_cast<char*>(volume_.voxels.data()) + count * (sizeof(T) == 1 ? 1 : 0));
      read_voxel_data(header_.data, path_, raw, volume_.warnings);
      palette_.convert(raw, volume_.voxels.data(), count, where());
      return;
    }
    require_memory((2 + sizeof(T)) * count, "the labels of " + std::to_string(count) + " voxels", path_,
                   "crop the volume, or store it as 8- or 16-bit whole numbers");
    const std::unique_ptr<T[]> raw(new T[count]);
    read_values(header_, path_, raw.get(), volume_.warnings);
    volume_.voxels.resize(count);
    if (header_.is_scaled()) convert_scaled(raw.get(), count);
    else palette_.convert(raw.get(), volume_.voxels.data(), count, where());
  }

  /// Whole numbers that a slope has made less so.
  template <class T>
  void convert_scaled(const T* raw, std::size_t count) {
    LabelRounding rounding(header_.slope, header_.intercept);
    std::vector<double> values(1 << 14);
    for (std::size_t at = 0; at < count; at += values.size()) {
      const std::size_t n = std::min(values.size(), count - at);
      for (std::size_t i = 0; i < n; ++i) values[i] = rounding.round(static_cast<double>(raw[at + i]));
      palette_.convert(values.data(), volume_.voxels.data() + at, n, where(at));
    }
    warn_of_rounded_labels(rounding.worst(), path_, volume_.warnings);
  }

  const VolumeHeader& header_;
  const std::string& path_;
  LabelVolume& volume_;
  Palette palette_;
};

/// Reads the voxels of a segmentation whose segments may overlap: a value for every layer.
template <class T>
void read_layers(const VolumeHeader& header, const std::string& path, const std::string& labels, LabelVolume& volume) {
  const auto layers = static_cast<std::size_t>(header.layers),
             pixels = static_cast<std::size_t>(volume.size[0]) * volume.size[1];
  require_memory(header.data.bytes() + 2 * pixels * volume.size[2], "the layers of a segmentation", path, "crop it");
  const std::unique_ptr<T[]> raw(new T[header.data.count]);
  read_voxel_data(header.data, path, raw.get(), volume.warnings);
  std::vector<LabelInfo> segments;
  for (const SlicerSegment& s : header.segmentation.segments) segments.push_back(s.label);
  const auto& step = header.step;
  join_segments(
      segments,
      [&](int k) {
        std::vector<std::vector<std::uint16_t>> out(layers, std::vector<std::uint16_t>(pixels, 0));
        for (std::size_t l = 0; l < layers; ++l)
          for (std::size_t i = 0; i < pixels; ++i) {
            const T value = raw[i % volume.size[0] * step[0] + i / volume.size[0] * step[1] +
                                static_cast<std::uint64_t>(k) * step[2] + l * step[3]];
            if (value == 0) continue;
            for (std::size_t s = 0; s < segments.size() && out[l][i] == 0; ++s) {
              const SlicerSegment& segment = header.segmentation.segments[s];
              if (segment.layer == static_cast<int>(l) && static_cast<T>(segment.value) == value)
                out[l][i] = static_cast<std::uint16_t>(s + 1);
            }
          }
        return out;
      },
      labels, path, volume);
}

}  // namespace

LabelVolume read_volume_file(const std::string& path, FileFormat format, const std::string& labels,
                             bool allow_outside) {
  const VolumeHeader header = read_volume_header(path, format, allow_outside);
  LabelVolume volume;
  volume.kind = kind_of(format);
  volume.warnings = header.warnings;
  take_grid(header, volume, path);
  if (header.layers > 1) {
    by_type(header.data.type, [&](auto t) {
      using T = decltype(t);
      if constexpr (std::is_integral_v<T> && sizeof(T) <= 4) read_layers<T>(header, path, labels, volume);
      else
        fail_input("the voxel type of the segmentation's layers is not read", path,
                   "store them as whole numbers of 8 to 32 bits");
    });
  } else {
    LabelReader(header, path, volume).run();
  }
  const SlicerSegmentation& segmentation = header.segmentation;
  if (segmentation.segments.empty()) return volume;
  volume.kind = "seg.nrrd";
  volume.goes_on_low = segmentation.goes_on_low;
  volume.goes_on_high = segmentation.goes_on_high;
  if (header.layers == 1)
    for (LabelInfo& label : volume.labels)
      for (const SlicerSegment& s : segmentation.segments)
        if (s.label.number == label.number && label.number != 0) label = s.label;
  return volume;
}

IntensityVolume read_intensity_file(const std::string& path, FileFormat format, bool allow_outside) {
  const VolumeHeader header = read_volume_header(path, format, allow_outside);
  if (header.layers > 1)
    fail_input("the image has more than three dimensions or several values a voxel", path,
               "give an image, not a segmentation");
  IntensityVolume image;
  image.warnings = header.warnings;
  take_grid(header, image, path);
  const std::size_t count = voxels_of(header);
  by_type(header.data.type, [&](auto t) {
    using T = decltype(t);
    require_memory((sizeof(float) + (std::is_same_v<T, float> ? 0 : sizeof(T))) * count,
                   "the intensities of " + std::to_string(count) + " voxels", path, "crop the image");
    image.values.resize(count);
    if constexpr (std::is_same_v<T, float>) {
      read_values(header, path, image.values.data(), image.warnings);
      if (header.is_scaled())
        for (float& v : image.values) v = static_cast<float>(header.slope * v + header.intercept);
    } else {
      const std::unique_ptr<T[]> raw(new T[count]);
      read_values(header, path, raw.get(), image.warnings);
      for (std::size_t i = 0; i < count; ++i)
        image.values[i] = static_cast<float>(header.slope * static_cast<double>(raw[i]) + header.intercept);
    }
  });
  image.kind = kind_of(format);
  return image;
}

}  // namespace stackmesh
