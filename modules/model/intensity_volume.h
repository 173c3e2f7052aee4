#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/warning.h"
#include "model/geometry.h"

namespace stackmesh {

/// A scalar image (CT, MRI) on a regular grid that may be oblique, with its place in the world.
struct IntensityVolume {
  std::array<int, 3> size = {0, 0, 0};                                       ///< voxels along x (fastest), y, z
  std::array<double, 3> spacing_mm = {1, 1, 1};                              ///< > 0
  Vec3 origin_mm;                                                            ///< centre of voxel (0, 0, 0), LPS
  std::array<Vec3, 3> axes = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  ///< orthonormal, LPS
  std::vector<float> values;      ///< size[0] * size[1] * size[2], in the image's own unit (CT: HU); finite
  std::string kind;               ///< "nifti", "nrrd", "metaimage", "gipl", ...
  std::vector<Warning> warnings;  ///< what reading found odd but could mend

  /// Place of voxel (i, j, k) in the values.
  std::size_t index(int i, int j, int k) const { return (static_cast<std::size_t>(k) * size[1] + j) * size[0] + i; }
  /// World position (LPS, mm) of a continuous voxel index.
  Vec3 world(double i, double j, double k) const {
    return origin_mm + (i * spacing_mm[0] * axes[0] + j * spacing_mm[1] * axes[1] + k * spacing_mm[2] * axes[2]);
  }
  /// Continuous voxel index of a world position (LPS, mm).
  Vec3 voxel_of(Vec3 p) const {
    const Vec3 d = p - origin_mm;
    return {dot(d, axes[0]) / spacing_mm[0], dot(d, axes[1]) / spacing_mm[1], dot(d, axes[2]) / spacing_mm[2]};
  }
  /// True when a world position (LPS, mm) lies in a voxel of the image: within half a voxel of a centre.
  bool contains(Vec3 p) const;
  /// The value at a world position (LPS, mm), linear between voxel centres and constant in the outer half voxel; none
  /// outside of the image.
  std::optional<double> sample(Vec3 p) const;
};

}  // namespace stackmesh
