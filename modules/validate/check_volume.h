#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/tet_mesh.h"

namespace stackmesh {

/// The tets of one label.
struct LabelTets {
  Label label = 0;
  std::size_t tets = 0;
  double volume_mm3 = 0;  ///< signed
};

/// What a tetrahedral mesh is like; measures of an empty one are 0.
struct VolumeCheck {
  std::size_t nodes = 0, tets = 0;
  std::size_t inverted = 0;  ///< tets whose exact orientation is not positive
  double dihedral_min_deg = 0, dihedral_p1_deg = 0,
         dihedral_max_deg = 0;        ///< p1: of the smallest dihedral per tet
  std::size_t dihedral_below_10 = 0;  ///< tets whose smallest dihedral is below 10 degrees
  double radius_edge_max = 0;         ///< circumradius over shortest edge; infinite for a flat tet
  double scaled_jacobian_min = 0;  ///< sqrt 2 * determinant over the largest product of three edges at a node
  std::vector<LabelTets> labels;   ///< ascending
  /// The faces between tets of different labels (0 outside) are exactly mesh.faces, with their labels on the
  /// right sides; each face is shared by at most two tets, one on either side; nothing is there twice.
  bool conforms = false;
  std::size_t nonconforming_faces = 0;
  std::vector<std::array<std::int32_t, 3>> nonconforming_list;  ///< the first 1000, ascending point numbers
};

struct VolumeCheckOptions {
  int threads = 0;                ///< 0: all of the machine; the result does not depend on it
  std::size_t list_limit = 1000;  ///< longest list of faces
};

/// Judges a mesh of linear tets. @throws Error(input) for an index without a point, labels that do not match
/// the tets, or a coordinate that is not finite.
VolumeCheck check_volume(const TetMesh& mesh, const VolumeCheckOptions& options = {});

}  // namespace stackmesh
