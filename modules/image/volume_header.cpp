// NIfTI-1, NIfTI-2 and GIPL, whose headers are binary; what all headers share.
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

bool is_big_endian_machine() {
  const std::uint16_t one = 1;
  unsigned char first = 0;
  std::memcpy(&first, &one, 1);
  return first == 0;
}

/// The largest cosine between three vectors; NaN where one of them is zero.
double cosine_error(const std::array<Vec3, 4>& v) {
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < i; ++j) {
      const double cosine = std::abs(dot(v[i], v[j])) / (norm(v[i]) * norm(v[j]));
      worst = cosine <= worst ? worst : cosine;  // keeps a NaN
    }
  return worst;
}

// ---- NIfTI ----

bool nifti_type(int datatype, VoxelType& type) {
  switch (datatype) {
    case 2:
      type = VoxelType::u8;
      return true;
    case 256:
      type = VoxelType::i8;
      return true;
    case 512:
      type = VoxelType::u16;
      return true;
    case 4:
      type = VoxelType::i16;
      return true;
    case 768:
      type = VoxelType::u32;
      return true;
    case 8:
      type = VoxelType::i32;
      return true;
    case 1280:
      type = VoxelType::u64;
      return true;
    case 1024:
      type = VoxelType::i64;
      return true;
    case 16:
      type = VoxelType::f32;
      return true;
    case 64:
      type = VoxelType::f64;
      return true;
    default:
      return false;
  }
}

using Form = std::array<Vec3, 4>;  // three columns and the origin, LPS, in the file's unit

/// Where the fields of a header are: of NIfTI-1 (nifti1.h), whose sizes and codes are 16 bits wide and whose numbers
/// are floats, and of NIfTI-2 (nifti2.h), whose sizes are 64 bits wide, whose codes are 32, and whose numbers are
/// doubles.
struct NiftiLayout {
  bool wide;
  std::size_t bytes, magic, type, sizes, pixdim, voxels, slope, intercept, units, qform_code, sform_code, quaternion,
      offset, rows;
};
constexpr NiftiLayout kNifti1 = {false, 348, 344, 70, 40, 76, 108, 112, 116, 123, 252, 254, 256, 268, 280};
constexpr NiftiLayout kNifti2 = {true, 540, 4, 12, 16, 104, 168, 176, 184, 500, 344, 348, 352, 376, 400};

class NiftiReader {
 public:
  explicit NiftiReader(const std::string& path) : path_(path) {}

  VolumeHeader run() {
    open();
    read_sizes();
    read_scaling();
    const int unit = (at_.wide ? number_at<std::int32_t>(h_, at_.units, swap_) : h_[at_.units]) & 7;
    unit_mm_ = unit == 1 ? 1e3 : unit == 3 ? 1e-3 : 1;
    read_forms();
    return std::move(header_);
  }

 private:
  /// The i-th of the numbers from a field on.
  double real(std::size_t field, int i = 0) const {
    return at_.wide ? number_at<double>(h_, field + 8 * static_cast<std::size_t>(i), swap_)
                    : number_at<float>(h_, field + 4 * static_cast<std::size_t>(i), swap_);
  }
  std::int64_t size(int i) const {
    return at_.wide ? number_at<std::int64_t>(h_, at_.sizes + 8 * static_cast<std::size_t>(i), swap_)
                    : number_at<std::int16_t>(h_, at_.sizes + 2 * static_cast<std::size_t>(i), swap_);
  }
  int form_code(std::size_t field) const {
    return at_.wide ? number_at<std::int32_t>(h_, field, swap_) : number_at<std::int16_t>(h_, field, swap_);
  }

  void open() {
    bool compressed = false;
    h_ = read_start(path_, 544, compressed);
    if (h_.size() < 348) damaged("the file is truncated: no complete NIfTI header", path_);
    const auto is_size = [&](std::int32_t size, bool swapped) {
      return number_at<std::int32_t>(h_, 0, swapped) == size;
    };
    swap_ = is_size(348, true) || is_size(540, true);
    if (is_size(540, swap_)) at_ = kNifti2;
    else if (!is_size(348, swap_)) damaged("this is no NIfTI file, or its header is damaged", path_);
    if (h_.size() < at_.bytes) damaged("the file is truncated: no complete NIfTI header", path_);
    // The end of the mark of NIfTI-2 tells a transfer that changed line ends.
    const bool marked = at_.wide ? std::memcmp(h_.data() + at_.magic, "n+2\0\r\n\032\n", 8) == 0
                                 : std::memcmp(h_.data() + at_.magic, "n+1", 4) == 0;
    if (!marked)
      damaged(
          std::string("this is no single-file NIfTI-") + (at_.wide ? "2" : "1") + " volume, or its header is damaged",
          path_);
    header_.data.encoding = compressed ? VoxelEncoding::deflate : VoxelEncoding::raw;
    header_.data.big_endian = swap_ != is_big_endian_machine();
    header_.nan_is_zero = true;
  }

  void read_sizes() {
    const std::int64_t dims = size(0);
    if (dims < 1 || dims > 7)
      damaged("the header is damaged or of the wrong byte order: it has " + std::to_string(dims) + " dimensions",
              path_);
    header_.data.count = 1;
    for (int d = 1; d <= dims; ++d) {
      const std::int64_t n = size(d);
      if (n < 1)
        damaged("the header is damaged or of the wrong byte order: dimension " + std::to_string(d) + " is " +
                    std::to_string(n),
                path_);
      if (d > 3 && n > 1)
        fail_input("the image has more than three dimensions", path_, "give one three-dimensional label volume");
      if (n > std::numeric_limits<std::int32_t>::max())
        damaged("the header is damaged: dimension " + std::to_string(d) + " is " + std::to_string(n), path_);
      if (d <= 3) header_.size[d - 1] = static_cast<int>(n);
      if (header_.data.count > (std::uint64_t{1} << 50) / static_cast<std::uint64_t>(n))
        damaged("the header is damaged: it claims more voxels than any file holds", path_);
      header_.data.count *= static_cast<std::uint64_t>(n);
    }
    if (dims < 2) fail_input("the image has one dimension only", path_, "give a three-dimensional label volume");
    for (int d = 0; d < 3 && d < dims; ++d) header_.spacing_mm[d] = real(at_.pixdim, 1 + d);
    require_spacing(header_.spacing_mm.data(), 3, path_);
    const int datatype = number_at<std::int16_t>(h_, at_.type, swap_);
    if (!nifti_type(datatype, header_.data.type))
      fail_input("voxels of NIfTI type " + std::to_string(datatype) + " (colour, complex or other) are no labels",
                 path_, "store the labels as whole numbers");
    const double offset =
        at_.wide ? static_cast<double>(number_at<std::int64_t>(h_, at_.voxels, swap_)) : real(at_.voxels);
    if (!(offset >= 0 && offset < 1e9)) damaged("the header is damaged: its voxels begin nowhere", path_);
    DataPart part;
    part.path = path_;
    // the least: header and the mark of extensions
    part.skip = std::max<std::uint64_t>(at_.bytes + 4, static_cast<std::uint64_t>(offset));
    header_.data.parts = {part};
  }

  void read_scaling() {
    const double slope = real(at_.slope), intercept = real(at_.intercept);
    if (slope == 0) return;  // "no scaling", whatever the intercept
    if (!std::isfinite(slope) || !std::isfinite(intercept)) {
      header_.warnings.push_back(
          warning_at(WarningCode::header, path_,
                     "its scaling (scl_slope, scl_inter) is not finite; the stored numbers are taken as they are"));
      return;
    }
    header_.slope = slope;
    header_.intercept = intercept;
  }

  double checked(std::size_t field, int i) const {
    const double value = real(field, i);
    if (!std::isfinite(value)) damaged("the header is damaged: its orientation is not finite", path_);
    return value;
  }

  Form sform() const {
    Form form;
    for (int c = 0; c < 4; ++c) form[c] = {-checked(at_.rows, c), -checked(at_.rows, 4 + c), checked(at_.rows, 8 + c)};
    return form;
  }

  Form qform() const {
    double b = checked(at_.quaternion, 0), c = checked(at_.quaternion, 1), d = checked(at_.quaternion, 2),
           a = 1 - (b * b + c * c + d * d);
    if (a < 1e-7) {
      const double length = std::sqrt(b * b + c * c + d * d);
      b /= length, c /= length, d /= length;
      a = 0;
    } else {
      a = std::sqrt(a);
    }
    const double qfac = real(at_.pixdim) < 0 ? -1 : 1, x = header_.spacing_mm[0], y = header_.spacing_mm[1],
                 z = qfac * header_.spacing_mm[2];
    const Vec3 u{a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)},
        v{2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)},
        w{2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - c * c - b * b};
    const auto lps = [](double s, const Vec3& e) { return Vec3{-s * e.x, -s * e.y, s * e.z}; };
    return {lps(x, u), lps(y, v), lps(z, w),
            Vec3{-checked(at_.offset, 0), -checked(at_.offset, 1), checked(at_.offset, 2)}};
  }

  /// Two orientations that may disagree. As ITK does: the sform holds where its code is 1 or it is alone, else the
  /// qform; pixdim is the voxel size.
  void read_forms() {
    const bool has_q = form_code(at_.qform_code) > 0, has_s = form_code(at_.sform_code) > 0;
    const std::array<double, 3> stored = header_.spacing_mm;
    for (double& s : header_.spacing_mm) s *= unit_mm_;
    if (!has_q && !has_s) {
      header_.warnings.push_back(warning_at(WarningCode::header, path_,
                                            "carries no orientation; its axes are taken as left, posterior, superior"));
      return;
    }
    const bool by_s = has_s && (form_code(at_.sform_code) == 1 || !has_q);
    const Form form = by_s ? sform() : qform();
    if (by_s && !(cosine_error(form) <= 1e-4))  // a zero column gives a NaN
      fail_input("the voxel grid is sheared or its directions (sform) are zero", path_,
                 "resample the labels to a rectangular grid with nearest neighbour");
    for (int d = 0; d < 3; ++d) header_.axes[d] = unit(form[d]);
    header_.origin_mm = unit_mm_ * form[3];
    if (has_s) compare(sform(), stored);
  }

  void compare(const Form& other, const std::array<double, 3>& stored) {
    double apart = 0;
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 p = other[3], q = (1 / unit_mm_) * header_.origin_mm;
      for (int d = 0; d < 3; ++d) {
        const double index = corner >> d & 1 ? header_.size[d] - 1 : 0;
        p = p + index * other[d];
        q = q + index * stored[d] * header_.axes[d];
      }
      apart = std::max(apart, unit_mm_ * norm(p - q));
    }
    if (apart <= 0.1 * *std::min_element(header_.spacing_mm.begin(), header_.spacing_mm.end())) return;
    std::ostringstream text;
    text << path_ << ": its header gives voxel positions up to " << apart
         << " mm apart (pixdim, qform, sform); as ITK does, pixdim is the voxel size, and the qform holds unless the "
            "sform's code is 1";
    header_.warnings.push_back({WarningCode::header, path_, text.str()});
  }

  const std::string path_;
  std::vector<unsigned char> h_;
  NiftiLayout at_ = kNifti1;
  bool swap_ = false;
  double unit_mm_ = 1;
  VolumeHeader header_;
};

}  // namespace

VolumeHeader read_nifti_header(const std::string& path) {
  return NiftiReader(path).run();
}

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
    if (!std::isfinite(spacing[i]) || spacing[i] <= 0) {
      std::ostringstream text;
      text << "the voxel size is " << spacing[i] << " along axis " << i + 1;
      fail_input(text.str(), path, "give the file a finite voxel size above 0");
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
