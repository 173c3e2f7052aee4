#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/warning.h"
#include "model/geometry.h"

namespace stackmesh {

/// A label of the input: its own number, its name ("" when the input has none), its colour if the input carries one.
struct LabelInfo {
  Label number = 0;                                                  ///< as the input has it
  std::string name;                                                  ///< "": none
  std::optional<std::array<std::uint8_t, 3>> colour = std::nullopt;  ///< red, green, blue
};

/// A stack of label slices on a regular grid. `voxels` holds indices into `labels`, so that any label number
/// costs two bytes a voxel; labels[0] is always the background, the others ascend by number.
struct LabelVolume {
  std::array<int, 3> size = {0, 0, 0};                                       ///< voxels along x (fastest), y, z
  std::array<double, 3> spacing_mm = {1, 1, 1};                              ///< > 0
  Vec3 origin_mm;                                                            ///< centre of voxel (0, 0, 0), LPS
  std::array<Vec3, 3> axes = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  ///< orthonormal, LPS
  /// false: no anatomy is known (PNG stacks); coordinates as they are
  bool anatomical = true;
  /// along each axis the image goes on before the first voxel (of a cropped grid): that is not its border
  std::array<bool, 3> goes_on_low = {false, false, false};
  std::array<bool, 3> goes_on_high = {false, false, false};  ///< the same behind the last voxel
  std::vector<std::uint16_t> voxels;                         ///< size[0] * size[1] * size[2], indices of `labels`
  std::vector<LabelInfo> labels;                             ///< labels[0] is {0, ""}
  /// "nifti", "nrrd", "seg.nrrd", "metaimage", "gipl", "slices", "masks", "dicom", "dicomseg"
  std::string kind;
  std::vector<Warning> warnings;  ///< what reading found odd but could mend

  /// Place of voxel (i, j, k) in `voxels`.
  std::size_t index(int i, int j, int k) const { return (static_cast<std::size_t>(k) * size[1] + j) * size[0] + i; }
  Space space() const { return anatomical ? Space::lps : Space::none; }  ///< of world()
  /// Of one voxel.
  double voxel_volume_mm3() const { return spacing_mm[0] * spacing_mm[1] * spacing_mm[2]; }
  /// World position (LPS, mm) of a continuous voxel index.
  Vec3 world(double i, double j, double k) const {
    return origin_mm + (i * spacing_mm[0] * axes[0] + j * spacing_mm[1] * axes[1] + k * spacing_mm[2] * axes[2]);
  }
};

/// Whether double precision can tell the voxels of a grid apart, and areas and volumes of it can be calculated: voxels
/// of 1e-12 to 1e12 mm, whose origin is at most 1e14 times the smallest of these sizes away.
/// @param spacing_mm size of a voxel along each axis
/// @param origin_mm centre of the first voxel, world
/// @param name what the error calls the volume, usually its path
/// @throws Error(input)
void check_grid(const std::array<double, 3>& spacing_mm, Vec3 origin_mm, const std::string& name);

/// Whether a volume is as its comments above say: as many voxels as the size asks for, each with an entry in `labels`,
/// spacing above 0, orthonormal axes, labels that ascend behind the background, and a voxel that is not background.
/// @param volume as a caller has filled it in
/// @param name what the error calls it
/// @throws Error(input) naming what is not so
void check_label_volume(const LabelVolume& volume, const std::string& name);

/// A volume of label numbers, x fastest, 0 for the background; place and names are set afterwards.
/// @throws Error(input) for negative labels, for more than 65,535 of them, or where numbers and size do not match
LabelVolume volume_of_labels(const std::vector<Label>& numbers, const std::array<int, 3>& size,
                             const std::array<double, 3>& spacing_mm);

/// The same labels, place and grid, without the voxels: what begins a volume on another grid.
LabelVolume without_voxels(const LabelVolume& volume);

/// Voxels of each entry of volume.labels.
std::vector<std::size_t> count_voxels(const LabelVolume& volume);

/// Keeps the labels at the given indices of volume.labels; the others become background. With `merge` the kept
/// ones become one label, numbered as the smallest.
LabelVolume select_labels(LabelVolume volume, const std::vector<std::size_t>& keep, bool merge);

}  // namespace stackmesh
