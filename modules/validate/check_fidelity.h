#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "model/complex.h"
#include "model/label_volume.h"

namespace stackmesh {

/// A distribution of distances, mm; NaN where there is nothing to measure.
struct Distance {
  double mean = 0;  ///< over the samples
  double p95 = 0;   ///< 95 % of the samples are nearer
  double max = 0;   ///< the largest one
};

/// How far a label's surface lies outside of its band: the cells between eight voxel centres that have a centre of the
/// label and one of something else. Every surface that separates the centres as the labels do, and lies no further from
/// them than it must, has distance 0 everywhere, be it stepped or smooth. NaN where there is nothing to measure.
struct BandDistance {
  double mean = 0;           ///< over points spread over the surface by area, mm; 0 for those inside
  double max = 0;            ///< over the same points, mm
  double outside_share = 0;  ///< of the points
};

/// A part of the input that the mesh lacks, or of the mesh that the input lacks.
struct UnmatchedPart {
  Vec3 where;              ///< its middle, in the volume's world frame, mm
  std::size_t voxels = 0;  ///< of a component of the input
  double volume_mm3 = 0;   ///< of its voxels, or that its surface encloses
  double size_mm = 0;      ///< largest extent along an axis of the grid
  int section = 0;         ///< nearest slice, from 0 along the stacking axis
};

/// How well a complex stands for one label of the input.
struct LabelFidelity {
  Label label = 0;                   ///< of the input
  std::size_t input_voxels = 0;      ///< voxel centres of the label in the input
  std::size_t mesh_voxels = 0;       ///< voxel centres of the grid that lie in the label in the mesh
  double dice = 0;                   ///< of those two sets; NaN when both are empty
  std::size_t wrong_centres = 0;     ///< voxel centres that are of the label in the input or in the mesh, not in both
  double wrong_centres_share = 0;    ///< of input_voxels; NaN when there are none
  BandDistance band_distance_mm;     ///< how far its surface lies outside of the band
  Distance distance_mm;              ///< in-plane voxel-face centres, at section heights, to the label's surface
  Distance reverse_distance_mm;      ///< points spread over the label's surface to its voxel faces
  std::size_t distance_samples = 0;  ///< points behind distance_mm
  std::size_t reverse_distance_samples = 0;  ///< points behind reverse_distance_mm and band_distance_mm
  int input_components = 0;                  ///< 6-connected components of the voxels
  int components = 0;                        ///< solid pieces of the mesh (see LabelSurface)
  /// Each input component shares correctly labelled voxel centres with exactly one solid piece, and each
  /// piece with exactly one component; or the piece's middle lies in one of its voxels (then it has shrunk).
  bool components_match = false;
  std::size_t missing_components = 0;    ///< input components that no piece stands for
  std::size_t shrunk_components = 0;     ///< those whose piece covers none of their voxel centres
  std::vector<UnmatchedPart> missing;    ///< missing components, largest first, at most 100
  std::vector<UnmatchedPart> unmatched;  ///< solid pieces that stand for no component, largest first, at most 100
  Label best_match = 0;                  ///< label of the input that the mesh's label covers best; 0: none
  double best_dice = 0;                  ///< with that one
  Vec3 middle;                           ///< of the mesh's voxel centres, world, mm
  /// Rigid shift of the mesh against the voxels along the volume's axes x, y, z, in voxels; none where the
  /// shape does not tell it (least squares over the distances of voxel faces, outliers left out).
  std::optional<Vec3> offset_voxels;
};

/// How fidelity is measured.
struct FidelityOptions {
  int threads = 0;                      ///< 0: all of the machine; the result does not depend on it
  int stack_axis = 2;                   ///< axis of the volume along which the sections are stacked: 0, 1 or 2
  std::size_t face_samples = 60000;     ///< about the most voxel faces a label is measured from
  std::size_t surface_samples = 60000;  ///< most points on a label's surface; four a triangle, at least 20,000
  std::uint64_t seed = 1;               ///< of the choice among too many voxel faces
  /// Distances of the voxel centres, along the volume's axes x, y, z, as wide as the cells of the band are taken, mm:
  /// for labels that are stored finer than they were made, those of the true voxels. For blocks of whole voxels the
  /// band is then exactly that of the blocks. Never below the spacing, which is the default.
  std::optional<std::array<double, 3>> band_mm;
};

/// Compares a complex, in mm of the volume's own world frame (LPS), with the labels it was made from; a row
/// for each label of the volume but the background, in their order. @throws Error(input) as check_surface
/// does; Error(usage) for a wrong axis.
std::vector<LabelFidelity> check_fidelity(const InterfaceComplex& complex, const LabelVolume& volume,
                                          const FidelityOptions& options = {});

}  // namespace stackmesh
