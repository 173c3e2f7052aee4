#pragma once
// Which labels of the input the labels of a mesh stand for: internal to the module.
#include <vector>

#include "run/mesh_to_judge.h"

namespace stackmesh {

/// The labels that are judged.
struct LabelMatch {
  std::vector<LabelInfo> labels;  ///< of the input; without labels to compare with: none
  bool united = false;            ///< the mesh stands for all of them together
};

/// Gives the mesh's labels the numbers of the input: by number, by name, or by what they overlap; a mesh without labels
/// stands for the label that it fits best, or for all together. Labels that the input does not have become background.
/// The report gets a row for each label, `mesh->labels` in words, and warnings.
/// @param against null: the labels stay as they are
/// @throws Error(input) where only an overlap could tell, and there are no voxels
LabelMatch match_labels(MeshToJudge& mesh, const Against* against, RunReport& report);

}  // namespace stackmesh
