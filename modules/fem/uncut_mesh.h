#pragma once
#include <cstdint>
#include <vector>

#include "fem/boundary_faces.h"
#include "model/tet_mesh.h"

namespace stackmesh {

/// The mesh that refine_tets() cut into eight, once: so that a set is the same piece of the surface however often the
/// mesh is cut.
/// @param mesh the eight tets cut from one stand together, first those at its corners 0 to 3, and so do the four
/// triangles cut from one of `faces`; linear or second order
/// @return its points are those of `mesh`, of which it does not use all @throws Error(internal) when the mesh was not
/// made so
TetMesh uncut_mesh(const TetMesh& mesh);

/// For each boundary face of a mesh the place, in the list of the uncut mesh's boundary faces, of that which it was cut
/// from.
std::vector<std::int32_t> uncut_faces(const TetMesh& mesh, const std::vector<BoundaryFace>& faces,
                                      const std::vector<BoundaryFace>& uncut);

}  // namespace stackmesh
