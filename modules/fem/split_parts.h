#pragma once
#include <cstdint>
#include <vector>

#include "model/tet_mesh.h"

namespace stackmesh {

/// Gives each part its own copy of every node that several parts share; within a part nodes stay shared. The part with
/// the smallest number keeps the original.
/// @param mesh gets the copies behind its points, mid-side nodes too; its elements then name them
/// @param part_of one number from 0 per tet
/// @return for each node of the new mesh the node that it was
std::vector<std::int32_t> split_parts(TetMesh& mesh, const std::vector<int>& part_of);

/// The other way round: nodes of exactly equal coordinates become one, the first of them.
/// @return how many nodes became another; 0: the mesh is as it was. Points may be left unused.
std::size_t join_equal_nodes(TetMesh& mesh);

}  // namespace stackmesh
