#pragma once
#include <string>

#include "model/complex.h"
#include "model/label_volume.h"
#include "model/stack.h"

namespace stackmesh {

/// Where two sections lie more than 100 times as far apart as all of them are wide, what to say of it: no edge length
/// suits both the outlines and the walls between, so such a surface is not worth enhancing. Else "".
std::string far_sections(const Stack& stack, const InterfaceComplex& stitched);

/// The same of voxels that are 100 times as long along one axis as along another.
std::string long_voxels(const LabelVolume& volume);

}  // namespace stackmesh
