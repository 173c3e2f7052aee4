#pragma once
#include <array>
#include <optional>
#include <string>

#include "model/label_volume.h"

namespace stackmesh {

/// What the user can say about an input that does not say it itself.
struct ReadOptions {
  /// Voxel size x, y, z in mm of a stack of PNG/TIFF slices; default: 1 x 1 x 1 with a warning. A volume file
  /// carries its own, so giving it there is an error.
  std::optional<std::array<double, 3>> spacing_mm;
  /// "Heart,Lt_Lung": priority where segments overlap; others may be left out. Default: all, smaller ones first
  std::string labels;
  bool allow_outside = false;  ///< a detached header may name data files outside of its folder
  std::string series;          ///< series instance UID where a DICOM folder holds several; default: it must hold one
};

/// Reads labels from a volume (.nii .nii.gz .nrrd .nhdr .mha .mhd .gipl .gipl.gz), a segmentation of 3D Slicer
/// (.seg.nrrd), a DICOM SEG, a DICOM series of whole numbers (its folder, or a file of it), from a folder or a quoted
/// glob of PNG/TIFF label slices (natural order of names), or from a folder or glob of one mask volume per
/// structure (names become labels 1..N in natural order; the first wins where they overlap).
/// @return grid and directions in LPS mm as the file gives them (oblique and left-handed too; slices have no
///   anatomy: identity), at least one voxel that is not background; oddities that could be mended are in
///   `warnings`.
/// @throws Error(input) naming the file when it is missing, damaged, no label image, or its grid is not
/// rectangular.
LabelVolume read_label_volume(const std::string& path, const ReadOptions& options = {});

}  // namespace stackmesh
