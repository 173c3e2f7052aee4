#pragma once
#include "model/tet_mesh.h"

namespace stackmesh {

/// The mesh with its tets grouped by ascending label (else in their order), without unused points, as a SolverModel wants it.
/// `faces` are dropped: they are made anew from the tets. @throws Error(internal) for an index without a point
TetMesh ordered_mesh(const TetMesh& mesh);

}  // namespace stackmesh
