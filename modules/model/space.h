#pragma once
#include "model/complex.h"
#include "model/geometry.h"
#include "model/tet_mesh.h"

namespace stackmesh {

/// A point or direction of one world frame in another. LPS and RAS differ by half a revolution about z, which is exact
/// and turns no triangle round; coordinates without anatomy are taken as they are.
/// @throws Error(internal) for Space::stack, which only a Frame leads out of
Vec3 in_space(Vec3 p, Space from, Space to);

/// The same as a map.
Frame between(Space from, Space to);

/// Brings all points to another space and says so; where the map mirrors, triangles and elements are turned round.
/// @param complex whose points and `space` change
/// @param to the world frame that `frame` leads to, or another one
/// @param frame stack coordinates to the world; used of values in Space::stack only
void change_space(InterfaceComplex& complex, Space to, const Frame& frame = {});
/// The same for a volume mesh; where the map mirrors, its elements and interface triangles are turned round.
/// @param mesh whose points and `space` change
/// @param to the world frame that `frame` leads to, or another one
/// @param frame stack coordinates to the world; used of values in Space::stack only
void change_space(TetMesh& mesh, Space to, const Frame& frame = {});

}  // namespace stackmesh
