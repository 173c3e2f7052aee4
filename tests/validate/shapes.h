#pragma once
#include <vector>

#include "model/complex.h"
#include "model/label_volume.h"
#include "model/tet_mesh.h"

namespace stackmesh::test {

/// Adds the twelve triangles of an axis-parallel box of `label` in `outside`, with eight points of its own.
void add_box(InterfaceComplex& complex, Vec3 low, Vec3 high, Label label, Label outside = 0);
InterfaceComplex box(Vec3 low, Vec3 high, Label label);

/// Joins points with equal coordinates.
InterfaceComplex weld(const InterfaceComplex& complex);

/// A sphere of 20 * 4^level triangles.
InterfaceComplex icosphere(double radius, int level, Label label, Vec3 centre = {});

/// The faces between voxels of different labels of a volume, two triangles each, as a welded complex in world
/// mm.
InterfaceComplex voxel_surface(const LabelVolume& volume);

/// An all-background volume with entries for labels 1 .. labels.
LabelVolume empty_volume(int nx, int ny, int nz, int labels);
void fill(LabelVolume& volume, std::array<int, 3> low, std::array<int, 3> high, int label);

/// Two tets of labels 1 and 2 that share a face, and the seven faces of both.
TetMesh two_tets();

}  // namespace stackmesh::test
