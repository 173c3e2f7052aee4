#pragma once
// A mesh file as `validate` takes it, and what it is judged against: internal to the module.
#include <array>
#include <optional>
#include <string>

#include "meshio/read_mesh.h"
#include "model/stack.h"
#include "report/run_report.h"
#include "run/input.h"
#include "run/validate_run.h"
#include "validate/overlap.h"

namespace stackmesh {

/// What is read once for all meshes.
struct Against {
  Input input;
  Stack sections;                              ///< of contours
  std::array<int, 3> stored_size = {0, 0, 0};  ///< of a volume, as its file has it
  std::array<double, 3> stored_spacing_mm = {0, 0, 0};
  Frame stored_frame;                 ///< from the centre of its first voxel
  int axis = 2;                       ///< along which slices are stacked: 0, 1, 2
  std::optional<OverlapMeter> meter;  ///< of a volume
};

/// Reads what `options.against` names, with voids as background, and puts a volume onto its true grid where that is
/// not forbidden. @param against is empty before, and is not moved afterwards. @throws as read_input()
void read_against(const ValidateRunOptions& options, Against& against);

/// The report's `input`, and the warnings of reading it.
void describe_input(const Against& against, RunReport& report);

/// A mesh of any program. Its frame is that of the file until take_frame() brings it into that of the labels.
struct MeshToJudge {
  MeshFile file;             ///< its points and triangles are moved out of it
  InterfaceComplex surface;  ///< of a mesh with tetrahedra: their faces
  TetMesh tets;              ///< no elements: a surface alone
  bool has_faces = false;    ///< the file has triangles beside the tetrahedra
};

/// Reads the mesh; the report gets its `mesh` and warnings. @throws Error(input) as read_mesh()
MeshToJudge read_mesh_to_judge(const std::string& path, const ValidateRunOptions& options, RunReport& report);

/// Turns round what is turned round as a whole, with a warning (run/turn_as_a_whole.h).
void turn_round(MeshToJudge& mesh, RunReport& report);

/// Three decimals, of a Dice coefficient.
std::string three_decimals(double share);

}  // namespace stackmesh
