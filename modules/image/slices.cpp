#include "image/slices.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>

#include "base/error.h"
#include "image/file_names.h"
#include "image/palette.h"
#include "image/png_check.h"
#include "image/quiet.h"

namespace stackmesh {
namespace {

constexpr const char* again = "copy or export the file again";

/// Silences OpenCV's log, whose level is global.
class SilentLog {
 public:
  SilentLog() : level_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
  ~SilentLog() { cv::utils::logging::setLogLevel(level_); }
  SilentLog(const SilentLog&) = delete;
  SilentLog& operator=(const SilentLog&) = delete;

 private:
  cv::utils::logging::LogLevel level_;
};

std::vector<unsigned char> read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) fail_input("cannot open the file", path, "check that you may read it");
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// One channel of a grey image; colour is refused unless it is grey in truth.
cv::Mat grey(const cv::Mat& image, const std::string& path) {
  if (image.channels() == 1) return image;
  const int bytes = static_cast<int>(image.elemSize1()), pixel = static_cast<int>(image.elemSize());
  const int colours = std::min(image.channels(), 3);  // a fourth channel is opacity
  cv::Mat out(image.rows, image.cols, CV_MAKETYPE(image.depth(), 1));
  for (int y = 0; y < image.rows; ++y) {
    const unsigned char* p = image.ptr(y);
    unsigned char* q = out.ptr(y);
    for (int x = 0; x < image.cols; ++x, p += pixel, q += bytes) {
      for (int c = 1; c < colours; ++c)
        if (std::memcmp(p, p + c * bytes, bytes) != 0)
          fail_input("the slice is a colour image",
                     path + ", pixel (" + std::to_string(x) + ", " + std::to_string(y) + ")",
                     "save it as 8- or 16-bit greyscale with the label as grey value");
      std::memcpy(q, p, bytes);
    }
  }
  return out;
}

/// The page at `index`, or an empty image when the file has no such page.
cv::Mat read_tiff_page(const std::string& path, int index) {
  std::vector<cv::Mat> pages;
  cv::imreadmulti(path, pages, index, 1, cv::IMREAD_UNCHANGED);
  return pages.empty() ? cv::Mat() : pages[0];
}

class Stacker {
 public:
  explicit Stacker(std::size_t files) : files_(files) {}

  void add(const cv::Mat& coloured, const std::string& path, int page) {
    const std::string name = page < 0 ? path : path + ", page " + std::to_string(page + 1);
    const cv::Mat image = grey(coloured, name);
    if (volume_.size[2] == 0) {
      volume_.size = {image.cols, image.rows, 0};
      first_ = name;
      if (page < 0) volume_.voxels.reserve(image.total() * files_);
    } else if (image.cols != volume_.size[0] || image.rows != volume_.size[1]) {
      fail_input("the slices differ in size: " + std::to_string(image.cols) + " x " +
                     std::to_string(image.rows) + " against " + std::to_string(volume_.size[0]) + " x " +
                     std::to_string(volume_.size[1]),
                 name + " against " + first_, "give slices of one size");
    }
    const std::size_t begin = volume_.voxels.size();
    volume_.voxels.resize(begin + image.total());
    for (int y = 0; y < image.rows; ++y) {
      std::uint16_t* out = volume_.voxels.data() + begin + static_cast<std::size_t>(y) * image.cols;
      const Palette::Where where = [&](std::size_t x) {
        return std::pair<std::string, std::string>(
            name, "pixel (" + std::to_string(x) + ", " + std::to_string(y) + ")");
      };
      switch (image.depth()) {
        case CV_8U:
          palette_.convert(image.ptr<unsigned char>(y), out, image.cols, where);
          break;
        case CV_8S:
          palette_.convert(image.ptr<signed char>(y), out, image.cols, where);
          break;
        case CV_16U:
          palette_.convert(image.ptr<unsigned short>(y), out, image.cols, where);
          break;
        case CV_16S:
          palette_.convert(image.ptr<short>(y), out, image.cols, where);
          break;
        case CV_32S:
          palette_.convert(image.ptr<int>(y), out, image.cols, where);
          break;
        case CV_32F:
          palette_.convert(image.ptr<float>(y), out, image.cols, where);
          break;
        case CV_64F:
          palette_.convert(image.ptr<double>(y), out, image.cols, where);
          break;
        default:
          fail_input("its pixel type is not read", name, "save it as 8- or 16-bit greyscale");
      }
    }
    ++volume_.size[2];
  }

  LabelVolume finish() {
    palette_.finish(volume_);
    return std::move(volume_);
  }

 private:
  std::size_t files_;
  std::string first_;
  Palette palette_;
  LabelVolume volume_;
};

void add_file(Stacker& stack, const std::string& path) {
  if (format_of(path) == FileFormat::png) {
    const cv::Mat image = cv::imdecode(checked_png(read_bytes(path), path), cv::IMREAD_UNCHANGED);
    if (image.empty()) fail_input("the PNG file is damaged", path, again);
    stack.add(image, path, -1);
    return;
  }
  const std::vector<unsigned char> start = read_bytes(path);
  const bool tiff = start.size() >= 8 &&
                    (std::memcmp(start.data(), "II", 2) == 0 || std::memcmp(start.data(), "MM", 2) == 0);
  const std::size_t pages = tiff ? cv::imcount(path, cv::IMREAD_UNCHANGED) : 0;
  if (pages == 0) fail_input("this is no TIFF file, or it is damaged or truncated", path, again);
  for (std::size_t page = 0; page < pages; ++page) {
    const cv::Mat image = read_tiff_page(path, static_cast<int>(page));
    if (image.empty())
      fail_input("the TIFF file is damaged or truncated", path + ", page " + std::to_string(page + 1), again);
    stack.add(image, path, pages == 1 ? -1 : static_cast<int>(page));
  }
}

/// The last run of digits of a stem as a number, and the text before it.
bool slice_number(const std::string& path, std::string& prefix, long long& number) {
  const std::string stem = stem_of(path);
  const std::size_t end = stem.find_last_of("0123456789");
  if (end == std::string::npos) return false;
  std::size_t begin = end + 1;
  while (begin > 0 && stem[begin - 1] >= '0' && stem[begin - 1] <= '9') --begin;
  if (end + 1 - begin > 15) return false;
  prefix = stem.substr(0, begin);
  number = std::stoll(stem.substr(begin, end + 1 - begin));
  return true;
}

/// Warns of holes in the numbering; slices are stacked as neighbours all the same.
void warn_of_missing(const std::vector<std::string>& files, std::vector<std::string>& warnings) {
  std::vector<long long> numbers;
  std::string common;
  for (const std::string& file : files) {
    std::string prefix;
    long long number = 0;
    if (!slice_number(file, prefix, number) || (!numbers.empty() && prefix != common)) return;
    common = prefix;
    numbers.push_back(number);
  }
  long long step = 0;
  for (std::size_t i = 1; i < numbers.size(); ++i)
    if (numbers[i] > numbers[i - 1] && (step == 0 || numbers[i] - numbers[i - 1] < step))
      step = numbers[i] - numbers[i - 1];
  std::string missing;
  long long count = 0;
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    if (numbers[i] == numbers[i - 1])
      warnings.push_back("slice number " + std::to_string(numbers[i]) +
                         " is there twice: " + file_name_of(files[i - 1]) + " and " + file_name_of(files[i]));
    for (long long n = numbers[i - 1] + step; step > 0 && n < numbers[i]; n += step) {
      if (++count > 10) break;
      missing += (missing.empty() ? "" : ", ") + std::to_string(n);
    }
  }
  if (count > 0)
    warnings.push_back(std::string("missing slice number ") + missing + (count > 10 ? ", ..." : "") +
                       " between " + file_name_of(files.front()) + " and " + file_name_of(files.back()) +
                       ": the slices beside a hole are stacked as neighbours");
}

}  // namespace

LabelVolume read_slices(const std::vector<std::string>& files,
                        const std::optional<std::array<double, 3>>& spacing_mm) {
  Stacker stack(files.size());
  LabelVolume volume;
  std::string current;
  try {
    const Quiet quiet;
    const SilentLog silent;
    for (const std::string& file : files) {
      current = file;
      add_file(stack, file);
    }
    volume = stack.finish();
  } catch (const cv::Exception& e) {
    fail_input("the image is damaged (" + e.err + ")", current, again);
  } catch (const std::bad_alloc&) {
    fail_input("the stack of slices does not fit into memory", current, "crop the slices");
  }
  volume.kind = "slices";
  volume.anatomical = false;
  if (spacing_mm)
    volume.spacing_mm = *spacing_mm;
  else
    volume.warnings.push_back("no voxel size is known: 1 x 1 x 1 mm is taken; give --spacing X,Y,Z");
  warn_of_missing(files, volume.warnings);
  return volume;
}

}  // namespace stackmesh
