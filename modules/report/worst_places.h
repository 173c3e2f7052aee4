#pragma once
#include <string>
#include <vector>

#include "model/complex.h"
#include "model/tet_mesh.h"

namespace stackmesh {

/// A place worth looking at: the element with a bad figure.
struct WorstPlace {
  std::string kind;   ///< "angle", "dihedral" or "distance"
  double figure = 0;  ///< degrees or mm
  Vec3 at_mm;
  std::vector<Vec3> corners_mm;  ///< of the triangle or tet; the one vertex
  std::vector<Label> labels;
};

/// Up to `most` places of each kind, worst first: narrow triangles, tets with a small dihedral angle, vertices far
/// from the voxel boundary (one distance per point, or none). Places closer than `apart_mm` to a worse one of
/// their kind are left out.
std::vector<WorstPlace> find_worst_places(const InterfaceComplex& complex, const TetMesh* mesh,
                                          const std::vector<float>& distances_mm, std::size_t most, double apart_mm);

}  // namespace stackmesh
