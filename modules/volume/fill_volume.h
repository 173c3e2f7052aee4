#pragma once
#include <atomic>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/warning.h"
#include "model/complex.h"
#include "model/tet_mesh.h"

namespace stackmesh {

/// How the complex is filled.
struct FillOptions {
  std::optional<double> max_volume_mm3;  ///< largest tetrahedron, mm3; unset: no bound (graded)
  /// of the tetrahedra of a label, in place of max_volume_mm3 and inner_growth
  std::map<Label, double> label_max_volume_mm3;
  std::optional<double> radius_edge;   ///< largest circumradius / shortest edge, before improvement; a target. Unset
                                       ///< together with dihedral_deg, inner_growth and max_volume_mm3: no refinement
  std::optional<double> dihedral_deg;  ///< smallest dihedral angle that TetGen refines for, degrees; a target
  std::optional<double> inner_growth;  ///< edges inside are about this times those of the nearby surface; a target
  /// then tets with a dihedral angle below it are improved; unset: as TetGen gives them
  std::optional<double> improve_deg;
  /// false: surfaces that the complex does not have lie there; then points of its outer faces do not move
  bool outside_is_empty = true;
  int threads = 0;         ///< 0: all of the machine; the result does not depend on it
  double timeout_s = 600;  ///< of all worker runs together, seconds
  /// soon after it becomes true the filling ends, as timed_out; unset: never
  const std::atomic<bool>* given_up = nullptr;
  bool known_sound = false;  ///< the complex was shown to have no intersections: after a refusal TetGen
                             ///< does not look for them (that search is slow)
  /// the program stackmesh-tetgen; empty: the environment's STACKMESH_WORKER, else beside this program or library, or
  /// where it was installed
  std::string worker_path;
  std::vector<std::string> worker_args = {"--tetgen-worker"};
};

/// About how many tets fill_volume() would make, from the areas of the surface and the volumes of the labels.
double estimate_tets(const InterfaceComplex& complex, const FillOptions& options);

/// Mean thickness of the labels, twice their volume over the area of their surfaces, in mean lengths of the surface's
/// edges (weighted by area). Below 1 the labels are plates and walls thinner than their triangles are long.
double thickness_in_edges(const InterfaceComplex& complex);

/// What came of it. Only `verified` carries a mesh.
struct FillResult {
  enum class Status {
    verified,        ///< filled; labels, faces, orientation and volumes were checked
    refused,         ///< the complex is not closed, intersects itself, or TetGen gave no mesh that holds it
    timed_out,       ///< the worker took too long and was ended
    crashed,         ///< the worker could not be started, or died without saying why
    empty,           ///< nothing to fill, or TetGen succeeded without a single tetrahedron
    volume_mismatch  ///< a label's tetrahedra do not have the volume that its surface encloses
  };
  Status status = Status::refused;
  std::string message;            ///< one line: what filled it, or why nothing did
  std::string fallback;           ///< one line: what was tried before in vain; empty when the first attempt succeeded
  std::vector<Warning> warnings;  ///< a worker that was killed from outside and started again
  /// the complex's points come first, bit-identical but for `moved_points`; points added inside follow
  TetMesh mesh;
  /// points of the complex that improving the tets moved a little (improve_deg; relax_surface.h), ascending
  std::vector<std::int32_t> moved_points;
  std::vector<std::int32_t> offending_triangles;  ///< indices into complex.triangles, ascending: where it was refused
};

/// Fills every label of a closed complex with tetrahedra that keep all of its triangles; the background is
/// left out. TetGen (\cite si2015) does it in a worker process with a timeout, boundary preserved (-pY). What
/// comes back is improved if that is requested, and then checked: each tet's label is flooded from the facets' (below,
/// above), and the volumes per label compared.
///
/// A refinement that fails falls back to plain filling, and a refusal is tried again with smaller tolerances
/// and other scales of z; the message says so. Points of the complex at one place count as one: tets and
/// faces then name the first of them.
///
/// @param complex closed, in stack coordinates (z is the stacking axis), mm
/// @throws Error(internal) when a triangle names a point that is not there or a coordinate is not finite,
/// Error(usage)
///         when an option is not positive
FillResult fill_volume(const InterfaceComplex& complex, const FillOptions& options = {});

}  // namespace stackmesh
