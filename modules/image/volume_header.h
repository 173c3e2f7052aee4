#pragma once
#include <string>
#include <vector>

#include "base/warning.h"
#include "image/file_names.h"
#include "image/slicer_segments.h"
#include "image/voxel_data.h"
#include "model/geometry.h"

namespace stackmesh {

/// What the header of a volume file says. The readers are ours, so that nothing is mended or overlooked in silence; the
/// fields of NIfTI are libnifti2's.
struct VolumeHeader {
  std::array<int, 3> size = {1, 1, 1};
  std::array<double, 3> spacing_mm = {1, 1, 1};
  Vec3 origin_mm;  ///< centre of voxel (0, 0, 0), LPS
  /// of unit length, LPS; at right angles only nearly
  std::array<Vec3, 3> axes = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  VoxelData data;
  int layers = 1;  ///< values a voxel, of segments that overlap
  /// values from one voxel to the next along x, y, z, and from layer to layer; set where layers > 1
  std::array<std::uint64_t, 4> step = {};
  double slope = 1, intercept = 0;  ///< what stands for a stored value v is slope * v + intercept
  /// NIfTI: values that are not finite stand for nothing, as its own library reads them
  bool nan_is_zero = false;
  SlicerSegmentation segmentation;  ///< NRRD: the segments of 3D Slicer, where it names any
  std::vector<Warning> warnings;
  bool is_scaled() const { return slope != 1 || intercept != 0; }
};

/// Reads the header of a volume file: sizes, spacing, directions, where the voxels are, and that their bytes are there.
/// A header that names other files may name those of its own folder (and of folders therein); `allow_outside` lets it
/// name any.
/// @throws Error(input)
VolumeHeader read_volume_header(const std::string& path, FileFormat format, bool allow_outside = false);

/// @throws Error(input) unless all spacings are finite and positive.
void require_spacing(const double* spacing, std::size_t count, const std::string& path);

// ---- for the readers of the formats ----
VolumeHeader read_nifti_header(const std::string& path);
VolumeHeader read_gipl_header(const std::string& path);
VolumeHeader read_nrrd_volume_header(const std::string& path, bool allow_outside);
VolumeHeader read_metaimage_header(const std::string& path, bool allow_outside);

/// The vector divided by its length: exactly 1 or -1 along an axis.
inline Vec3 unit(Vec3 v) {
  const double length = norm(v);
  return {v.x / length, v.y / length, v.z / length};
}

/// The sizes along all axes as whole numbers above 0. @throws Error(input)
std::vector<std::uint64_t> whole_sizes(const std::vector<double>& sizes, double dimensions, const std::string& path);

}  // namespace stackmesh
