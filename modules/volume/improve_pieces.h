#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "model/tet_mesh.h"
#include "volume/improve_mesh.h"

namespace stackmesh::volume {

/// Cuts the tets into `count` pieces of about the same number, by planes across the axes. A power of two.
std::vector<std::int32_t> cut_into_pieces(const TetMesh& mesh, int count);

/// The tets around marked points and those around these, `rings` times; what hangs together in a point is one piece,
/// counted from 0. -1 for all others.
std::vector<std::int32_t> grow(const TetMesh& mesh, std::vector<char> marked, int rings, std::size_t* count);

/// Changes pieces of a mesh on their own, side by side. `piece` tells each tet's, -1 for tets that stay. Points before
/// `kept` and points that a tet outside of the piece has, too, stay; so the pieces fit together again. Points and tets
/// are numbered anew, those that stay first; the result does not depend on the number of threads.
///
/// @return a mark for each point that tets of different pieces share
std::vector<char> change_pieces(TetMesh& mesh, std::size_t kept, const std::vector<std::int32_t>& piece,
                                std::size_t count, int threads,
                                const std::function<void(std::size_t, ImproveMesh&)>& change);

}  // namespace stackmesh::volume
