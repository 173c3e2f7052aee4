#pragma once
#include <cstdint>
#include <vector>

#include "fem/inside_voxels.h"
#include "fem/material_law.h"

namespace stackmesh {

/// A law's value for each tet of a list: its mean over the element by numerical integration, finer where elements are
/// large against voxels; or the law's value at the element's mean intensity.
std::vector<ModulusLaw::Value> map_modulus(const TetMesh& mesh, const std::vector<std::int32_t>& tets,
                                           const InsideVoxels& voxels, double voxel_mm, const ModulusLaw& law,
                                           const MappingOptions& options);

}  // namespace stackmesh
