// NIfTI-1 and NIfTI-2: where fields are, what codes mean and the byte order by libnifti2; every check is here.
#include <nifti2_io.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

#include "base/error.h"
#include "base/warning.h"
#include "image/volume_header.h"

namespace stackmesh {
namespace {

[[noreturn]] void damaged(const std::string& what, const std::string& path) {
  fail_input(what, path, "copy or export the file again");
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

/// The type of voxels that labels or intensities can be; false for colours, complex numbers and others.
bool nifti_type(int datatype, VoxelType& type) {
  switch (datatype) {
    case NIFTI_TYPE_UINT8:
      type = VoxelType::u8;
      return true;
    case NIFTI_TYPE_INT8:
      type = VoxelType::i8;
      return true;
    case NIFTI_TYPE_UINT16:
      type = VoxelType::u16;
      return true;
    case NIFTI_TYPE_INT16:
      type = VoxelType::i16;
      return true;
    case NIFTI_TYPE_UINT32:
      type = VoxelType::u32;
      return true;
    case NIFTI_TYPE_INT32:
      type = VoxelType::i32;
      return true;
    case NIFTI_TYPE_UINT64:
      type = VoxelType::u64;
      return true;
    case NIFTI_TYPE_INT64:
      type = VoxelType::i64;
      return true;
    case NIFTI_TYPE_FLOAT32:
      type = VoxelType::f32;
      return true;
    case NIFTI_TYPE_FLOAT64:
      type = VoxelType::f64;
      return true;
    default:
      return false;
  }
}

using Form = std::array<Vec3, 4>;  // three columns and the origin, LPS, in the file's unit

// What differs between the two versions. The end of the mark of NIfTI-2 tells a transfer that changed line ends.
void change_byte_order(nifti_1_header& header) {
  nifti_swap_as_nifti1(&header);
}
void change_byte_order(nifti_2_header& header) {
  nifti_swap_as_nifti2(&header);
}
bool is_single_file(const nifti_1_header& header) {
  return std::memcmp(header.magic, "n+1", 4) == 0;
}
bool is_single_file(const nifti_2_header& header) {
  return std::memcmp(header.magic, "n+2\0\r\n\032\n", 8) == 0;
}

/// @tparam Header nifti_1_header or nifti_2_header: fields of the same names, wider in the second
template <class Header>
class NiftiReader {
 public:
  NiftiReader(const std::string& path, const std::vector<unsigned char>& start, bool swap) : path_(path) {
    if (start.size() < sizeof(Header)) damaged("the file is truncated: no complete NIfTI header", path_);
    std::memcpy(&h_, start.data(), sizeof(Header));
    if (swap) change_byte_order(h_);
  }

  VolumeHeader run() {
    if (!is_single_file(h_))
      damaged(std::string("this is no single-file NIfTI-") + (sizeof(Header) == sizeof(nifti_2_header) ? "2" : "1") +
                  " volume, or its header is damaged",
              path_);
    header_.nan_is_zero = true;
    read_sizes();
    read_scaling();
    const int unit = XYZT_TO_SPACE(h_.xyzt_units);
    unit_mm_ = unit == NIFTI_UNITS_METER ? 1e3 : unit == NIFTI_UNITS_MICRON ? 1e-3 : 1;
    read_forms();
    return std::move(header_);
  }

 private:
  void read_sizes() {
    const std::int64_t dims = h_.dim[0];
    if (dims < 1 || dims > 7)
      damaged("the header is damaged or of the wrong byte order: it has " + std::to_string(dims) + " dimensions",
              path_);
    header_.data.count = 1;
    for (int d = 1; d <= dims; ++d) {
      const std::int64_t n = h_.dim[d];
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
    for (int d = 0; d < 3 && d < dims; ++d) header_.spacing_mm[d] = h_.pixdim[1 + d];
    require_spacing(header_.spacing_mm.data(), 3, path_);
    if (!nifti_type(h_.datatype, header_.data.type))
      fail_input("voxels of NIfTI type " + std::to_string(h_.datatype) + " (colour, complex or other) are no labels",
                 path_, "store the labels as whole numbers");
    const auto offset = static_cast<double>(h_.vox_offset);
    if (!(offset >= 0 && offset < 1e9)) damaged("the header is damaged: its voxels begin nowhere", path_);
    DataPart part;
    part.path = path_;
    // the least: header and the mark of extensions
    part.skip = std::max<std::uint64_t>(sizeof(Header) + 4, static_cast<std::uint64_t>(offset));
    header_.data.parts = {part};
  }

  void read_scaling() {
    const double slope = h_.scl_slope, intercept = h_.scl_inter;
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

  double checked(double value) const {
    if (!std::isfinite(value)) damaged("the header is damaged: its orientation is not finite", path_);
    return value;
  }

  Form sform() const {
    Form form;
    for (int c = 0; c < 4; ++c) form[c] = {-checked(h_.srow_x[c]), -checked(h_.srow_y[c]), checked(h_.srow_z[c])};
    return form;
  }

  /// Not by nifti_quatern_to_dmat44, whose last bits are others (docs/dependencies.md).
  Form qform() const {
    double b = checked(h_.quatern_b), c = checked(h_.quatern_c), d = checked(h_.quatern_d),
           a = 1 - (b * b + c * c + d * d);
    if (!std::isfinite(a)) damaged("the header is damaged: its rotation (quatern_b, _c, _d) is too large", path_);
    if (a < 1e-7) {
      const double length = std::sqrt(b * b + c * c + d * d);
      b /= length, c /= length, d /= length;
      a = 0;
    } else {
      a = std::sqrt(a);
    }
    const double qfac = h_.pixdim[0] < 0 ? -1 : 1, x = header_.spacing_mm[0], y = header_.spacing_mm[1],
                 z = qfac * header_.spacing_mm[2];
    const Vec3 u{a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)},
        v{2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)},
        w{2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - c * c - b * b};
    const auto lps = [](double s, const Vec3& e) { return Vec3{-s * e.x, -s * e.y, s * e.z}; };
    return {lps(x, u), lps(y, v), lps(z, w),
            Vec3{-checked(h_.qoffset_x), -checked(h_.qoffset_y), checked(h_.qoffset_z)}};
  }

  /// Two orientations that may disagree. As ITK does: the sform holds where its code is 1 or it is alone, else the
  /// qform; pixdim is the voxel size.
  void read_forms() {
    const bool has_q = h_.qform_code > 0, has_s = h_.sform_code > 0;
    const std::array<double, 3> stored = header_.spacing_mm;
    for (double& s : header_.spacing_mm) s *= unit_mm_;
    if (!has_q && !has_s) {
      header_.warnings.push_back(warning_at(WarningCode::header, path_,
                                            "carries no orientation; its axes are taken as left, posterior, superior"));
      return;
    }
    const bool by_s = has_s && (h_.sform_code == NIFTI_XFORM_SCANNER_ANAT || !has_q);
    const Form form = by_s ? sform() : qform();
    if (by_s && !(cosine_error(form) <= 1e-4))  // a zero column gives a NaN
      fail_input("the voxel grid is sheared, or its directions (sform) are zero or too large", path_,
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

  const std::string& path_;
  Header h_;
  double unit_mm_ = 1;
  VolumeHeader header_;
};

}  // namespace

VolumeHeader read_nifti_header(const std::string& path) {
  bool compressed = false;
  const std::vector<unsigned char> start = read_start(path, sizeof(nifti_2_header) + 4, compressed);
  if (start.size() < sizeof(nifti_1_header)) damaged("the file is truncated: no complete NIfTI header", path);
  std::int32_t size = 0;  // of the header, which tells version and byte order
  std::memcpy(&size, start.data(), sizeof size);
  constexpr std::int32_t first = sizeof(nifti_1_header), second = sizeof(nifti_2_header);
  const auto known = [&] { return size == first || size == second; };
  const bool swap = !known();
  if (swap) nifti_swap_4bytes(1, &size);
  if (!known()) damaged("this is no NIfTI file, or its header is damaged", path);
  VolumeHeader header = size == first ? NiftiReader<nifti_1_header>(path, start, swap).run()
                                      : NiftiReader<nifti_2_header>(path, start, swap).run();
  header.data.encoding = compressed ? VoxelEncoding::deflate : VoxelEncoding::raw;
  header.data.big_endian = swap != is_big_endian_machine();
  return header;
}

}  // namespace stackmesh
