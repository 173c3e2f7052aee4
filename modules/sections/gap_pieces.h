#pragma once
#include <vector>

#include "model/label_volume.h"
#include "model/stack.h"

namespace stackmesh {

/// The gaps between real slices in which the sections join, split, lose or add a 6-connected piece of a label, as the
/// pixel centres of their virtual slices tell. Ascending.
/// @param dense the volume with its virtual slices, `period` - 1 in each gap, from which the stack's sections were made
std::vector<int> gaps_with_other_pieces(const LabelVolume& dense, int stacking_axis, int period, const Stack& stack,
                                        int threads);

}  // namespace stackmesh
