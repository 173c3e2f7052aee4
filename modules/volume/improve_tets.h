#pragma once
#include <cstddef>

#include "model/tet_mesh.h"
#include "volume/label_tets.h"

namespace stackmesh::volume {

struct ImproveOptions {
  double goal_deg = 24;  ///< tets with a dihedral angle below it (or, at the other end, above 180 - goal / 0.6) are worked on
  int passes = 10;       ///< at most
};

struct ImproveCounts {
  std::size_t moved = 0, edges = 0, faces = 0, collapsed = 0, inserted = 0;
  int passes = 0;
};

/// Improves the tets of a filled complex until the worst are gone or no change helps: points added inside move,
/// edges and faces are exchanged, points merged and inserted. Points before `kept`, and all of mesh.faces, stay as they
/// are. No change makes the worst of the tets that it touches worse, and each keeps all tets positive (exactly).
///
/// @return the tets as label_tets() takes them; mesh.points is replaced to fit, mesh.tets and labels too
RawTets improve_tets(TetMesh& mesh, std::size_t kept, const ImproveOptions& options, ImproveCounts& counts);

}  // namespace stackmesh::volume
