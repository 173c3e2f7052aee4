#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "model/complex.h"
#include "model/tet_mesh.h"
#include "validate/verdict.h"

namespace stackmesh {

/// What is listed as a defect.
struct DefectOptions {
  /// longest list of one kind, largest first; the text of the last says how many there are
  std::size_t most_of_a_kind = 100;
  double poor_angle_deg = 10;    ///< triangles below are listed
  double poor_dihedral_deg = 8;  ///< tets below are listed
  /// Slice of the input nearest to a point, from 0; unset: no sections are told.
  std::function<std::optional<int>(const Vec3&)> section_of;
};

/// Finds where a mesh fails: holes (open edges joined to loops), triangles turned against their neighbours,
/// crossings (pairs joined to places), inverted tets, faces that do not conform, parts without counterpart, labels that
/// lie in another one's place, the worst elements. Largest first within a kind. `mesh` and `fidelity` may be null;
/// `surface` must come from check_surface of `complex` with a list_limit that holds what is to be located.
std::vector<Defect> find_defects(const InterfaceComplex& complex, const SurfaceCheck& surface, const TetMesh* mesh,
                                 const VolumeCheck* volume, const std::vector<LabelFidelity>* fidelity,
                                 const DefectOptions& options = {});

/// The triangles (tets by their faces) that defects name, for a file beside the report; `label` of each is the
/// number of its defect, from 1.
InterfaceComplex defect_triangles(const InterfaceComplex& complex, const TetMesh* mesh,
                                  const std::vector<Defect>& defects);

}  // namespace stackmesh
