// NRRD: https://teem.sourceforge.net/nrrd/format.html
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/error.h"
#include "base/text.h"
#include "base/warning.h"
#include "image/data_files.h"
#include "image/text_header.h"
#include "image/volume_header.h"

namespace stackmesh {
namespace {

[[noreturn]] void damaged(const std::string& what, const std::string& path) {
  fail_input(what, path, "copy or export the file again");
}

constexpr std::size_t kLongestField = 950;  // the format's own library fails to read longer lines

std::optional<VoxelType> nrrd_type(std::string type) {
  static const std::map<std::string, VoxelType> known = {{"signed char", VoxelType::i8},
                                                         {"int8", VoxelType::i8},
                                                         {"int8_t", VoxelType::i8},
                                                         {"uchar", VoxelType::u8},
                                                         {"unsigned char", VoxelType::u8},
                                                         {"uint8", VoxelType::u8},
                                                         {"uint8_t", VoxelType::u8},
                                                         {"short", VoxelType::i16},
                                                         {"short int", VoxelType::i16},
                                                         {"signed short", VoxelType::i16},
                                                         {"signed short int", VoxelType::i16},
                                                         {"int16", VoxelType::i16},
                                                         {"int16_t", VoxelType::i16},
                                                         {"ushort", VoxelType::u16},
                                                         {"unsigned short", VoxelType::u16},
                                                         {"unsigned short int", VoxelType::u16},
                                                         {"uint16", VoxelType::u16},
                                                         {"uint16_t", VoxelType::u16},
                                                         {"int", VoxelType::i32},
                                                         {"signed int", VoxelType::i32},
                                                         {"int32", VoxelType::i32},
                                                         {"int32_t", VoxelType::i32},
                                                         {"uint", VoxelType::u32},
                                                         {"unsigned int", VoxelType::u32},
                                                         {"uint32", VoxelType::u32},
                                                         {"uint32_t", VoxelType::u32},
                                                         {"longlong", VoxelType::i64},
                                                         {"long long", VoxelType::i64},
                                                         {"long long int", VoxelType::i64},
                                                         {"signed long long", VoxelType::i64},
                                                         {"signed long long int", VoxelType::i64},
                                                         {"int64", VoxelType::i64},
                                                         {"int64_t", VoxelType::i64},
                                                         {"ulonglong", VoxelType::u64},
                                                         {"unsigned long long", VoxelType::u64},
                                                         {"unsigned long long int", VoxelType::u64},
                                                         {"uint64", VoxelType::u64},
                                                         {"uint64_t", VoxelType::u64},
                                                         {"float", VoxelType::f32},
                                                         {"double", VoxelType::f64}};
  const auto found = known.find(type);
  return found == known.end() ? std::nullopt : std::make_optional(found->second);
}

/// "(1,0,0) none (0,1,0)": the vectors, "none" as an empty one.
std::vector<std::vector<double>> vectors(const std::string& text, const std::string& field, const std::string& path) {
  std::vector<std::vector<double>> list;
  std::size_t i = 0;
  while ((i = text.find_first_not_of(" \t", i)) != std::string::npos) {
    list.emplace_back();
    if (text[i] != '(') {
      i = text.find_first_of(" \t", i);
      continue;
    }
    const std::size_t close = text.find(')', i);
    if (close == std::string::npos) damaged("the header is damaged: '" + field + "'", path);
    std::string inner = text.substr(i + 1, close - i - 1);
    std::replace(inner.begin(), inner.end(), ',', ' ');
    list.back() = numbers(inner, field, path);
    i = close + 1;
  }
  return list;
}

/// What a space's axes are multiplied with to become left, posterior, superior.
std::optional<std::array<double, 3>> flips_of(std::string space) {
  space = lower_case(space);
  if (ends_with(space, "-time")) space.resize(space.size() - 5);
  if (space.size() == 4 && space.back() == 't') space.pop_back();
  static const std::map<std::string, std::array<double, 3>> known = {{"right-anterior-superior", {-1, -1, 1}},
                                                                     {"ras", {-1, -1, 1}},
                                                                     {"left-anterior-superior", {1, -1, 1}},
                                                                     {"las", {1, -1, 1}},
                                                                     {"left-posterior-superior", {1, 1, 1}},
                                                                     {"lps", {1, 1, 1}},
                                                                     {"right-posterior-superior", {-1, 1, 1}},
                                                                     {"rps", {-1, 1, 1}},
                                                                     {"scanner-xyz", {1, 1, 1}},
                                                                     {"3d-right-handed", {1, 1, 1}},
                                                                     {"3d-left-handed", {1, 1, 1}},
                                                                     {"", {1, 1, 1}}};
  const auto found = known.find(space);
  return found == known.end() ? std::nullopt : std::make_optional(found->second);
}

class NrrdReader {
 public:
  NrrdReader(const std::string& path, bool allow_outside)
      : path_(path), allow_outside_(allow_outside), text_(read_nrrd_header(path)) {}

  VolumeHeader run() {
    for (const auto& [field, value] : text_.fields)  // keys ("=...") and comments may be as long as they like
      if (field[0] != '=' && field != "content" && value.size() > kLongestField)
        damaged("the header is damaged: its field '" + field.substr(0, 40) + "' has " + std::to_string(value.size()) +
                    " characters",
                path_);
    const double dims = text_.fields.count("dimension") ? to_number(text_.get("dimension"), "dimension", path_) : 0;
    if (!(dims >= 1 && dims <= 16)) damaged("the header is damaged: no 'dimension'", path_);
    sizes_ = whole_sizes(numbers(text_.get("sizes"), "sizes", path_), dims, path_);
    const std::optional<VoxelType> type = nrrd_type(lower_case(text_.get("type")));
    if (!type)
      fail_input("voxels of NRRD type '" + text_.get("type").substr(0, 40) + "' are no labels", path_,
                 "store the labels as whole numbers");
    header_.data.type = *type;
    choose_axes();
    place();
    find_data();
    return std::move(header_);
  }

 private:
  bool is_domain(std::size_t d) const {
    if (!directions_.empty()) return !directions_[d].empty() && length(d) != 0;
    return kinds_.empty() || kinds_[d] == "domain" || kinds_[d] == "space" || kinds_[d] == "time" ||
           kinds_[d] == "???" || kinds_[d] == "none";
  }
  double length(std::size_t d) const {
    double sum = 0;
    for (std::size_t c = 0; c < directions_[d].size() && c < 3; ++c) sum += directions_[d][c] * directions_[d][c];
    return std::sqrt(sum);
  }

  /// Which axes are x, y and z. Axes of one voxel that are too many are dropped, wherever they are; what is left over
  /// is layers.
  void choose_axes() {
    const std::size_t n = sizes_.size();
    kinds_ = words(lower_case(text_.get("kinds")));
    if (kinds_.size() != n) kinds_.clear();
    directions_ = vectors(text_.get("space directions"), "space directions", path_);
    if (!directions_.empty() && directions_.size() != n)
      damaged("the header is damaged: " + std::to_string(directions_.size()) + " 'space directions' for " +
                  std::to_string(n) + " axes",
              path_);
    for (std::size_t d = 0; d < directions_.size(); ++d) {
      const bool timed = d == 3 && directions_[d].size() == 4;
      if (!directions_[d].empty() && length(d) == 0 && !timed && (kinds_.empty() || is_spatial_kind(kinds_[d])))
        require_spacing(std::array<double, 1>{0}.data(), 1, path_);
    }
    for (std::size_t d = 0; d < n; ++d)
      if (is_domain(d)) axes_.push_back(d);
    for (std::size_t k = axes_.size(); k-- > 0 && axes_.size() > 3;)
      if (sizes_[axes_[k]] == 1) axes_.erase(axes_.begin() + static_cast<std::ptrdiff_t>(k));
    std::uint64_t layers = 1;
    for (std::size_t d = 0; d < n; ++d)
      if (std::find(axes_.begin(), axes_.end(), d) == axes_.end()) layers *= sizes_[d];
    if (axes_.size() < 2)
      fail_input("the image has fewer than two dimensions", path_, "give a three-dimensional label volume");
    for (std::size_t d = 0; d < std::min<std::size_t>(axes_.size(), 3); ++d)
      header_.size[d] = static_cast<int>(sizes_[axes_[d]]);
    if (axes_.size() <= 3 && layers <= 1000) {
      const std::array<double, 3> size = {double(header_.size[0]), double(header_.size[1]), double(header_.size[2])};
      header_.segmentation = read_slicer_segments(text_, size, static_cast<int>(layers), path_);
      const auto& more = header_.segmentation.warnings;
      header_.warnings.insert(header_.warnings.end(), more.begin(), more.end());
    }
    if (axes_.size() > 3 || (layers > 1 && header_.segmentation.segments.empty()))
      fail_input("the image has more than three dimensions or several values a voxel (overlapping segments)", path_,
                 "give one three-dimensional label volume; in 3D Slicer, export it as a labelmap");
    header_.layers = static_cast<int>(layers);
    std::uint64_t step = 1;
    header_.step = {0, 0, 0, 0};
    for (std::size_t d = 0; d < n; step *= sizes_[d], ++d) {
      const auto found = std::find(axes_.begin(), axes_.end(), d);
      const std::size_t axis = found == axes_.end() ? 3 : static_cast<std::size_t>(found - axes_.begin());
      if (axis == 3 && sizes_[d] > 1 && header_.step[3] != 0)
        fail_input("the image has more than three dimensions or several values a voxel (overlapping segments)", path_,
                   "give one three-dimensional label volume");
      if (axis < 3 || sizes_[d] > 1) header_.step[axis] = step;
    }
    header_.data.count = step;
  }
  static bool is_spatial_kind(const std::string& kind) {
    return kind == "domain" || kind == "space" || kind == "???" || kind == "none";
  }

  /// A field with a number for every axis; NaN where there is none.
  std::vector<double> per_axis(const char* field) const {
    std::vector<double> values = numbers(text_.get(field), field, path_);
    values.resize(sizes_.size(), std::nan(""));
    return values;
  }

  void place() {
    const std::optional<std::array<double, 3>> known = flips_of(text_.get("space"));
    const std::array<double, 3> flip = known.value_or(std::array<double, 3>{1, 1, 1});
    if (!known)
      fail_input("its space '" + text_.get("space").substr(0, 40) + "' is not known", path_,
                 "write a space such as left-posterior-superior, or none");
    const auto turned = [&](const std::vector<double>& v) {
      return Vec3{v.size() > 0 ? flip[0] * v[0] : 0, v.size() > 1 ? flip[1] * v[1] : 0,
                  v.size() > 2 ? flip[2] * v[2] : 0};
    };
    if (!directions_.empty()) {
      for (std::size_t d = 0; d < axes_.size(); ++d) {
        const double mm = length(axes_[d]);
        require_spacing(&mm, 1, path_);
        header_.spacing_mm[d] = mm;
        header_.axes[d] = unit(turned(directions_[axes_[d]]));
      }
      if (axes_.size() == 2) header_.axes[2] = cross(header_.axes[0], header_.axes[1]);
    } else {
      place_without_directions();
    }
    const auto origin = vectors(text_.get("space origin"), "space origin", path_);
    if (!origin.empty()) header_.origin_mm = turned(origin[0]);
    check_units();
  }

  void place_without_directions() {
    const std::vector<double> spacings = per_axis("spacings"), low = per_axis("axis mins"),
                              high = per_axis("axis maxs");
    const std::vector<std::string> centers =
        words(lower_case(text_.get(text_.fields.count("centers") ? "centers" : "centerings")));
    const bool given = text_.fields.count("spacings") > 0;
    bool has_origin = true;
    std::array<double, 3> origin = {0, 0, 0};
    for (std::size_t d = 0; d < axes_.size(); ++d) {
      const std::size_t a = axes_[d];
      const bool node = a < centers.size() && centers[a] == "node";
      double mm = 1;
      if (given && words(text_.get("spacings")).size() > a && (std::isfinite(spacings[a]) || sizes_[a] > 1))
        mm = spacings[a];
      else if (std::isfinite(low[a]) && std::isfinite(high[a]))
        mm = (high[a] - low[a]) / std::max(1.0, double(sizes_[a]) - (node ? 1 : 0));
      if (!std::isfinite(mm) || mm <= 0) {
        std::array<double, 3> all = {1, 1, 1};
        all[d] = mm;
        require_spacing(all.data(), 3, path_);
      }
      header_.spacing_mm[d] = mm;
      has_origin = has_origin && std::isfinite(low[a]);
      origin[d] = low[a] + (node ? 0 : 0.5 * mm);
    }
    if (has_origin) header_.origin_mm = {origin[0], origin[1], origin[2]};
  }

  void check_units() {
    for (const char* field : {"space units", "units"}) {
      std::string text = text_.get(field);
      std::replace(text.begin(), text.end(), '"', ' ');
      for (const std::string& unit : words(text))
        if (unit != "mm" && unit != "???" && lower_case(unit) != "millimeter" && lower_case(unit) != "millimeters") {
          header_.warnings.push_back(
              warning_at(WarningCode::header, path_, "its unit '" + unit + "' is not known; lengths are taken as mm"));
          break;
        }
    }
  }

  std::string first_of(const char* a, const char* b) const {
    return text_.fields.count(a) ? text_.get(a) : text_.get(b);
  }

  void find_data() {
    const std::string encoding = lower_case(text_.get("encoding"));
    VoxelData& data = header_.data;
    if (encoding == "raw") data.encoding = VoxelEncoding::raw;
    else if (encoding == "gzip" || encoding == "gz") data.encoding = VoxelEncoding::deflate;
    else if (encoding == "ascii" || encoding == "text" || encoding == "txt") data.encoding = VoxelEncoding::text;
    else if (encoding == "hex") data.encoding = VoxelEncoding::hex;
    else if (encoding == "bzip2" || encoding == "bz2")
      fail_input("the encoding bzip2 is not supported", path_, "save it with encoding gzip or raw (unu save -e gzip)");
    else if (encoding.empty()) damaged("the header is damaged: no 'encoding'", path_);
    else
      fail_input("the encoding '" + encoding.substr(0, 40) + "' is not supported", path_,
                 "save it with encoding gzip or raw");
    const std::string endian = lower_case(text_.get("endian"));
    if (endian == "big") data.big_endian = true;
    else if (endian != "little" && !endian.empty())
      damaged("the header is damaged: endian '" + endian.substr(0, 40) + "'", path_);
    else if (endian.empty() && bytes_of(data.type) > 1 && data.encoding != VoxelEncoding::text)
      damaged("the header is damaged: no 'endian'", path_);

    const std::string detached = first_of("data file", "datafile");
    if (detached.empty() && !text_.ended) damaged("the file is truncated: its header does not end", path_);
    const DataFiles files(path_, allow_outside_);
    if (detached.empty()) {
      DataPart part;
      part.path = path_;
      part.offset = text_.end;
      data.parts = {part};
    } else if (detached.compare(0, 4, "LIST") == 0) {
      for (const std::string& name : text_.list) data.parts.push_back(files.part(name));
    } else if (const std::vector<std::string> w = words(detached);
               w.size() >= 4 && detached.find('%') != std::string::npos) {
      const std::size_t n = w.size() - 3;  // NAME%03d.raw FIRST LAST STEP, or with the dimension of a file behind it
      const bool with_dimension = w.size() >= 5 && w[w.size() - 4].find('%') == std::string::npos;
      const std::size_t at = with_dimension ? n - 1 : n;
      data.parts = files.numbered(w[at - 1], to_number(w[at], "data file", path_),
                                  to_number(w[at + 1], "data file", path_), to_number(w[at + 2], "data file", path_));
    } else {
      data.parts = {files.part(detached)};
    }
    if (data.parts.empty()) damaged("the header is damaged: it lists no data file", path_);
    if (data.count % data.parts.size() != 0)
      damaged("the header is damaged: " + std::to_string(data.count) + " voxels do not divide into " +
                  std::to_string(data.parts.size()) + " files",
              path_);
    skip();
  }

  /// "line skip" is before decompression, "byte skip" behind it; -1 stands for whatever is before the voxels.
  void skip() {
    const std::string lines = first_of("line skip", "lineskip"), bytes = first_of("byte skip", "byteskip");
    const double n = lines.empty() ? 0 : to_number(lines, "line skip", path_),
                 b = bytes.empty() ? 0 : to_number(bytes, "byte skip", path_);
    if (!(n >= 0 && n < 1e9) || n != std::floor(n)) damaged("the header is damaged: 'line skip'", path_);
    if (!(b >= -1 && b < 1e15) || b != std::floor(b)) damaged("the header is damaged: 'byte skip'", path_);
    if (b == -1 && header_.data.encoding != VoxelEncoding::raw)
      fail_input("'byte skip: -1' is for encoding raw only", path_, "save it again without it");
    for (DataPart& part : header_.data.parts) {
      if (n > 0) part.offset += bytes_of_lines(part, static_cast<std::uint64_t>(n));
      if (b == -1) part.at_end = true;
      else if (header_.data.encoding == VoxelEncoding::text || header_.data.encoding == VoxelEncoding::hex)
        part.offset += static_cast<std::uint64_t>(b);
      else part.skip = static_cast<std::uint64_t>(b);
    }
  }

  std::uint64_t bytes_of_lines(const DataPart& part, std::uint64_t lines) const {
    const std::string text = read_header_text(part.path);
    std::size_t at = static_cast<std::size_t>(std::min<std::uint64_t>(part.offset, text.size()));
    std::string line;
    const std::size_t begin = at;
    for (; lines > 0; --lines)
      if (!next_line(text, at, line))
        damaged("the header is damaged: 'line skip' names more lines than there are", path_);
    return at - begin;
  }

  const std::string path_;
  const bool allow_outside_;
  const TextHeader text_;
  std::vector<std::uint64_t> sizes_;
  std::vector<std::string> kinds_;
  std::vector<std::vector<double>> directions_;
  std::vector<std::size_t> axes_;
  VolumeHeader header_;
};

}  // namespace

VolumeHeader read_nrrd_volume_header(const std::string& path, bool allow_outside) {
  return NrrdReader(path, allow_outside).run();
}

}  // namespace stackmesh
