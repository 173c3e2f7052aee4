#pragma once
#include <vector>

#include "model/complex.h"
#include "model/label_volume.h"

namespace stackmesh {

/// How far each point of a complex, in mm of the volume's own world frame (LPS), is from the voxel faces of the
/// labels that its triangles bound, mm: the largest over those labels. 0 for points of no triangle and for labels
/// that the volume does not have. The result does not depend on `threads` (0: all of the machine).
/// @throws Error(usage) for a wrong axis.
std::vector<float> vertex_distances(const InterfaceComplex& complex, const LabelVolume& volume, int stack_axis,
                                    int threads);

}  // namespace stackmesh
