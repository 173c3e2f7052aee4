#pragma once
#include <string>
#include <vector>

#include "fem/recover_stress.h"

namespace stackmesh {

/// A set's stress on one mesh after the other, each with edges half as long.
struct SetAccuracy {
  std::string set;
  std::vector<double> mises_rms_mpa, mises_max_mpa, displacement_max_mm;  ///< a mesh each
  double mises_extrapolated_mpa = 0;  ///< what the root mean square tends to, by Richardson
  /// of convergence: as observed on three meshes, else that of the elements' stress
  double order = 0;
  double error_rel = 0;               ///< of the last mesh's root mean square, against the extrapolated one
  double displacement_error_rel = 0;  ///< of its largest displacement, likewise
  double zz_rel = 0;                  ///< of the last mesh
  bool held = false;                  ///< its error does not count: stress is often singular where a support ends
};
struct Accuracy {
  std::vector<SetAccuracy> sets;
  std::vector<double> zz_rel;  ///< of the whole, a mesh each
  double error_rel = 0;        ///< largest of the sets that count, of stress and displacement
  std::string worst_set;
};

/// Richardson's estimate for every set that all meshes have. A set's error is relative to its own stress, but to no
/// less than a twentieth of the body's, so that places without stress do not decide.
/// @param measures two or three, the coarsest first
/// @param order of the elements: their stress converges with it
Accuracy estimate_error(const std::vector<StressMeasure>& measures, int order);

}  // namespace stackmesh
