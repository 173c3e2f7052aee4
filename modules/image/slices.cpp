#include "image/slices.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>

#include "base/error.h"
#include "base/memory.h"
#include "base/warning.h"
#include "image/file_names.h"
#include "image/palette.h"
#include "image/quiet.h"
#include "image/slice_image.h"

namespace stackmesh {
namespace {

std::vector<unsigned char> read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) fail_input("cannot open the file", path, "check that you may read it");
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

class Stacker {
 public:
  explicit Stacker(std::size_t files) : files_(files) {}

  void add(const SliceImage& image, const std::string& path, int page) {
    const std::string name = page < 0 ? path : path + ", page " + std::to_string(page);
    const std::size_t pixels = image.width * image.height;
    if (volume_.size[2] == 0) {
      volume_.size = {static_cast<int>(image.width), static_cast<int>(image.height), 0};
      first_ = name;
      if (page < 0) {
        require_memory(2 * pixels * files_,
                       "the labels of " + std::to_string(files_) + " slices of " + std::to_string(image.width) + " x " +
                           std::to_string(image.height) + " pixels",
                       path, "crop the slices");
        volume_.voxels.reserve(pixels * files_);
      }
    } else if (static_cast<int>(image.width) != volume_.size[0] || static_cast<int>(image.height) != volume_.size[1]) {
      fail_input("the slices differ in size: " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                     " against " + std::to_string(volume_.size[0]) + " x " + std::to_string(volume_.size[1]),
                 name + " against " + first_, "give slices of one size");
    }
    const std::size_t begin = volume_.voxels.size();
    volume_.voxels.resize(begin + pixels);
    std::uint16_t* const out = volume_.voxels.data() + begin;
    const Palette::Where where = [&](std::size_t i) {
      return std::pair<std::string, std::string>(
          name, "pixel (" + std::to_string(i % image.width) + ", " + std::to_string(i / image.width) + ")");
    };
    const unsigned char* in = image.values.data();
    switch (image.type) {
      case VoxelType::u8:
        palette_.convert(in, out, pixels, where);
        break;
      case VoxelType::i8:
        palette_.convert(reinterpret_cast<const std::int8_t*>(in), out, pixels, where);
        break;
      case VoxelType::u16:
        palette_.convert(reinterpret_cast<const std::uint16_t*>(in), out, pixels, where);
        break;
      case VoxelType::i16:
        palette_.convert(reinterpret_cast<const std::int16_t*>(in), out, pixels, where);
        break;
      case VoxelType::u32:
        palette_.convert(reinterpret_cast<const std::uint32_t*>(in), out, pixels, where);
        break;
      case VoxelType::i32:
        palette_.convert(reinterpret_cast<const std::int32_t*>(in), out, pixels, where);
        break;
      case VoxelType::u64:
        palette_.convert(reinterpret_cast<const std::uint64_t*>(in), out, pixels, where);
        break;
      case VoxelType::i64:
        palette_.convert(reinterpret_cast<const std::int64_t*>(in), out, pixels, where);
        break;
      case VoxelType::f32:
        palette_.convert(reinterpret_cast<const float*>(in), out, pixels, where);
        break;
      case VoxelType::f64:
        palette_.convert(reinterpret_cast<const double*>(in), out, pixels, where);
        break;
    }
    ++volume_.size[2];
  }

  std::vector<Warning>& warnings() { return volume_.warnings; }

  LabelVolume finish(const std::string& path) {
    palette_.finish(volume_, path);
    return std::move(volume_);
  }

 private:
  std::size_t files_;
  std::string first_;
  Palette palette_;
  LabelVolume volume_;
};

void add_file(Stacker& stack, const std::string& path) {
  size_of_file(path, path);
  if (format_of(path) == FileFormat::png) {
    stack.add(read_png(read_bytes(path), path), path, -1);
    return;
  }
  read_tiff(path, stack.warnings(),
            [&](SliceImage&& image, int page, bool several) { stack.add(image, path, several ? page : -1); });
}

/// Warns of holes in the numbering; slices are stacked as neighbours all the same.
void warn_of_missing(const std::vector<std::string>& files, std::vector<Warning>& warnings) {
  std::vector<long long> numbers;
  std::string common;
  std::vector<std::string> names;
  for (const std::string& file : files) names.push_back(stem_of(file));
  const NameOrder order(names);
  for (const std::string& name : names) {
    std::string prefix;
    long long number = 0;
    if (!order.last_number(name, prefix, number) || (!numbers.empty() && prefix != common)) return;
    common = prefix;
    numbers.push_back(number);
  }
  long long step = 0;
  for (std::size_t i = 1; i < numbers.size(); ++i)
    if (numbers[i] > numbers[i - 1] && (step == 0 || numbers[i] - numbers[i - 1] < step))
      step = numbers[i] - numbers[i - 1];
  std::string missing, before;  // the numbers, and the file before the first of them
  long long count = 0;
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    if (numbers[i] == numbers[i - 1])
      warnings.push_back({WarningCode::repeated, file_name_of(files[i]),
                          "slice number " + std::to_string(numbers[i]) +
                              " is there twice: " + file_name_of(files[i - 1]) + " and " + file_name_of(files[i])});
    for (long long n = numbers[i - 1] + step; step > 0 && n < numbers[i]; n += step) {
      if (++count > 10) break;
      if (missing.empty()) before = file_name_of(files[i - 1]);
      missing += (missing.empty() ? "" : ", ") + std::to_string(n);
    }
  }
  if (count > 0)
    warnings.push_back({WarningCode::missing_slices, before,
                        std::string("missing slice number ") + missing + (count > 10 ? ", ..." : "") + " between " +
                            file_name_of(files.front()) + " and " + file_name_of(files.back()) +
                            ": the slices beside a hole are stacked as neighbours"});
}

}  // namespace

LabelVolume read_slices(const std::vector<std::string>& files, const std::optional<std::array<double, 3>>& spacing_mm) {
  const Quiet one_at_a_time;  // libtiff's handlers are global
  Stacker stack(files.size());
  for (const std::string& file : files) add_file(stack, file);
  LabelVolume volume = stack.finish(files[0]);
  volume.kind = "slices";
  volume.anatomical = false;
  if (spacing_mm) volume.spacing_mm = *spacing_mm;
  else
    volume.warnings.push_back(
        {WarningCode::header, "", "no voxel size is known: 1 x 1 x 1 mm is taken; give --spacing X,Y,Z"});
  warn_of_missing(files, volume.warnings);
  return volume;
}

}  // namespace stackmesh
