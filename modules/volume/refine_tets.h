#pragma once
#include "model/tet_mesh.h"

namespace stackmesh {

/// Cuts every tet into eight, and every interface triangle into four, `times` times over. The order is kept, and so is
/// the shape: a straight side stays where it is, a curved one (of second order) too, since its halves are pieces of the
/// same parabola. The octahedron in a tet's middle is cut along its shortest diagonal. Old points keep their numbers;
/// the new ones follow.
TetMesh refine_tets(TetMesh mesh, int times);

/// The interface triangles of a mesh with the points that they use.
InterfaceComplex surface_of(const TetMesh& mesh);

}  // namespace stackmesh
