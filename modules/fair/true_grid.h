#pragma once
#include <array>
#include <optional>
#include <string>

#include "model/label_volume.h"

namespace stackmesh {

/// The grid on which labels were made, where they are stored on a finer one.
struct TrueGrid {
  /// stored voxels along each axis of the volume in one voxel as made
  std::array<double, 3> stored_per_voxel = {1, 1, 1};
  LabelVolume volume;  ///< the labels on the grid on which they were made
};

/// Recognises labels that are stored finer than they were made: blocks of equal voxels at any phase, as networks for
/// segmentation leave them when they work on a coarse grid, or nearest-neighbour resampling by any ratio. Each axis is
/// looked at on its own: neighbouring planes differ only where a true voxel ends. Only clear cases count: at least six
/// planes that differ, all of them at the ends of blocks, and most ends of blocks among them.
/// @return nothing where the labels are as fine as they are stored.
std::optional<TrueGrid> find_true_grid(const LabelVolume& volume, int threads);

/// What to say of labels that were taken from a grid finer than theirs; sizes of a voxel, mm.
std::string true_grid_warning(const std::array<double, 3>& stored_mm, const std::array<double, 3>& made_mm);

}  // namespace stackmesh
