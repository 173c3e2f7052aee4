#pragma once
#include <cstddef>

#include "enhance/complex_mesh.h"

namespace stackmesh {

struct RidgeOptions {
  double feature_deg = 70;  ///< edges at which a sheet bends by more may be ridges,
  double length_mm = 8;     ///< in straight chains of that length (shorter ones are the voxels' steps)
  /// Edges that run steeply from section to section, where sections were drawn: a corner of the outlines. 0: as all
  /// others.
  double upright_deg = 0;
  double upright_length_mm = 8;  ///< or from one flat cap to another
  double upright_reach_mm = 1;   ///< how far to either side of such an edge the bend must be seen
  int threads = 0;
};

/// Makes curves of sharp edges that form straight chains. @return edges that became ridges.
std::size_t mark_ridges(ComplexMesh& mesh, const RidgeOptions& options);

}  // namespace stackmesh
