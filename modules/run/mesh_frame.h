#pragma once
// The frame in which a mesh of another program lies: internal to the module.
#include <string>

#include "run/mesh_to_judge.h"

namespace stackmesh {

/// What is wrong with the frame of a mesh.
struct FrameFinding {
  bool mirrored = false;  ///< it fits the labels only as a mirror image
  std::string wrong;      ///< a sentence; empty: nothing is
};

/// Finds the frame that the mesh was written in, and brings it into that of the labels: LPS, or none where no anatomy
/// is known. The frame is the one that the user or the file tells, else the one in which the mesh overlaps the labels
/// best. The report's `mesh` gets the frame and the reason.
/// @param against null: there are no labels @param mesh_space ValidateRunOptions::mesh_space
/// @throws Error(input) where mesh and labels do not overlap in any frame that was tried, naming what would explain it
/// @throws Error(usage) where the space needs an image or anatomical axes, and there are none
FrameFinding take_frame(MeshToJudge& mesh, const Against* against, const std::string& mesh_space, RunReport& report);

}  // namespace stackmesh
