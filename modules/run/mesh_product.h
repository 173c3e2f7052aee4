#pragma once
#include <optional>
#include <vector>

#include "fem/name_sets.h"
#include "model/label_volume.h"
#include "model/tet_mesh.h"

namespace stackmesh {

/// A verified volume mesh and where it lies, all in the space of the mesh, that which will be written.
struct MeshProduct {
  TetMesh mesh;                   ///< faces on a void have its label on their open side
  std::vector<LabelInfo> labels;  ///< voids too
  Vec3 up = {0, 0, 1};            ///< stacking axis, from the first slice to the last
  std::optional<ImageBox> image;  ///< of a label volume
};

/// Brings a mesh, its stacking axis and the box of its image into the space that is written.
/// @param mesh in LPS, or without anatomy
/// @param labels numbers and names of all that are meshed, voids too
/// @param to the space that is written
/// @param up unit vector along the stacking axis, in the space of `mesh`
/// @param volume the labels' grid; null for contours
MeshProduct mesh_product(TetMesh mesh, std::vector<LabelInfo> labels, Space to, Vec3 up, const LabelVolume* volume);

}  // namespace stackmesh
