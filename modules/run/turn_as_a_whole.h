#pragma once
#include <string>
#include <vector>

#include "model/complex.h"
#include "model/tet_mesh.h"

namespace stackmesh {

/// Some programs number a tet's nodes the other way, or let normals point inwards; a mirrored frame does the same. What
/// is the same everywhere is no defect: tets, their triangles, or a surface without tets are turned round as a whole
/// where most of them are. With tets the surface becomes their faces, and so do their triangles unless they have some
/// of their own.
/// @return what was turned, for a warning
std::vector<std::string> turn_as_a_whole(InterfaceComplex& surface, TetMesh& tets, bool has_faces);

}  // namespace stackmesh
