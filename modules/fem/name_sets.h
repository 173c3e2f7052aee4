#pragma once
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fem/boundary_faces.h"
#include "model/solver_model.h"

namespace stackmesh {

/// Where the labels came from, for sets that only an image can name.
struct ImageBox {
  Vec3 origin;                         ///< world position (mm) of the corner of the first voxel
  std::array<Vec3, 3> axes;            ///< unit vectors of the image's x, y, z in the world
  std::array<double, 3> length_mm{};   ///< of the whole image along them
  std::array<double, 3> spacing_mm{};  ///< of its voxels along them
};

/// Which sets and parts a mesh gets.
struct SetOptions {
  Vec3 up = {0, 0, 1};            ///< stacking axis in the world, from the first slice to the last
  std::optional<ImageBox> image;  ///< names the faces on the image's own sides
  double sharp_deg = 50;          ///< edge at which the outer boundary is split
  std::vector<std::pair<std::string, std::vector<Label>>> parts;  ///< --parts; a label in none is of the part "rest"
  std::vector<std::string> selections;                            ///< --select, see select_faces()
  /// --skin: shells of that thickness (mm) on the outer faces
  std::vector<std::pair<Label, double>> skins;
  int times_cut = 0;  ///< how often refine_tets() has cut the mesh: its sets are those of the mesh before, cut likewise
};

/// Makes a solver model of a mesh: names its sets and parts its labels.
///
/// For each label L (by its name): `L_outer`, its faces to the background; `L_cap_low`, `L_cap_high`, flat ends along
/// the stacking axis; `L_outer_1`, `L_outer_2` ... the rest of them by connected piece and sharp edge, largest first;
/// for each two labels that touch `L_to_M` and `M_to_L`, their common face from either side; for each void V that the
/// mesh's `faces` tell of (a label on their open side) `L_inner_V`, its faces to it, which are not of `L_outer`; with
/// several labels `inner_V`, all faces to it; `border_x_low` ... `border_z_high`, faces on the image's own sides; with
/// several labels `cap_low`, `cap_high`, all caps of an end; then the selections. Each is a face set and a node set of
/// one name. With parts, nodes that several of them share are given to each of them, the faces between them are
/// `contact_A_B`, `contact_B_A`, their outlines `rim_A_B`, `rim_B_A`, nodes of three parts `triple_A_B_C`.
///
/// @param mesh linear or second order, every tet positive; any order of tets, but those cut from one stand together as
/// refine_tets() leaves them
/// @param labels numbers and names, as solvers have them, voids among them
/// @param options lengths in mm, in the space of the mesh
/// @throws Error(usage) for a selection that cannot be read or a part given twice, Error(input) for a label that is not
/// there, a selection without faces, a mesh whose tets overlap
SolverModel name_sets(const TetMesh& mesh, const std::vector<LabelInfo>& labels, const SetOptions& options);

}  // namespace stackmesh
