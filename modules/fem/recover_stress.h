#pragma once
#include <string>
#include <vector>

#include "model/solver_model.h"

namespace stackmesh {

/// What a solution says on the faces of a set.
struct SetStress {
  std::string set;                 ///< name of the face set, as in the solver model
  double mises_rms_mpa = 0;        ///< root of the mean square over its area
  double mises_max_mpa = 0;        ///< at corners
  double displacement_max_mm = 0;  ///< of its nodes
  /// \cite zienkiewicz1987, energy norm of (recovered - element's stress) over that of the stress, in the elements
  /// behind its faces
  double zz_rel = 0;
  bool held = false;  ///< all of its nodes are held or moved by the first static step
};

/// What a solution says of a model as a whole and of its sets.
struct StressMeasure {
  std::vector<SetStress> sets;  ///< those with faces, in the model's order
  double zz_rel = 0;            ///< of all elements
  double mises_rms_mpa = 0;     ///< over all elements
};

/// Stress out of the displacements of a model's nodes (small strain, linear isotropic materials), recovered at the
/// corners as the mean, by volume, of what the elements of one label around them say: stress may jump between labels.
/// `zienkiewicz1987`
/// @throws Error(usage) for a material that is not linear isotropic
StressMeasure recover_stress(const SolverModel& model, const std::vector<Vec3>& displacement_mm);

}  // namespace stackmesh
