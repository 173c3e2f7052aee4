#pragma once
#include <cstdint>
#include <vector>

#include "contour/arcs.h"
#include "model/label_volume.h"

namespace stackmesh {

/// The volume's axes as the stack has them: in-plane x, in-plane y, stacking axis; always a cyclic permutation.
struct StackAxes {
  int u, v, w;
};
StackAxes axes_for(int stacking_axis);

/// The slices [first, last) along the stacking axis.
std::vector<Slice> read_slices(const LabelVolume& volume, const StackAxes& axes, int first, int last);

/// How many slices are best read at once: a cache line holds 32 voxels along x.
int slices_at_once(const LabelVolume& volume, const StackAxes& axes, int threads);

}  // namespace stackmesh
