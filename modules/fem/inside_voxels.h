#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "model/intensity_volume.h"
#include "model/space.h"
#include "model/tet_mesh.h"

namespace stackmesh {

/// The intensities of one label: those of voxels whose centres lie in its tets (and not near its border), continued
/// outward from there, so that no neighbour's tissue is mixed in.
class InsideVoxels {
 public:
  /// @param tets of the label; positions are turned from the space of the mesh to that of the image, LPS
  /// @param erode_px steps from voxel to face neighbour that are taken off the label's border; fewer where nothing
  /// would be left
  InsideVoxels(const IntensityVolume& image, const TetMesh& mesh, const std::vector<std::int32_t>& tets, int erode_px);

  /// The intensity at a position in the label (mm, in the space of the mesh).
  double sample(Vec3 p) const;
  /// voxels; 0: the label holds no voxel's centre, the image is sampled as it is
  std::size_t used() const { return used_; }
  int eroded_px() const { return eroded_; }

 private:
  std::size_t at(int i, int j, int k) const { return (static_cast<std::size_t>(k) * size_[1] + j) * size_[0] + i; }
  Vec3 voxel(Vec3 p) const { return image_.voxel_of(in_space(p, space_, Space::lps)); }
  void mark_inside(const TetMesh& mesh, const std::vector<std::int32_t>& tets);
  void erode(int steps);
  void continue_outward();

  const IntensityVolume& image_;
  Space space_;                        // of the mesh
  std::array<int, 3> low_{}, size_{};  // the box of voxels around the label
  std::vector<std::uint8_t> state_;    // 0 outside, 1 has a value
  std::vector<float> value_;
  std::size_t used_ = 0;
  int eroded_ = 0;
};

}  // namespace stackmesh
