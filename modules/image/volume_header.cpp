#include "image/volume_header.h"

#include <sys/stat.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>

#include "base/error.h"
#include "base/text.h"
#include "image/text_header.h"

namespace stackmesh {
namespace {

constexpr const char* again = "copy or export the file again";

[[noreturn]] void damaged(const std::string& what, const std::string& path) {
  fail_input(what, path, again);
}

[[noreturn]] void truncated(std::uint64_t have, std::uint64_t need, const std::string& path) {
  damaged("the file is truncated: " + std::to_string(have) + " bytes of voxels where its header needs " +
              std::to_string(need),
          path);
}

std::uint64_t size_of(const std::string& path) {
  struct stat info;
  return ::stat(path.c_str(), &info) == 0 ? static_cast<std::uint64_t>(info.st_size) : 0;
}

/// Deflate cannot shrink data more than about 1032 times: refuse absurd headers before memory is asked for.
void require_possible(const HeaderFacts& facts, const std::string& path) {
  const std::uint64_t size = size_of(facts.data_path);
  const std::uint64_t have = size > facts.data_offset ? size - facts.data_offset : 0;
  if (!facts.compressed) {
    if (have < facts.needed_bytes) truncated(have, facts.needed_bytes, path);
  } else if (have * 1040 + 4096 < facts.needed_bytes) {
    damaged("the file is truncated or its header is wrong: " + std::to_string(have) +
                " compressed bytes cannot hold the " + std::to_string(facts.needed_bytes) +
                " its header needs",
            path);
  }
}

/// The first bytes of a file, decompressed if it is gzipped.
std::vector<unsigned char> read_start(const std::string& path, unsigned count, bool& compressed) {
  const gzFile file = gzopen(path.c_str(), "rb");
  if (file == nullptr) fail_input("cannot open the file", path, "check that you may read it");
  std::vector<unsigned char> bytes(count);
  const int got = gzread(file, bytes.data(), count);
  compressed = gzdirect(file) == 0;
  int code = Z_OK;
  gzerror(file, &code);
  gzclose(file);
  if (got < 0 && code == Z_DATA_ERROR) damaged("the file's compressed data are damaged", path);
  bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  return bytes;
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

/// The largest cosine between the first three vectors; NaN where one of them is zero.
double cosine_error(const std::vector<Vec3>& v) {
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < i; ++j) {
      const double cosine = std::abs(dot(v[i], v[j])) / (norm(v[i]) * norm(v[j]));
      worst = cosine <= worst ? worst : cosine;  // keeps a NaN
    }
  return worst;
}

// ---- NIfTI ----

int nifti_bytes(int datatype) {
  switch (datatype) {
    case 2:
    case 256:
      return 1;  // uint8, int8
    case 4:
    case 512:
      return 2;  // int16, uint16
    case 8:
    case 768:
    case 16:
      return 4;  // int32, uint32, float
    case 1024:
    case 1280:
    case 64:
      return 8;  // int64, uint64, double
    default:
      return 0;
  }
}

/// Reads the two orientations of a NIfTI header. ITK takes the sform where its code is 1 or it is alone, else
/// the qform. A sheared sform it refuses without a reason, or drops for the qform in silence.
void check_nifti_forms(const std::vector<unsigned char>& h, bool swap, HeaderFacts& facts,
                       const std::string& path) {
  const int qform = number_at<std::int16_t>(h, 252, swap), sform = number_at<std::int16_t>(h, 254, swap);
  const auto real = [&](int offset) {
    const double value = number_at<float>(h, offset, swap);
    if (!std::isfinite(value)) damaged("the header is damaged: its orientation is not finite", path);
    return value;
  };
  facts.has_forms = qform > 0 || sform > 0;
  if (qform > 0) {
    for (int offset = 256; offset < 268; offset += 4) real(offset);
    facts.raw_origin = {{-real(268), -real(272), real(276)}};
  }
  if (sform <= 0) return;
  for (int c = 0; c < 4; ++c)
    facts.sform.push_back({-real(280 + 4 * c), -real(296 + 4 * c), real(312 + 4 * c)});
  if (sform != 1 && qform > 0) return;
  facts.raw_origin = {facts.sform[3]};
  if (!(cosine_error(facts.sform) <= 1e-4))  // a zero column gives a NaN
    fail_input("the voxel grid is sheared or its directions (sform) are zero", path,
               "resample the labels to a rectangular grid with nearest neighbour");
}

HeaderFacts check_nifti(const std::string& path) {
  HeaderFacts facts;
  facts.data_path = path;
  const std::vector<unsigned char> h = read_start(path, 352, facts.compressed);
  if (h.size() < 348) damaged("the file is truncated: no complete NIfTI header", path);
  bool swap = false;
  const auto is_size = [&](std::int32_t size, bool swapped) {
    return number_at<std::int32_t>(h, 0, swapped) == size;
  };
  if (is_size(540, false) || is_size(540, true))
    fail_input("NIfTI-2 files are not read", path, "convert the labels to NIfTI-1 (.nii.gz) or NRRD");
  if (is_size(348, true))
    swap = true;
  else if (!is_size(348, false))
    damaged("this is no NIfTI file, or its header is damaged", path);
  if (std::memcmp(h.data() + 344, "n+1", 4) != 0)
    damaged("this is no single-file NIfTI-1 volume, or its header is damaged", path);

  const int dims = number_at<std::int16_t>(h, 40, swap);
  if (dims < 1 || dims > 7)
    damaged(
        "the header is damaged or of the wrong byte order: it has " + std::to_string(dims) + " dimensions",
        path);
  std::uint64_t voxels = 1;
  for (int d = 1; d <= dims; ++d) {
    const int n = number_at<std::int16_t>(h, 40 + 2 * d, swap);
    if (n < 1)
      damaged("the header is damaged or of the wrong byte order: dimension " + std::to_string(d) + " is " +
                  std::to_string(n),
              path);
    if (d > 3 && n > 1)
      fail_input("the image has more than three dimensions", path, "give one three-dimensional label volume");
    voxels *= static_cast<std::uint64_t>(n);
  }
  double pixdim[3] = {1, 1, 1};
  for (int d = 0; d < std::min(dims, 3); ++d) pixdim[d] = number_at<float>(h, 80 + 4 * d, swap);
  require_spacing(pixdim, 3, path);
  const int datatype = number_at<std::int16_t>(h, 70, swap);
  const int bytes = nifti_bytes(datatype);
  if (bytes == 0)
    fail_input(
        "voxels of NIfTI type " + std::to_string(datatype) + " (colour, complex or other) are no labels",
        path, "store the labels as whole numbers");
  const float offset = number_at<float>(h, 108, swap);
  if (!(offset >= 0 && offset < 1e9)) damaged("the header is damaged: its voxels begin nowhere", path);
  // A header that was cut off after 348 bytes has no voxels either; below 352 the offset means 352.
  const std::uint64_t begin = std::max<std::uint64_t>(352, static_cast<std::uint64_t>(offset));
  facts.needed_bytes = begin + voxels * static_cast<std::uint64_t>(bytes);
  require_possible(facts, path);
  const int unit = h[123] & 7;
  facts.unit_mm = unit == 1 ? 1e3 : unit == 3 ? 1e-3 : 1;
  check_nifti_forms(h, swap, facts, path);
  return facts;
}

// ---- GIPL: big-endian, 256 bytes ----

HeaderFacts check_gipl(const std::string& path) {
  HeaderFacts facts;
  facts.data_path = path;
  const std::vector<unsigned char> h = read_start(path, 256, facts.compressed);
  if (h.size() < 256) damaged("the file is truncated: no complete GIPL header", path);
  const auto magic = number_at<std::uint32_t>(h, 252, true);
  if (magic != 719555000u && magic != 4026526128u)
    damaged("this is no GIPL file, or its header is damaged or of the wrong byte order", path);
  std::uint64_t voxels = 1;
  for (int d = 0; d < 4; ++d) {
    const int n = number_at<std::uint16_t>(h, 2 * d, true);
    if (n == 0 && d < 2) damaged("the header is damaged: dimension " + std::to_string(d + 1) + " is 0", path);
    if (d == 3 && n > 1)
      fail_input("the image has more than three dimensions", path, "give one three-dimensional label volume");
    voxels *= static_cast<std::uint64_t>(std::max(n, 1));
  }
  double spacing[3];
  for (int d = 0; d < 3; ++d) spacing[d] = number_at<float>(h, 10 + 4 * d, true);
  require_spacing(spacing, 3, path);
  const int type = number_at<std::uint16_t>(h, 8, true);
  const int bytes = type == 7 || type == 8                   ? 1
                    : type == 15 || type == 16               ? 2
                    : type == 31 || type == 32 || type == 64 ? 4
                    : type == 65                             ? 8
                                                             : 0;
  if (bytes == 0)
    fail_input("voxels of GIPL type " + std::to_string(type) + " are no labels", path,
               "store the labels as whole numbers");
  facts.needed_bytes = 256 + voxels * static_cast<std::uint64_t>(bytes);
  require_possible(facts, path);
  return facts;
}

// ---- the text headers: NRRD and MetaImage ----

std::uint64_t voxel_count(const std::vector<double>& sizes, std::size_t dims, const std::string& path) {
  if (sizes.size() != dims || dims == 0)
    damaged("the header is damaged: " + std::to_string(sizes.size()) + " sizes for " + std::to_string(dims) +
                " dimensions",
            path);
  double voxels = 1;
  for (double n : sizes) {
    if (!(n >= 1 && n < 2147483648.0) || n != std::floor(n))
      damaged("the header is damaged: a size is no whole number above 0", path);
    voxels *= n;
  }
  if (voxels > 1e15) damaged("the header is damaged: its sizes are absurd", path);
  return static_cast<std::uint64_t>(voxels);
}

std::string beside(const std::string& path, const std::string& file) {
  if (!file.empty() && file[0] == '/') return file;
  const std::size_t slash = path.find_last_of('/');
  return slash == std::string::npos ? file : path.substr(0, slash + 1) + file;
}

int nrrd_bytes(const std::string& type) {
  static const std::map<std::string, int> known = {{"signed char", 1},
                                                   {"int8", 1},
                                                   {"int8_t", 1},
                                                   {"uchar", 1},
                                                   {"unsigned char", 1},
                                                   {"uint8", 1},
                                                   {"uint8_t", 1},
                                                   {"short", 2},
                                                   {"short int", 2},
                                                   {"signed short", 2},
                                                   {"signed short int", 2},
                                                   {"int16", 2},
                                                   {"int16_t", 2},
                                                   {"ushort", 2},
                                                   {"unsigned short", 2},
                                                   {"unsigned short int", 2},
                                                   {"uint16", 2},
                                                   {"uint16_t", 2},
                                                   {"int", 4},
                                                   {"signed int", 4},
                                                   {"int32", 4},
                                                   {"int32_t", 4},
                                                   {"uint", 4},
                                                   {"unsigned int", 4},
                                                   {"uint32", 4},
                                                   {"uint32_t", 4},
                                                   {"longlong", 8},
                                                   {"long long", 8},
                                                   {"long long int", 8},
                                                   {"signed long long", 8},
                                                   {"signed long long int", 8},
                                                   {"int64", 8},
                                                   {"int64_t", 8},
                                                   {"ulonglong", 8},
                                                   {"unsigned long long", 8},
                                                   {"unsigned long long int", 8},
                                                   {"uint64", 8},
                                                   {"uint64_t", 8},
                                                   {"float", 4},
                                                   {"double", 8}};
  const auto found = known.find(type);
  return found == known.end() ? 0 : found->second;
}

/// "(1,0,0) none (0,1,0)": the vectors, "none" as an empty one.
std::vector<std::vector<double>> nrrd_vectors(const std::string& text, const std::string& path) {
  std::vector<std::vector<double>> list;
  std::size_t i = 0;
  while ((i = text.find_first_not_of(" \t", i)) != std::string::npos) {
    list.emplace_back();
    if (text[i] != '(') {
      i = text.find_first_of(" \t", i);
      continue;
    }
    const std::size_t close = text.find(')', i);
    if (close == std::string::npos) damaged("the header is damaged: 'space directions'", path);
    std::string inner = text.substr(i + 1, close - i - 1);
    std::replace(inner.begin(), inner.end(), ',', ' ');
    list.back() = numbers(inner, "space directions", path);
    i = close + 1;
  }
  return list;
}

void check_nrrd_grid(const TextHeader& header, HeaderFacts& facts, const std::string& path) {
  if (header.fields.count("spacings")) {
    std::vector<double> spacing;
    for (double s : numbers(header.get("spacings"), "spacings", path)) spacing.push_back(s);
    require_spacing(spacing.data(), std::min<std::size_t>(spacing.size(), 3), path);
  }
  for (const auto& v : nrrd_vectors(header.get("space directions"), path)) {
    if (v.empty()) continue;
    double length = 0;
    for (double x : v) length += x * x;
    length = std::sqrt(length);
    require_spacing(&length, 1, path);
  }
  for (const char* field : {"space units", "units"}) {
    std::string text = header.get(field);
    std::replace(text.begin(), text.end(), '"', ' ');
    for (const std::string& unit : words(text))
      if (unit != "mm" && unit != "???" && lower_case(unit) != "millimeter" &&
          lower_case(unit) != "millimeters") {
        facts.warnings.push_back(path + ": its unit '" + unit + "' is not known; lengths are taken as mm");
        break;
      }
  }
}

/// 3D Slicer's segmentations: their names, and their layers where segments overlap (an axis of kind "list").
void find_segments(const TextHeader& header, const std::vector<double>& sizes, HeaderFacts& facts, const std::string& path) {
  if (header.get("=Segment0_ID").empty() && header.get("=Segment0_Name").empty() && header.get("=Segment0_LabelValue").empty()) return;
  const std::vector<std::string> kinds = words(lower_case(header.get("kinds")));
  std::vector<double> space;
  double layers = 1;
  for (std::size_t d = 0; d < sizes.size(); ++d) {
    const bool domain = kinds.size() != sizes.size() || kinds[d] == "domain" || kinds[d] == "space";
    if (domain) space.push_back(sizes[d]);
    else layers *= sizes[d];
  }
  if (space.size() != 3 || layers > 1000) return;
  facts.layers = static_cast<int>(layers);
  facts.segmentation = read_slicer_segments(header, {space[0], space[1], space[2]}, facts.layers, path);
  facts.warnings.insert(facts.warnings.end(), facts.segmentation.warnings.begin(), facts.segmentation.warnings.end());
}

HeaderFacts check_nrrd(const std::string& path) {
  const TextHeader header = read_nrrd_header(path);
  HeaderFacts facts;
  const double dims =
      header.fields.count("dimension") ? to_number(header.get("dimension"), "dimension", path) : 0;
  if (!(dims >= 1 && dims <= 16)) damaged("the header is damaged: no 'dimension'", path);
  const std::vector<double> sizes = numbers(header.get("sizes"), "sizes", path);
  const std::uint64_t voxels = voxel_count(sizes, static_cast<std::size_t>(dims), path);
  const std::string type = lower_case(header.get("type"));
  const int bytes = nrrd_bytes(type);
  if (bytes == 0)
    fail_input("voxels of NRRD type '" + type + "' are no labels", path, "store the labels as whole numbers");
  find_segments(header, sizes, facts, path);
  if (facts.layers == 1 && std::count_if(sizes.begin(), sizes.end(), [](double n) { return n > 1; }) > 3)
    fail_input("the image has more than three dimensions or several values a voxel (overlapping segments)",
               path, "give one three-dimensional label volume; in 3D Slicer, export it as a labelmap");
  check_nrrd_grid(header, facts, path);

  const std::string encoding = lower_case(header.get("encoding"));
  std::string detached = header.get("data file");
  if (detached.empty()) detached = header.get("datafile");
  const bool skips = !header.get("line skip").empty() || !header.get("lineskip").empty() ||
                     !header.get("byte skip").empty() || !header.get("byteskip").empty();
  if (detached.empty() && !header.ended) damaged("the file is truncated: its header does not end", path);
  const bool list = detached.compare(0, 4, "LIST") == 0 || detached.find('%') != std::string::npos;
  if (list || skips) return facts;  // left to ITK, which checks the amount of data itself
  facts.data_path = detached.empty() ? path : beside(path, detached);
  facts.data_offset = detached.empty() ? header.end : 0;
  facts.needed_bytes = voxels * static_cast<std::uint64_t>(bytes);
  if (!detached.empty() && size_of(facts.data_path) == 0)
    fail_input("its data file '" + detached + "' is missing or empty", path, "put it beside the header");
  facts.compressed = encoding == "gzip" || encoding == "gz";
  if (facts.compressed || encoding == "raw") require_possible(facts, path);
  return facts;
}

HeaderFacts check_metaimage(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) fail_input("cannot open the file", path, "check that you may read it");
  TextHeader header;
  for (std::string line; static_cast<std::size_t>(file.tellg()) < kMaxHeader && std::getline(file, line);) {
    const std::size_t equal = line.find('=');
    if (equal == std::string::npos) {
      if (trim(line).empty()) continue;
      break;
    }
    const std::string key = lower_case(trim(line.substr(0, equal)));
    header.fields[key] = trim(line.substr(equal + 1));
    if (key == "elementdatafile") {
      header.ended = true;
      header.end = file.eof() ? size_of(path) : static_cast<std::uint64_t>(file.tellg());
      break;
    }
  }
  if (!header.fields.count("ndims") || !header.ended)
    damaged("this is no MetaImage file, or its header is truncated or damaged", path);
  const double dims = to_number(header.get("ndims"), "NDims", path);
  if (!(dims >= 1 && dims <= 10)) damaged("the header is damaged: 'NDims'", path);
  const std::vector<double> sizes = numbers(header.get("dimsize"), "DimSize", path);
  const std::uint64_t voxels = voxel_count(sizes, static_cast<std::size_t>(dims), path);
  for (std::size_t d = 3; d < sizes.size(); ++d)
    if (sizes[d] > 1)
      fail_input("the image has more than three dimensions", path, "give one three-dimensional label volume");
  HeaderFacts facts;
  for (const char* field : {"elementspacing", "elementsize"})
    if (header.fields.count(field)) {
      const std::vector<double> spacing = numbers(header.get(field), field, path);
      if (spacing.size() != sizes.size())
        damaged(std::string("the header is damaged: '") + field + "'", path);
      require_spacing(spacing.data(), std::min<std::size_t>(spacing.size(), 3), path);
      break;
    }
  const std::string channels = header.get("elementnumberofchannels");
  if (!channels.empty() && to_number(channels, "ElementNumberOfChannels", path) != 1)
    fail_input("the image has several values a voxel", path, "give one label volume");

  static const std::map<std::string, int> types = {
      {"met_char", 1},      {"met_uchar", 1},      {"met_short", 2}, {"met_ushort", 2},
      {"met_int", 4},       {"met_uint", 4},       {"met_long", 4},  {"met_ulong", 4},
      {"met_long_long", 8}, {"met_ulong_long", 8}, {"met_float", 4}, {"met_double", 8}};
  const std::string type = header.get("elementtype");
  const auto known = types.find(lower_case(type));
  if (known == types.end())
    fail_input("voxels of MetaImage type '" + type + "' are no labels", path,
               "store the labels as whole numbers");
  const std::string data = words(header.get("elementdatafile")).empty() ? "" : header.get("elementdatafile");
  const std::string lower = lower_case(data);
  if (lower.compare(0, 4, "list") == 0 || data.find('%') != std::string::npos) return facts;
  const bool local = lower == "local";
  facts.data_path = local ? path : beside(path, data);
  facts.data_offset = local ? header.end : 0;
  if (!local && size_of(facts.data_path) == 0)
    fail_input("its data file '" + data + "' is missing or empty", path, "put it beside the header");
  facts.needed_bytes = voxels * static_cast<std::uint64_t>(known->second);
  const auto yes = [&](const char* field) {
    const std::string v = lower_case(header.get(field));
    return !v.empty() && (v[0] == 't' || v[0] == '1' || v[0] == 'y');
  };
  facts.compressed = yes("compresseddata");
  const std::string stored = header.get("compresseddatasize");
  if (facts.compressed && local && stored.empty())  // ITK would give a volume of zeros
    damaged("the header is damaged: the voxels are compressed, but 'CompressedDataSize' is missing", path);
  if (facts.compressed && !stored.empty()) {
    const double bytes = to_number(stored, "CompressedDataSize", path);
    if (!(bytes >= 1 && bytes < 1e18)) damaged("the header is damaged: 'CompressedDataSize'", path);
    facts.data_size = static_cast<std::uint64_t>(bytes);
  }
  if (header.get("binarydata").empty() || yes("binarydata")) require_possible(facts, path);
  return facts;
}

}  // namespace

void require_spacing(const double* spacing, std::size_t count, const std::string& path) {
  for (std::size_t i = 0; i < count; ++i)
    if (!std::isfinite(spacing[i]) || spacing[i] <= 0) {
      std::ostringstream text;
      text << "the voxel size is " << spacing[i] << " along axis " << i + 1;
      fail_input(text.str(), path, "give the file a finite voxel size above 0");
    }
}

HeaderFacts check_volume_header(const std::string& path, FileFormat format) {
  switch (format) {
    case FileFormat::nifti:
      return check_nifti(path);
    case FileFormat::gipl:
      return check_gipl(path);
    case FileFormat::nrrd:
      return check_nrrd(path);
    default:
      return check_metaimage(path);
  }
}

}  // namespace stackmesh
