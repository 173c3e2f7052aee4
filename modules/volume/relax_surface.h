#pragma once
#include <cstdint>
#include <vector>

#include "model/tet_mesh.h"

namespace stackmesh::volume {

/// Moves corners of the worst tets, points of the surface among them, by a small share of the edges about them, to
/// where the worst tet around each is best: narrow angles between kept triangles cannot be mended by points inside
/// alone.
///
/// All tets stay positive (exactly), so that no interface between labels can cross another one. Where the outside
/// begins, a point moves inwards, or less far than other outer faces are away. No label's volume changes by more than a
/// thousandth. Points of faces square to the z axis that border the outside (flat ends) stay.
///
/// @param kept points before it are of the surface; those added inside follow
/// @param goal_deg tets with dihedral angles below it are worked on (the other end as in tet_quality), the worst
/// hundred or one in a thousand at most
/// @param outer false: points where the outside begins stay, as faces that the mesh does not have may lie there
/// @return the points before `kept` that moved, ascending
std::vector<std::int32_t> relax_surface(TetMesh& mesh, std::size_t kept, double goal_deg, bool outer);

}  // namespace stackmesh::volume
