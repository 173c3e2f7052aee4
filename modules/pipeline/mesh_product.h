#pragma once
#include "pipeline/input.h"
#include "pipeline/mesh_run.h"

namespace stackmesh {

/// LPS to RAS turns half a revolution about z: exact, and triangles keep their sense.
void to_ras(std::vector<Vec3>& points);

/// What a ModelStage gets: the mesh in the world, turned to RAS where that is asked for.
/// @param up the stacking axis, LPS
MeshProduct make_product(TetMesh mesh, const Input& input, Vec3 up, WorldSpace world);

}  // namespace stackmesh
