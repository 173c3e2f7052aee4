#pragma once
#include <cstddef>
#include <functional>
#include <vector>

#include "base/monitor.h"
#include "enhance/complex_mesh.h"
#include "enhance/reference.h"

namespace stackmesh {

struct RemeshOptions {
  int rounds = 4;               ///< of split, collapse, flip, relocate
  int fit_passes = 6;           ///< of the least-squares fit to the reference
  int finish_sweeps = 6;        ///< over the worst triangles
  double good_angle_deg = 32;   ///< triangles below are worked on at the end
  int mend_sweeps = 8;          ///< by stronger means
  double mend_angle_deg = 26;   ///< over those below
  double sheet_angle_deg = 20;  ///< angles between sheets are kept above ("not below, and not worse")
  double clearance_rel = 0.1;   ///< of the edge length: sheets come no closer
  double deviation_rel = 0.15;  ///< of the edge length: how far a collapse or flip may leave the surface
  double deviation_mm = 0;      ///< where the reference is further from the mesh, edges get shorter; 0: nowhere
  double shortest_mm = 0;       ///< but not below this
  /// edges that get shorter for the deviation all get longer again beyond it; 0: no limit
  double most_triangles = 0;
  double gradation = 1.3;
  int threads = 0;
  std::function<void()> when_coarse;  ///< is called once, before the rounds: it may move vertices of the mesh
};

struct RemeshCounts {
  std::size_t splits = 0, collapses = 0, flips = 0, relocations = 0;
  std::size_t refused_contact = 0, refused_angle = 0, refused_clearance = 0;  ///< by the guard
};

/// Remeshes to the edge length requested at every vertex (\cite frey1998): edges above sqrt 2 of it
/// are split, below 1 / sqrt 2 collapsed, with flips and relocation on the reference after each; then the
/// worst triangles are worked on. Every operation is tested exactly against the whole complex before it is
/// committed. `size` follows the vertices.
RemeshCounts remesh(ComplexMesh& mesh, std::vector<double>& size, const Reference& reference,
                    const RemeshOptions& options, Monitor& progress);

}  // namespace stackmesh
