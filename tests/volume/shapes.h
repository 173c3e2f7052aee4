#pragma once
#include <functional>
#include <map>

#include "model/complex.h"
#include "model/tet_mesh.h"

namespace stackmesh::shapes {

/// The boundary of a label array: `label(i, j, k)` for 0 <= i < nx ...; outside is the background. Every face
/// between two labels becomes two triangles; corners are shared.
InterfaceComplex voxels(int nx, int ny, int nz, Vec3 spacing, const std::function<Label(int, int, int)>& label);

/// Adds one triangle pair a, b, c, d (counter-clockwise seen from `above`).
void add_quad(InterfaceComplex& complex, int a, int b, int c, int d, Label below, Label above);

/// Adds the surface of an axis-aligned box full of `inside` within `outside`, with its own eight corners.
void add_box(InterfaceComplex& complex, Vec3 low, Vec3 high, Label inside, Label outside = 0);

/// An icosahedron, each triangle cut in four `levels` times, with its corners on a sphere about the origin.
InterfaceComplex sphere(int levels, double radius, Label inside = 1, Label outside = 0);

std::map<Label, double> volumes(const TetMesh& mesh);

/// Checks what a filled mesh must be, sharing no code with what is tested: points kept to the bit, all tets
/// positive, tet faces in pairs except where the complex's triangles bound a label, labels as the triangles
/// say. Reports through GoogleTest.
void expect_fills(const TetMesh& mesh, const InterfaceComplex& complex);

}  // namespace stackmesh::shapes
