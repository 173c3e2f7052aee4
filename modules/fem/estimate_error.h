#pragma once
#include <string>
#include <vector>

#include "fem/recover_stress.h"

namespace stackmesh {

/// A set's stress on one mesh after the other, each with edges half as long.
struct SetAccuracy {
  std::string set;                          ///< name of the face set, as in the solver model
  std::vector<double> mises_rms_mpa;        ///< root mean square of the von Mises stress over its area, a mesh each
  std::vector<double> mises_max_mpa;        ///< largest von Mises stress at a corner, a mesh each
  std::vector<double> displacement_max_mm;  ///< largest displacement of a node, a mesh each
  double mises_extrapolated_mpa = 0;        ///< what the root mean square tends to, by Richardson
  /// of convergence: as observed on three meshes, else that of the elements' stress
  double order = 0;
  double error_rel = 0;               ///< of the last mesh's root mean square, against the extrapolated one
  double displacement_error_rel = 0;  ///< of its largest displacement, likewise
  double zz_rel = 0;                  ///< of the last mesh
  bool held = false;                  ///< its error does not count: stress is often singular where a support ends
};

/// How accurate a solution is, as a sequence of meshes shows it.
struct Accuracy {
  std::vector<SetAccuracy> sets;  ///< those that all meshes have, in the order of the last one; none of one mesh alone
  std::vector<double> zz_rel;     ///< of the whole, a mesh each
  double error_rel = 0;           ///< largest of the sets that count, of stress and displacement
  std::string worst_set;          ///< that error_rel is of; "": no set counts
};

/// Richardson's estimate for every set that all meshes have. A set's error is relative to its own stress, but to no
/// less than a twentieth of the body's, so that places without stress do not decide.
/// @param measures two or three, the coarsest first
/// @param order of the elements: their stress converges with it
Accuracy estimate_error(const std::vector<StressMeasure>& measures, int order);

}  // namespace stackmesh
