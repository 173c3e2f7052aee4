// MetaImage: https://itk.org/Wiki/MetaIO/Documentation
#include <cmath>
#include <map>

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

class MetaImageReader {
 public:
  MetaImageReader(const std::string& path, bool allow_outside) : path_(path), allow_outside_(allow_outside) {}

  VolumeHeader run() {
    read_fields();
    read_sizes();
    read_type();
    read_grid();
    find_data();
    return std::move(header_);
  }

 private:
  void read_fields() {
    const std::string all = read_header_text(path_);
    std::string line;
    for (std::size_t at = 0; next_line(all, at, line);) {
      const std::size_t equal = line.find('=');
      if (equal == std::string::npos) {
        if (trim(line).empty()) continue;
        break;
      }
      const std::string key = lower_case(trim(line.substr(0, equal)));
      text_.fields[key] = trim(line.substr(equal + 1));
      if (key != "elementdatafile") continue;
      text_.ended = true;
      text_.end = at;
      while (lower_case(text_.fields[key]).compare(0, 4, "list") == 0 && next_line(all, at, line))
        if (!trim(line).empty()) text_.list.push_back(trim(line));
      break;
    }
    if (!text_.fields.count("ndims") || !text_.ended)
      damaged("this is no MetaImage file, or its header is truncated or damaged", path_);
  }

  void read_sizes() {
    const double dims = to_number(text_.get("ndims"), "NDims", path_);
    if (!(dims >= 1 && dims <= 10)) damaged("the header is damaged: 'NDims'", path_);
    sizes_ = whole_sizes(numbers(text_.get("dimsize"), "DimSize", path_), dims, path_);
    if (sizes_.size() < 2)
      fail_input("the image has one dimension only", path_, "give a three-dimensional label volume");
    header_.data.count = 1;
    for (std::uint64_t n : sizes_) header_.data.count *= n;
    // Axes of one voxel that are too many are dropped, from the last one on.
    for (std::size_t d = 0; d < sizes_.size(); ++d) axes_.push_back(d);
    for (std::size_t k = axes_.size(); k-- > 0 && axes_.size() > 3;)
      if (sizes_[axes_[k]] == 1) axes_.erase(axes_.begin() + static_cast<std::ptrdiff_t>(k));
    if (axes_.size() > 3)
      fail_input("the image has more than three dimensions", path_, "give one three-dimensional label volume");
    for (std::size_t d = 0; d < axes_.size(); ++d) header_.size[d] = static_cast<int>(sizes_[axes_[d]]);
    const std::string channels = text_.get("elementnumberofchannels");
    if (!channels.empty() && to_number(channels, "ElementNumberOfChannels", path_) != 1)
      fail_input("the image has several values a voxel", path_, "give one label volume");
  }

  void read_type() {
    static const std::map<std::string, VoxelType> types = {
        {"met_char", VoxelType::i8},        {"met_uchar", VoxelType::u8},  {"met_short", VoxelType::i16},
        {"met_ushort", VoxelType::u16},     {"met_int", VoxelType::i32},   {"met_uint", VoxelType::u32},
        {"met_long", VoxelType::i32},       {"met_ulong", VoxelType::u32}, {"met_long_long", VoxelType::i64},
        {"met_ulong_long", VoxelType::u64}, {"met_float", VoxelType::f32}, {"met_double", VoxelType::f64}};
    const std::string type = text_.get("elementtype");
    const auto known = types.find(lower_case(type));
    if (known == types.end())
      fail_input("voxels of MetaImage type '" + type.substr(0, 40) + "' are no labels", path_,
                 "store the labels as whole numbers");
    header_.data.type = known->second;
  }

  std::string first_of(std::initializer_list<const char*> fields) const {
    for (const char* field : fields)
      if (!text_.get(field).empty()) return text_.get(field);
    return "";
  }

  void read_grid() {
    for (const char* field : {"elementspacing", "elementsize"})
      if (text_.fields.count(field)) {
        const std::vector<double> spacing = numbers(text_.get(field), field, path_);
        if (spacing.size() != sizes_.size()) damaged(std::string("the header is damaged: '") + field + "'", path_);
        for (std::size_t d = 0; d < axes_.size(); ++d) header_.spacing_mm[d] = spacing[axes_[d]];
        require_spacing(header_.spacing_mm.data(), 3, path_);
        break;
      }
    const std::string unit = text_.get("distanceunits");
    if (!unit.empty() && unit != "?" && lower_case(unit) != "mm" && lower_case(unit) != "unknown")
      header_.warnings.push_back(warning_at(
          WarningCode::header, path_, "its unit '" + unit.substr(0, 40) + "' is not used; lengths are taken as mm"));
    const std::vector<double> origin = numbers(first_of({"offset", "position", "origin"}), "Offset", path_);
    const std::vector<double> matrix =
        numbers(first_of({"transformmatrix", "rotation", "orientation"}), "TransformMatrix", path_);
    const std::size_t n = sizes_.size();
    if (!origin.empty() && origin.size() != n) damaged("the header is damaged: 'Offset'", path_);
    if (!matrix.empty() && matrix.size() != n * n) damaged("the header is damaged: 'TransformMatrix'", path_);
    std::array<double, 3> place = {0, 0, 0};
    for (std::size_t d = 0; d < 3 && d < origin.size(); ++d) place[d] = origin[d];
    header_.origin_mm = {place[0], place[1], place[2]};
    if (matrix.empty()) return;
    for (std::size_t d = 0; d < axes_.size(); ++d) {  // a row an axis
      std::array<double, 3> row = {0, 0, 0};
      for (std::size_t c = 0; c < 3 && c < n; ++c) row[c] = matrix[axes_[d] * n + c];
      header_.axes[d] = {row[0], row[1], row[2]};
    }
  }

  bool yes(const char* field) const {
    const std::string v = lower_case(text_.get(field));
    return !v.empty() && (v[0] == 't' || v[0] == '1' || v[0] == 'y');
  }

  void find_data() {
    VoxelData& data = header_.data;
    const bool binary = text_.get("binarydata").empty() || yes("binarydata"), compressed = yes("compresseddata");
    if (!binary && compressed)
      fail_input("the voxels are both text and compressed", path_, "save it with one of the two");
    data.encoding = !binary ? VoxelEncoding::text : compressed ? VoxelEncoding::deflate : VoxelEncoding::raw;
    data.big_endian = yes("binarydatabyteordermsb") || yes("elementbyteordermsb");
    const std::string name = text_.get("elementdatafile"), lower = lower_case(name);
    const DataFiles files(path_, allow_outside_);
    if (name.empty()) damaged("the header is damaged: no 'ElementDataFile'", path_);
    if (lower == "local") {
      DataPart part;
      part.path = path_;
      part.offset = text_.end;
      data.parts = {part};
    } else if (lower.compare(0, 4, "list") == 0) {
      for (const std::string& file : text_.list) data.parts.push_back(files.part(file));
    } else if (name.find('%') != std::string::npos) {
      const std::vector<std::string> w = words(name);
      if (w.size() > 4) damaged("the header is damaged: 'ElementDataFile'", path_);
      const auto number = [&](std::size_t k, double otherwise) {
        return k < w.size() ? to_number(w[k], "ElementDataFile", path_) : otherwise;
      };
      const double first = number(1, 1), step = number(3, 1);
      data.parts = files.numbered(w[0], first, number(2, first + step * (double(sizes_.back()) - 1)), step);
    } else {
      data.parts = {files.part(name)};
    }
    if (data.parts.empty()) damaged("the header lists no data file", path_);
    if (data.count % data.parts.size() != 0)
      damaged("the header is damaged: " + std::to_string(data.count) + " voxels do not divide into " +
                  std::to_string(data.parts.size()) + " files",
              path_);
    // LIST and patterns hold a slice each: more or fewer files than slices are an error, not a shift.
    if (data.parts.size() > 1 && list_is_of_slices() && data.parts.size() != slices())
      fail_input("the header lists " + std::to_string(data.parts.size()) + " data files for " +
                     std::to_string(slices()) + " slices",
                 path_, "list one file a slice");
    skip(lower == "local", compressed);
  }

  /// "LIST 3D" would hold volumes.
  bool list_is_of_slices() const {
    const std::vector<std::string> w = words(lower_case(text_.get("elementdatafile")));
    return w.size() < 2 || w[0] != "list" || w[1] == "2" || w[1] == "2d";
  }
  std::uint64_t slices() const {
    std::uint64_t n = 1;
    for (std::size_t d = 2; d < sizes_.size(); ++d) n *= sizes_[d];
    return n;
  }

  void skip(bool local, bool compressed) {
    const std::string size = text_.get("headersize"), stored = text_.get("compresseddatasize");
    const double skipped = size.empty() || local ? 0 : to_number(size, "HeaderSize", path_);
    if (!(skipped >= -1 && skipped < 1e15) || skipped != std::floor(skipped))
      damaged("the header is damaged: 'HeaderSize'", path_);
    if (skipped == -1 && header_.data.encoding != VoxelEncoding::raw)
      damaged("the header is damaged: 'HeaderSize = -1' is for plain voxels only", path_);
    if (compressed && local && stored.empty())
      damaged("the header is damaged: the voxels are compressed, but 'CompressedDataSize' is missing", path_);
    for (DataPart& part : header_.data.parts) {
      if (skipped == -1) part.at_end = true;
      else part.offset += static_cast<std::uint64_t>(skipped);
      if (!compressed || stored.empty() || header_.data.parts.size() > 1) continue;
      const double bytes = to_number(stored, "CompressedDataSize", path_);
      if (!(bytes >= 1 && bytes < 1e18)) damaged("the header is damaged: 'CompressedDataSize'", path_);
      part.size = static_cast<std::uint64_t>(bytes);
    }
  }

  const std::string path_;
  const bool allow_outside_;
  TextHeader text_;
  std::vector<std::uint64_t> sizes_;
  std::vector<std::size_t> axes_;
  VolumeHeader header_;
};

}  // namespace

VolumeHeader read_metaimage_header(const std::string& path, bool allow_outside) {
  return MetaImageReader(path, allow_outside).run();
}

}  // namespace stackmesh
