#pragma once
#include <cstddef>

#include "enhance/complex_mesh.h"

namespace stackmesh {

/// Makes curves of the edges at which a sheet bends by more than `feature_deg`, where they form straight
/// chains of at least `length_mm` (shorter ones are the voxels' steps). @return edges that became ridges.
std::size_t mark_ridges(ComplexMesh& mesh, double feature_deg, double length_mm, int threads);

}  // namespace stackmesh
