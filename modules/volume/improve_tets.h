#pragma once
#include <chrono>
#include <cstddef>

#include "model/tet_mesh.h"

namespace stackmesh::volume {

struct ImproveOptions {
  /// tets with a dihedral angle below it (or, at the other end, above 180 - goal / 0.6) are worked on
  double goal_deg = 24;
  int passes = 10;  ///< at most
  int threads = 0;  ///< 0: all of the machine; the result does not depend on it
  /// then the mesh is left as it is by then
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
};

struct ImproveCounts {
  std::size_t moved = 0, edges = 0, faces = 0, collapsed = 0, inserted = 0, searched = 0;
  std::size_t steps = 0;  ///< how often a bad tet was worked on, in vain or not: what the improvement costs
  int passes = 0;
};

/// Improves the tets of a filled complex until the worst are gone or no change helps: points added inside move,
/// edges and faces are exchanged, points merged and inserted. Points before `kept`, and all of mesh.faces, stay as they
/// are. No change makes the worst of the tets that it touches worse, and each keeps all tets positive (exactly).
///
/// A large mesh is cut into pieces that are improved side by side, then the tets along the cuts.
void improve_tets(TetMesh& mesh, std::size_t kept, const ImproveOptions& options, ImproveCounts& counts);

}  // namespace stackmesh::volume
