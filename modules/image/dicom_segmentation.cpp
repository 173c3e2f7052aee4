#include "image/dicom_segmentation.h"

#include <dcmtk/dcmdata/dcrledrg.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <set>

#include "base/error.h"
#include "base/memory.h"
#include "base/warning.h"
#include "image/dicom_dataset.h"
#include "image/dicom_grid.h"
#include "image/segments.h"

namespace stackmesh {
namespace {

constexpr const char* again = "export the segmentation again";

/// RecommendedDisplayCIELabValue (PS3.3 C.10.7.1.1) to sRGB, white point D65 as DCMTK and dcmqi use it.
std::array<std::uint8_t, 3> rgb_of_lab(const std::vector<double>& scaled) {
  const double l = scaled[0] / 65535 * 100, a = scaled[1] / 65535 * 255 - 128, b = scaled[2] / 65535 * 255 - 128;
  const double fy = (l + 16) / 116, fx = fy + a / 500, fz = fy - b / 200;
  const auto inverse = [](double f) { return f > 6.0 / 29 ? f * f * f : 3 * (6.0 / 29) * (6.0 / 29) * (f - 4.0 / 29); };
  const double x = 0.950456 * inverse(fx), y = inverse(fy), z = 1.088754 * inverse(fz);
  const std::array<double, 3> linear = {3.2404542 * x - 1.5371385 * y - 0.4985314 * z,
                                        -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
                                        0.0556434 * x - 0.2040259 * y + 1.0572252 * z};
  std::array<std::uint8_t, 3> rgb{};
  for (int i = 0; i < 3; ++i) {
    const double c = std::clamp(linear[i], 0.0, 1.0);
    rgb[i] = static_cast<std::uint8_t>(
        std::lround(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055)));
  }
  return rgb;
}

enum class Type { binary, fractional, label_map };

struct Frame2d {
  Vec3 position;
  std::uint16_t segment = 0;  // 1 + index; 0: a label map
  int slice = 0;
};

class SegmentationReader {
 public:
  explicit SegmentationReader(const std::string& path)
      : path_(path), file_(load_dicom(path)), data_(*file_->getDataset()) {}

  LabelVolume run(const std::string& labels) {
    read_type();
    read_segments();
    read_frames();
    place_frames();
    decode();
    volume_.kind = "dicomseg";
    join_segments(
        segments_, [&](int k) { return layers_of(k); }, labels, path_, volume_);
    return std::move(volume_);
  }

 private:
  std::string frame_name(std::size_t frame) const { return path_ + ", frame " + std::to_string(frame + 1); }

  long whole(const DcmTagKey& tag, const char* name, long low, long high) {
    const std::optional<double> n = number_of(data_, tag, path_);
    if (!n || *n != std::floor(*n) || *n < low || *n > high)
      fail_input(std::string("the segmentation gives no usable ") + name, path_, again);
    return static_cast<long>(*n);
  }

  void read_type() {
    const std::string type = text_of(data_, DCM_SegmentationType);
    if (type == "BINARY") type_ = Type::binary;
    else if (type == "FRACTIONAL") type_ = Type::fractional;
    else if (type == "LABELMAP") type_ = Type::label_map;
    else fail_input("the segmentation is neither binary, fractional nor a label map", path_, again);
    rows_ = whole(DCM_Rows, "number of rows", 1, 65535);
    columns_ = whole(DCM_Columns, "number of columns", 1, 65535);
    bits_ = whole(DCM_BitsAllocated, "number of bits a pixel", 1, 16);
    const bool fits = type_ == Type::binary       ? bits_ == 1 || bits_ == 8
                      : type_ == Type::fractional ? bits_ == 8
                                                  : bits_ == 8 || bits_ == 16;
    if (!fits) fail_input("a " + type + " segmentation with " + std::to_string(bits_) + " bits a pixel", path_, again);
    if (type_ == Type::fractional) {
      largest_ = number_of(data_, DCM_MaximumFractionalValue, path_).value_or(255);
      volume_.warnings.push_back(
          warning_at(WarningCode::values_changed, path_,
                     "its segments are fractional; what has at least half of the largest value counts as inside"));
    }
  }

  void read_segments() {
    std::set<long> numbers;
    for (DcmItem* item : items_of(data_, DCM_SegmentSequence)) {
      const std::optional<double> number = number_of(*item, DCM_SegmentNumber, path_);
      if (!number || *number < 0 || *number > 65535) fail_input("a segment without a number", path_, again);
      if (*number == 0) continue;  // a label map may describe its background
      LabelInfo label;
      label.number = static_cast<Label>(*number);
      label.name = text_of(*item, DCM_SegmentLabel);
      const std::vector<double> lab = numbers_of(*item, DCM_RecommendedDisplayCIELabValue, path_);
      if (lab.size() == 3) label.colour = rgb_of_lab(lab);
      if (!numbers.insert(label.number).second)
        fail_input("two segments have the number " + std::to_string(label.number), path_, again);
      segments_.push_back(std::move(label));
    }
    if (segments_.empty()) fail_input("the segmentation describes no segment", path_, again);
    for (std::size_t i = 0; i < segments_.size(); ++i)
      index_of_[segments_[i].number] = static_cast<std::uint16_t>(i + 1);
  }

  /// A field of a functional group: the frame's own, else the one that all share. Groups that are not known are not
  /// looked at.
  std::vector<double> group(DcmItem* own, const DcmTagKey& sequence, const DcmTagKey& tag, std::size_t frame) {
    for (DcmItem* item : {own, shared_})
      if (item != nullptr)
        if (DcmItem* found = first_item(*item, sequence)) {
          std::vector<double> n = numbers_of(*found, tag, frame_name(frame));
          if (!n.empty()) return n;
        }
    return {};
  }

  void read_frames() {
    shared_ = first_item(data_, DCM_SharedFunctionalGroupsSequence);
    const std::vector<DcmItem*> own = items_of(data_, DCM_PerFrameFunctionalGroupsSequence);
    const auto frames = static_cast<std::size_t>(
        data_.tagExists(DCM_NumberOfFrames) ? whole(DCM_NumberOfFrames, "number of frames", 1, 10000000) : 1);
    if (!own.empty() && own.size() != frames)
      fail_input(
          "the segmentation has " + std::to_string(frames) + " frames and describes " + std::to_string(own.size()),
          path_, again);
    for (std::size_t f = 0; f < frames; ++f) {
      DcmItem* const groups = own.empty() ? nullptr : own[f];
      const std::vector<double> position = group(groups, DCM_PlanePositionSequence, DCM_ImagePositionPatient, f);
      const std::vector<double> direction = group(groups, DCM_PlaneOrientationSequence, DCM_ImageOrientationPatient, f);
      const std::vector<double> pixel = group(groups, DCM_PixelMeasuresSequence, DCM_PixelSpacing, f);
      if (position.size() != 3 || direction.size() != 6 || pixel.size() != 2)
        fail_input("a frame has no place: its plane position, orientation or pixel spacing is missing", frame_name(f),
                   again);
      Frame2d frame;
      frame.position = {position[0], position[1], position[2]};
      if (f == 0) {
        grid_ = DicomGrid(direction, pixel, frame_name(f));
        const std::vector<double> apart = group(groups, DCM_PixelMeasuresSequence, DCM_SpacingBetweenSlices, f);
        const std::vector<double> thick = group(groups, DCM_PixelMeasuresSequence, DCM_SliceThickness, f);
        if (!apart.empty()) declared_gap_ = std::abs(apart[0]);
        if (!thick.empty()) thickness_ = thick[0];
      } else {
        grid_.require_same(direction, pixel, frame_name(f));
      }
      if (type_ != Type::label_map) {
        const std::vector<double> number =
            group(groups, DCM_SegmentIdentificationSequence, DCM_ReferencedSegmentNumber, f);
        const bool usable =
            !number.empty() && number[0] >= 0 && number[0] <= 65535 && number[0] == std::floor(number[0]);
        const auto found = usable ? index_of_.find(static_cast<Label>(number[0])) : index_of_.end();
        if (number.empty() && segments_.size() == 1) frame.segment = 1;
        else if (found == index_of_.end())
          fail_input("a frame belongs to no segment that the file describes", frame_name(f), again);
        else frame.segment = found->second;
      }
      frames_.push_back(frame);
    }
  }

  /// Slices by the frames' heights along the common normal. Frames that are left out are empty.
  void place_frames() {
    std::vector<double> heights;
    for (std::size_t f = 0; f < frames_.size(); ++f) {
      heights.push_back(grid_.height(frames_[f].position));
      grid_.require_above(frames_[0].position, frames_[f].position, frame_name(f));
    }
    const double gap = slice_gap(heights);
    const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
    const double count = std::round((*high - *low) / gap) + 1;
    if (!(count <= 64.0 * static_cast<double>(frames_.size()) + 1000))  // a NaN is absurd, too
      fail_input("the segmentation's " + std::to_string(frames_.size()) + " frames span an absurd number of slices",
                 path_, again);
    require_memory(static_cast<std::uint64_t>(2 * count) * static_cast<std::uint64_t>(rows_ * columns_),
                   "the labels of " + std::to_string(static_cast<int>(count)) + " slices", path_,
                   "crop the segmentation");
    volume_.size = {static_cast<int>(columns_), static_cast<int>(rows_), static_cast<int>(count)};
    volume_.spacing_mm = {grid_.pixel_x_mm, grid_.pixel_y_mm, count > 1 ? (*high - *low) / (count - 1) : gap};
    volume_.axes = {grid_.x, grid_.y, grid_.normal};
    volume_.origin_mm = frames_[static_cast<std::size_t>(low - heights.begin())].position;
    volume_.goes_on_low = volume_.goes_on_high = {false, false, true};
    frames_of_.resize(volume_.size[2]);
    for (std::size_t f = 0; f < frames_.size(); ++f) {
      const double slice = (heights[f] - *low) / volume_.spacing_mm[2];
      frames_[f].slice = static_cast<int>(std::lround(slice));
      if (!(std::abs(slice - frames_[f].slice) <= 0.05))
        fail_input("the frames are not evenly spaced", frame_name(f), "resample the segmentation to even slices");
      frames_of_[frames_[f].slice].push_back(f);
    }
  }

  double slice_gap(std::vector<double> heights) {
    std::sort(heights.begin(), heights.end());
    double smallest = 0;
    for (std::size_t i = 1; i < heights.size(); ++i) {
      const double gap = heights[i] - heights[i - 1];
      if (gap > 0.01 && (smallest == 0 || gap < smallest)) smallest = gap;
    }
    if (smallest == 0) {
      if (declared_gap_ > 0) return declared_gap_;
      if (thickness_ > 0) return thickness_;
      fail_input("the segmentation has one slice only and gives no thickness for it", path_, again);
    }
    return choose_gap(heights, smallest);
  }

  static bool fits(const std::vector<double>& heights, double gap) {
    return std::all_of(heights.begin(), heights.end(), [&](double h) {
      const double k = (h - heights[0]) / gap;
      return std::abs(k - std::round(k)) < 0.05;
    });
  }

  /// Where frames are left out, the true gap may be smaller than any between two frames: then they lie at uneven
  /// multiples of the declared one. Frames that lie evenly give their own gap, whatever is declared; two heights alone
  /// go by the thickness.
  double choose_gap(const std::vector<double>& heights, double smallest) {
    const auto is = [](double a, double b) { return std::abs(a - b) <= 0.01 * b; };
    if (declared_gap_ <= 0.01 || is(declared_gap_, smallest)) return smallest;
    const bool declared_fits = declared_gap_ < smallest && fits(heights, declared_gap_),
               two = heights.back() - heights.front() <= smallest + 0.01;
    if (declared_fits && (!fits(heights, smallest) || (two && is(thickness_, declared_gap_)))) return declared_gap_;
    char text[160];
    std::snprintf(text, sizeof text,
                  ": it declares slices %.6g mm apart, but its frames are %.6g mm apart; the frames' own gap is taken",
                  declared_gap_, smallest);
    volume_.warnings.push_back({WarningCode::header, path_, path_ + text});
    return smallest;
  }

  void decode() {
    DcmXfer syntax(data_.getOriginalXfer());
    if (syntax.isEncapsulated()) {
      DcmRLEDecoderRegistration::registerCodecs();
      if (data_.chooseRepresentation(EXS_LittleEndianExplicit, nullptr).bad())
        fail_input(
            "its pixels are stored as " + transfer_syntax_of(*file_) + ", which cannot be decoded for segmentations",
            path_, "convert it to an uncompressed transfer syntax, with dcmdjpeg, dcmdjpls or gdcmconv --raw");
    }
    DcmElement* element = nullptr;
    if (data_.findAndGetElement(DCM_PixelData, element).bad() || element == nullptr)
      fail_input("the segmentation has no pixel data", path_, again);
    Uint8* bytes = nullptr;
    Uint16* words = nullptr;
    std::size_t have = element->getLength();
    if (element->getUint8Array(bytes).good() && bytes != nullptr) pixels_ = bytes;
    else if (element->getUint16Array(words).good() && words != nullptr) pixels_ = reinterpret_cast<const Uint8*>(words);
    else fail_input("the pixel data cannot be read", path_, again);
    const double need = std::ceil(static_cast<double>(frames_.size()) * static_cast<double>(rows_ * columns_) *
                                  static_cast<double>(bits_) / 8);
    if (static_cast<double>(have) < need)
      fail_input("the segmentation is truncated: " + std::to_string(have) + " bytes of pixels where its header needs " +
                     std::to_string(static_cast<std::uint64_t>(need)),
                 path_, again);
  }

  std::vector<std::vector<std::uint16_t>> layers_of(int k) {
    std::vector<std::vector<std::uint16_t>> layers;
    const auto pixels = static_cast<std::size_t>(rows_ * columns_);
    for (std::size_t f : frames_of_[k]) {
      std::vector<std::uint16_t> layer(pixels, 0);
      const std::uint16_t segment = frames_[f].segment;
      for (std::size_t i = 0; i < pixels; ++i) {
        const std::size_t at = f * pixels + i;
        if (type_ == Type::label_map) layer[i] = index_at(at, f);
        else if (bits_ == 1) layer[i] = pixels_[at >> 3] >> (at & 7) & 1 ? segment : 0;
        else if (type_ == Type::binary) layer[i] = pixels_[at] != 0 ? segment : 0;
        else layer[i] = 2 * pixels_[at] >= largest_ ? segment : 0;
      }
      layers.push_back(std::move(layer));
    }
    return layers;
  }

  std::uint16_t index_at(std::size_t at, std::size_t frame) {
    std::uint16_t value = pixels_[at];
    if (bits_ == 16) std::memcpy(&value, pixels_ + 2 * at, 2);
    if (value == 0) return 0;
    if (value == last_value_) return last_index_;
    const auto found = index_of_.find(value);
    if (found == index_of_.end())
      fail_input("a pixel belongs to segment " + std::to_string(value) + ", which the file does not describe",
                 frame_name(frame), again);
    last_value_ = value;
    return last_index_ = found->second;
  }

  const std::string path_;
  std::unique_ptr<DcmFileFormat> file_;
  DcmDataset& data_;
  LabelVolume volume_;
  Type type_ = Type::binary;
  long rows_ = 0, columns_ = 0, bits_ = 0;
  double largest_ = 255, declared_gap_ = 0, thickness_ = 0;
  std::vector<LabelInfo> segments_;
  std::map<Label, std::uint16_t> index_of_;  // segment number -> 1 + index
  DcmItem* shared_ = nullptr;
  DicomGrid grid_;
  std::vector<Frame2d> frames_;
  std::vector<std::vector<std::size_t>> frames_of_;
  const Uint8* pixels_ = nullptr;
  std::uint16_t last_value_ = 0, last_index_ = 0;
};

}  // namespace

LabelVolume read_segmentation(const std::string& path, const std::string& labels) {
  return SegmentationReader(path).run(labels);
}

}  // namespace stackmesh
