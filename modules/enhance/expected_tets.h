#pragma once
// Private to the module: how many tetrahedra a choice of edge lengths means.
#include <map>
#include <vector>

#include "enhance/complex_mesh.h"

namespace stackmesh {

/// Tetrahedra that the sizes mean: a layer under each label's triangles, and what a thick label holds below it.
struct ExpectedTets {
  double layer = 0, depth = 0;
  /// With all sizes this many times as long.
  double at(double longer) const { return layer / (longer * longer) + depth / (longer * longer * longer); }
  /// By what the sizes have to be multiplied for as many tetrahedra as the target says.
  double times_longer_for(double target) const;
};

/// @param size edge length at each vertex, mm; @param volumes_mm3 of the labels
ExpectedTets expected_tets(const ComplexMesh& mesh, const std::vector<double>& size,
                           const std::map<Label, double>& volumes_mm3);

}  // namespace stackmesh
