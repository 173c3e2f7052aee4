#include "image/dicom_series.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

#include "base/error.h"
#include "base/memory.h"
#include "base/warning.h"
#include "image/dicom_dataset.h"
#include "image/dicom_file.h"
#include "image/dicom_grid.h"
#include "image/dicom_pixels.h"
#include "image/file_names.h"
#include "image/palette.h"

namespace stackmesh {
namespace {

namespace fs = std::filesystem;

constexpr const char* again = "copy or export the series again";

std::vector<std::string> files_in(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    if (it->is_regular_file(ignored)) files.push_back(it->path().string());
  }
  std::sort(files.begin(), files.end(), natural_less);
  return files;
}

std::string list_files(const std::vector<std::string>& files) {
  std::string text;
  for (std::size_t i = 0; i < files.size() && i < 8; ++i) text += (i > 0 ? ", " : "") + file_name_of(files[i]);
  return files.size() > 8 ? text + " and " + std::to_string(files.size() - 8) + " more" : text;
}

std::string list_heights(const std::vector<double>& heights) {
  std::string text;
  char number[32];
  for (std::size_t i = 0; i < heights.size() && i < 8; ++i) {
    std::snprintf(number, sizeof number, "%.6g", heights[i]);
    text += (i > 0 ? ", " : "") + std::string(number);
  }
  return heights.size() > 8 ? text + " and " + std::to_string(heights.size() - 8) + " more" : text;
}

struct SliceFile {
  std::string file;
  Vec3 position;
  double height = 0;
};

class SeriesReader {
 public:
  SeriesReader(const std::string& path, const std::string& series) : path_(path), wanted_(series) {
    find_slices();
    sort_slices();
    choose_grid();
  }

  std::array<int, 3> size() const { return {columns_, rows_, count_}; }
  std::array<double, 3> spacing_mm() const { return {grid_.pixel_x_mm, grid_.pixel_y_mm, gap_mm_}; }
  std::array<Vec3, 3> axes() const { return {grid_.x, grid_.y, grid_.normal}; }
  Vec3 origin_mm() const { return slices_[0].position; }
  std::vector<Warning>& warnings() { return warnings_; }
  const std::string& file_of(std::size_t slice) const { return slices_[slice].file; }
  bool is_even() const { return even_; }

  /// Grid slice k lies between two slices that were read: the lower one, and how far it is to the upper one.
  std::pair<std::size_t, double> place_of(int k) const {
    if (even_) return {static_cast<std::size_t>(k), 0};
    const double h = slices_[0].height + k * gap_mm_;
    std::size_t low = 0;
    while (low + 2 < slices_.size() && slices_[low + 1].height <= h) ++low;
    const double t = (h - slices_[low].height) / (slices_[low + 1].height - slices_[low].height);
    return {low, std::clamp(t, 0.0, 1.0)};
  }

  /// The rescaled values of one slice.
  std::vector<double> read(std::size_t slice) const {
    return read_dicom_pixels(slices_[slice].file, rows_, columns_).rescaled();
  }
  /// The same as labels: where a slope has made them less than whole, they are rounded.
  std::vector<double> read_labels(std::size_t slice) {
    DicomPixels pixels = read_dicom_pixels(slices_[slice].file, rows_, columns_);
    if (!pixels.is_scaled()) return std::move(pixels.stored);
    LabelRounding rounding(pixels.slope, pixels.intercept);
    for (double& v : pixels.stored) v = rounding.round(v);
    rounded_ = std::max(rounded_, rounding.worst());
    return std::move(pixels.stored);
  }
  void warn_of_rounding(std::vector<Warning>& warnings) const { warn_of_rounded_labels(rounded_, path_, warnings); }

 private:
  void find_slices() {
    std::error_code ignored;
    const bool is_file = !fs::is_directory(path_, ignored);
    const std::string folder =
        is_file ? (fs::path(path_).has_parent_path() ? fs::path(path_).parent_path().string() : ".") : path_;
    std::map<std::string, std::vector<std::string>> by_series;
    if (is_file) {
      const auto header = load_dicom_header(path_);
      if (header == nullptr) refuse_dicom(path_);
      const std::string own = text_of(*header->getDataset(), DCM_SeriesInstanceUID);
      if (!wanted_.empty() && own != wanted_)
        fail_input("the file belongs to series " + own, path_, "leave --series out, or give the folder");
      wanted_ = own;
    }
    for (const std::string& file : files_in(folder)) {
      if (dicom_kind(file) != DicomKind::image) continue;
      const auto header = load_dicom_header(file);
      by_series[text_of(*header->getDataset(), DCM_SeriesInstanceUID)].push_back(file);
    }
    if (by_series.empty())
      fail_input("no DICOM image", path_, "give the folder of a DICOM series, or one of its files");
    if (by_series.size() > 1 && wanted_.empty() && !is_file) {
      std::string list;
      for (const auto& [uid, files] : by_series)
        list += (list.empty() ? "" : ", ") + uid + " (" + std::to_string(files.size()) + " files)";
      fail_input("the folder holds " + std::to_string(by_series.size()) + " series: " + list, path_,
                 "choose one with --series UID, or name one of its files");
    }
    const auto found = wanted_.empty() ? by_series.begin() : by_series.find(wanted_);
    if (found == by_series.end()) {
      std::string list;
      for (const auto& entry : by_series) list += (list.empty() ? "" : ", ") + entry.first;
      fail_input("no series " + wanted_, path_, "choose among: " + list);
    }
    for (const std::string& file : found->second) add_slice(file);
  }

  void add_slice(const std::string& file) {
    const auto header = load_dicom_header(file);
    DcmDataset& data = *header->getDataset();
    if (number_of(data, DCM_NumberOfFrames, file).value_or(1) > 1)
      fail_input("a file of the series holds several frames", file,
                 "convert it to one file a slice, or to NIfTI or NRRD");
    const std::vector<double> orientation = numbers_of(data, DCM_ImageOrientationPatient, file);
    const std::vector<double> pixel = numbers_of(data, DCM_PixelSpacing, file);
    const std::optional<Vec3> position = vector_of(data, DCM_ImagePositionPatient, file);
    if (orientation.size() != 6 || pixel.size() != 2 || !position)
      fail_input("a slice has no place: its position, orientation or pixel spacing is missing", file, again);
    const auto length = [&](const DcmTagKey& tag) {
      return static_cast<int>(std::clamp(number_of(data, tag, file).value_or(0), 0.0, 65535.0));
    };
    const int rows = length(DCM_Rows), columns = length(DCM_Columns);
    if (rows < 1 || columns < 1) fail_input("a slice has no rows or columns", file, again);
    if (slices_.empty()) {
      rows_ = rows;
      columns_ = columns;
      grid_ = DicomGrid(orientation, pixel, file);
      for (const DcmTagKey& tag : {DCM_SpacingBetweenSlices, DCM_SliceThickness})
        if (alone_mm_ <= 0) alone_mm_ = std::abs(number_of(data, tag, file).value_or(0));
    } else {
      if (rows != rows_ || columns != columns_)
        fail_input("the slices of the series differ in size", file + " against " + slices_[0].file,
                   "give slices of one size");
      grid_.require_same(orientation, pixel, file);
      grid_.require_above(slices_[0].position, *position, file);
    }
    slices_.push_back({file, *position, grid_.height(*position)});
  }

  void sort_slices() {
    std::stable_sort(slices_.begin(), slices_.end(),
                     [](const SliceFile& a, const SliceFile& b) { return a.height < b.height; });
    std::vector<SliceFile> kept;
    std::vector<std::string> twice;
    for (SliceFile& s : slices_) {
      if (!kept.empty() && s.height - kept.back().height <= 1e-3) twice.push_back(s.file);
      else kept.push_back(std::move(s));
    }
    if (kept.size() == 1 && !twice.empty())
      fail_input("all " + std::to_string(slices_.size()) + " slices of the series have the same position, at height " +
                     list_heights({kept[0].height}) + " mm",
                 path_, "export the series with its true positions (ImagePositionPatient)");
    if (2 * twice.size() >= kept.size() && !twice.empty() && kept.size() > 1)
      fail_input(
          "the series holds several images at each position (times, echoes or copies), such as " + list_files(twice),
          path_, "put one image of each position into a folder");
    if (!twice.empty())
      warnings_.push_back(
          warning_at(WarningCode::repeated, path_,
                     "duplicated slices, of which the first is used: " + list_files(twice) + " are left out"));
    slices_ = std::move(kept);
  }

  void choose_grid() {
    const std::size_t n = slices_.size();
    gap_mm_ = alone_mm_ > 0 ? alone_mm_ : 1;
    count_ = static_cast<int>(n);
    if (n < 2) return;
    std::vector<double> gaps, lost;
    for (std::size_t i = 1; i < n; ++i) gaps.push_back(slices_[i].height - slices_[i - 1].height);
    std::vector<double> sorted = gaps;
    std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
    const double usual = sorted[sorted.size() / 2], smallest = *std::min_element(gaps.begin(), gaps.end());
    const double span = slices_.back().height - slices_[0].height;
    even_ = std::all_of(gaps.begin(), gaps.end(),
                        [&](double g) { return std::abs(g - usual) <= std::max(0.01, 0.01 * usual); });
    if (even_) {
      gap_mm_ = span / static_cast<double>(n - 1);
      return;
    }
    bool multiples = true;
    for (std::size_t i = 0; i < gaps.size(); ++i) {
      const double k = gaps[i] / usual;
      multiples = multiples && k > 0.95 && std::abs(k - std::round(k)) <= 0.05;
      for (int m = 1; m < std::round(k) && m < 100000; ++m) lost.push_back(slices_[i].height + m * usual);
    }
    if (multiples)
      warnings_.push_back(warning_at(WarningCode::missing_slices, path_,
                                     "missing slices at heights " + list_heights(lost) + " mm (gap " +
                                         list_heights({usual}) + " mm); they are filled from their neighbours"));
    else
      warnings_.push_back(warning_at(WarningCode::missing_slices, path_,
                                     "the gaps of the slices are uneven, from " + list_heights({smallest}) + " to " +
                                         list_heights({*std::max_element(gaps.begin(), gaps.end())}) +
                                         " mm; the slices are taken to an even grid by their true positions"));
    const double wanted = multiples ? usual : smallest;
    const double count = std::round(span / wanted) + 1;
    if (!(count <= 64.0 * static_cast<double>(n) + 256))
      fail_input("the gaps of the slices differ too much for an even grid", path_,
                 "resample the series to even slices");
    count_ = static_cast<int>(count);
    gap_mm_ = span / (count - 1);
  }

  const std::string path_;
  std::string wanted_;
  std::vector<SliceFile> slices_;
  std::vector<Warning> warnings_;
  DicomGrid grid_;
  int rows_ = 0, columns_ = 0, count_ = 0;
  double gap_mm_ = 1, alone_mm_ = 0, rounded_ = 0;
  bool even_ = true;
};

template <class Volume>
void take_grid(SeriesReader& series, Volume& volume) {
  volume.size = series.size();
  volume.spacing_mm = series.spacing_mm();
  volume.axes = series.axes();
  volume.origin_mm = series.origin_mm();
  volume.kind = "dicom";
  volume.warnings = series.warnings();
}

}  // namespace

DicomContent dicom_content(const std::string& path) {
  DicomContent content;
  std::error_code ignored;
  const std::vector<std::string> files =
      fs::is_directory(path, ignored) ? files_in(path) : std::vector<std::string>{path};
  for (const std::string& file : files) switch (dicom_kind(file)) {
      case DicomKind::structure_set:
        content.structure_sets.push_back(file);
        break;
      case DicomKind::segmentation:
        content.segmentations.push_back(file);
        break;
      case DicomKind::image:
        content.images.push_back(file);
        break;
      case DicomKind::other:
        content.others.push_back(file);
        break;
      case DicomKind::none:
        break;
    }
  return content;
}

std::string label_object(const DicomContent& content, const std::string& path) {
  std::vector<std::string> all = content.structure_sets;
  all.insert(all.end(), content.segmentations.begin(), content.segmentations.end());
  if (all.size() > 1)
    fail_input("several structure sets or segmentations: " + list_files(all), path, "name one of these files");
  return all.empty() ? "" : all[0];
}

LabelVolume read_series_labels(const std::string& path, const std::string& series_uid) {
  SeriesReader series(path, series_uid);
  LabelVolume volume;
  take_grid(series, volume);
  const std::size_t pixels = static_cast<std::size_t>(volume.size[0]) * volume.size[1];
  series.read(0);  // its pixels are there before memory for all of them is taken
  require_memory((2 * static_cast<std::size_t>(volume.size[2]) + 8) * pixels,
                 "the labels of " + std::to_string(volume.size[2]) + " slices", path, "crop the series");
  volume.voxels.resize(pixels * volume.size[2]);
  Palette palette;
  for (int k = 0; k < volume.size[2]; ++k) {
    const auto [low, t] = series.place_of(k);
    const std::size_t nearest = t <= 0.5 ? low : low + 1;
    const std::vector<double> values = series.read_labels(nearest);
    palette.convert(values.data(), volume.voxels.data() + pixels * k, pixels, [&](std::size_t i) {
      return std::pair<std::string, std::string>(
          series.file_of(nearest),
          "pixel (" + std::to_string(i % volume.size[0]) + ", " + std::to_string(i / volume.size[0]) + ")");
    });
  }
  palette.finish(volume, path);
  series.warn_of_rounding(volume.warnings);
  return volume;
}

IntensityVolume read_series_image(const std::string& path, const std::string& series_uid) {
  SeriesReader series(path, series_uid);
  IntensityVolume image;
  take_grid(series, image);
  const std::size_t pixels = static_cast<std::size_t>(image.size[0]) * image.size[1];
  series.read(0);
  require_memory((sizeof(float) * static_cast<std::size_t>(image.size[2]) + 24) * pixels,
                 "the intensities of " + std::to_string(image.size[2]) + " slices", path, "crop the series");
  image.values.resize(pixels * image.size[2]);
  std::map<std::size_t, std::vector<double>> read;  // the slices that the next ones need
  for (int k = 0; k < image.size[2]; ++k) {
    const auto [low, t] = series.place_of(k);
    read.erase(read.begin(), read.lower_bound(low));
    for (std::size_t s = low; s <= low + (t > 0 ? 1 : 0); ++s)
      if (read.count(s) == 0) read[s] = series.read(s);
    const std::vector<double>&a = read[low], &b = t > 0 ? read[low + 1] : a;
    for (std::size_t i = 0; i < pixels; ++i)
      image.values[pixels * k + i] = static_cast<float>(a[i] + t * (b[i] - a[i]));
  }
  return image;
}

}  // namespace stackmesh
