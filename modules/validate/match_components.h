#pragma once
// Private to the module: which piece of the mesh stands for which component of the input.
#include <cstdint>
#include <vector>

#include "model/complex.h"
#include "validate/boundaries.h"
#include "validate/check_fidelity.h"
#include "validate/grid_walk.h"
#include "validate/label_runs.h"

namespace stackmesh {

/// Fills in the components of each row: how many there are in the input and the mesh, which are missing, which shrunk
/// until they cover no voxel centre, whether they match one to one, and where those lie that do not. A component that a
/// piece joined to others is not missing, even where the piece leaves its voxel centres out.
/// @param points of the complex along W, U, V (LabelRuns::to_grid)
/// @param row_label index into the volume's labels for each row of the boundaries, or -1
void match_components(const LabelRuns& runs, const InterfaceComplex& complex, const std::vector<Vec3>& points,
                      const Boundaries& boundaries, const GridWalk& walk, const std::vector<std::int32_t>& row_label,
                      std::vector<LabelFidelity>& rows);

}  // namespace stackmesh
