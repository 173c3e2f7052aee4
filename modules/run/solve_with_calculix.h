#pragma once
#include <vector>

#include "meshio/write_mesh.h"
#include "model/solver_model.h"

namespace stackmesh {

/// Whether `ccx` can be started.
bool has_calculix();

/// Lets CalculiX solve a model, in a folder of its own that goes afterwards.
/// @param timeout_s after which it is ended
/// @return the displacement of each node, mm, at the end of the last step
/// @throws Error(no_result) where CalculiX fails or takes longer, with its last words
std::vector<Vec3> solve_with_calculix(const SolverModel& model, const MeshWriteOptions& write, int threads,
                                      double timeout_s);

}  // namespace stackmesh
