#pragma once
#include "model/tet_mesh.h"

namespace stackmesh {

/// The mesh with its tets grouped by ascending label (else in their order), without unused points, as a SolverModel
/// wants it. Of `faces` those stay whose corners are all there; they are made anew from the tets once the voids behind
/// them are known. @throws Error(internal) for an index without a point
TetMesh ordered_mesh(const TetMesh& mesh);

}  // namespace stackmesh
