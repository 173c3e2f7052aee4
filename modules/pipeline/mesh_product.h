#pragma once
#include <optional>
#include <vector>

#include "fem/name_sets.h"
#include "meshio/write_mesh.h"
#include "model/label_volume.h"
#include "model/tet_mesh.h"

namespace stackmesh {

/// A verified volume mesh and where it lies; coordinates are those that will be written.
struct MeshProduct {
  TetMesh mesh;                   ///< faces on a void have its label on their open side
  std::vector<LabelInfo> labels;  ///< voids too
  WorldSpace space = WorldSpace::lps;
  Vec3 up = {0, 0, 1};            ///< stacking axis, from the first slice to the last
  std::optional<ImageBox> image;  ///< of a label volume
};

/// LPS to RAS turns half a revolution about z: exact, and triangles keep their sense.
void to_ras(std::vector<Vec3>& points);

/// @param mesh in LPS, or without anatomy
/// @param volume the labels' grid; null for contours
MeshProduct mesh_product(TetMesh mesh, std::vector<LabelInfo> labels, WorldSpace space, Vec3 up, const LabelVolume* volume);

}  // namespace stackmesh
