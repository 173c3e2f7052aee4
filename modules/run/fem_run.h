#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "run/mesh_run.h"

namespace stackmesh {

/// What to make a solver model of, and how.
struct FemRunOptions {
  /// also where the input is a mesh: its outputs, reports, labels, order (set for the output), space
  MeshRunOptions mesh;
  std::string image;                                       ///< intensities; empty: none
  std::string materials;                                   ///< law file; empty: none
  std::optional<int> erode_px;                             ///< instead of the law file's
  std::vector<std::pair<std::string, std::string>> parts;  ///< name, labels as --label takes them
  Contact contact = Contact::tie;                          ///< between parts, where the law file says nothing
  std::vector<std::pair<std::string, double>> skins;       ///< label, thickness in mm
  std::vector<std::string> selections;                     ///< see fem/selection.h
  double sharp_deg = 50;               ///< outer faces that meet at an edge turning by more are of different sets
  std::optional<double> accuracy_rel;  ///< the load case is solved on finer and finer meshes until this is reached
  std::string result;       ///< of CalculiX (.frd), for this very model: its stress colours the page; empty: none
  std::string label_array;  ///< of a mesh file: the cell array that holds labels; empty: the usual names
  Vec3 up = {0, 0, 1};      ///< of a mesh file: the axis along which its caps lie
};

/// Labels, or a volume mesh made before, to a solver model in the formats of the outputs: sets, materials, decks.
/// @throws Error as run_mesh(); Error(input) for what fem's functions refuse, and for a given mesh without tetrahedra
/// or with elements whose Jacobian is not positive (they are listed)
RunReport run_fem(const FemRunOptions& options, Monitor& progress);

}  // namespace stackmesh
