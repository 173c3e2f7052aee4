#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "meshio/write_mesh.h"
#include "model/complex.h"
#include "model/label_volume.h"
#include "model/tet_mesh.h"

namespace stackmesh {

/// Where the labels of a mesh file came from.
enum class LabelSource {
  none,   ///< nothing in the file: every triangle and tet has label 1
  sides,  ///< label_below and label_above of each triangle
  array,  ///< a number per cell (label, material, gmsh:physical ...)
  sets    ///< element sets or groups; numbers are those the file tells, else they count up
};

/// A mesh of any program, as its file holds it: mm are not checked, points keep their order (but see
/// `merged_points`), cells of other kinds than triangles, tets, wedges and pyramids are gone.
struct MeshFile {
  std::string path;          ///< of the file, as it was given
  std::string format;        ///< "stl", "ply", "obj", "off", "vtp", "vtk", "vtu", "msh", "inp" or "mesh"
  std::vector<Vec3> points;  ///< in the file's own coordinates, taken for mm
  /// Surface triangles. Of a file without tets: the normal points from `below` into `above`. Of a file with
  /// tets: only those that carry both labels; all others are left out, as the tets' faces tell more.
  std::vector<InterfaceTriangle> triangles;
  /// of a file with tets, per triangle: a label that it names and no tet has (a void), taken for background; 0: none
  std::vector<Label> behind;
  std::vector<std::array<std::int32_t, 4>> tets;     ///< corners, indices of `points`
  std::vector<std::array<std::int32_t, 6>> midside;  ///< of 10-node tets, on kTetEdges; empty: linear
  std::vector<std::array<std::int32_t, 6>> wedges;   ///< and pyramids, as TetMesh has them
  /// of 15-node wedges and 13-node pyramids, on kWedgeEdges; empty: linear
  std::vector<std::array<std::int32_t, 9>> wedge_midside;
  std::vector<Label> tet_labels;                 ///< one per element: tets, then wedges
  std::vector<LabelInfo> names;                  ///< of labels the file names, ascending by number
  LabelSource label_source = LabelSource::none;  ///< what in the file the labels were taken from
  std::string label_array;                       ///< name of the array the labels were read from, "" for none
  bool numbers_from_names = false;               ///< of sets: some number was only counted up; the name is what counts
  std::optional<Space> space;                    ///< the frame that the file says it is in
  std::size_t merged_points = 0;                 ///< exactly equal points that were made one (surfaces only)
  std::size_t dropped_triangles = 0;             ///< triangles that name a point twice (they bound nothing)
  std::vector<std::string> notes;                ///< what was converted or left out, for a report
};

/// How a mesh file is read.
struct MeshReadOptions {
  /// Cell array that holds the labels; empty: the first of label, labels, material, materialid, medit:ref,
  /// gmsh:physical, region, regionid, cellentityids, part, partid (any letter case, `_` and blanks ignored).
  std::string label_array;
};

/// True for .stl .ply .obj .off .vtp .vtk .vtu .msh .inp .mesh, in any letter case.
bool is_readable_mesh(const std::string& path);

/// Reads triangles, tetrahedra, wedges and pyramids (linear or with mid-side nodes; quads and polygons become
/// triangles, said in `notes`) from a mesh file of any program; the format is that of the ending. STL: binary and text;
/// PLY: binary and text; VTP, VTU: text, base64 and raw, appended or not, also zlib-compressed; VTK: legacy 2.0 to 5.1,
/// text and binary; MSH: Gmsh 2.2 and 4.1, text and binary; INP: Abaqus and CalculiX; MESH: Medit text. Memory is
/// bounded by the size of the file, whatever its header claims. @throws Error(input) in one clear line for anything
/// that cannot be read or is not a finite number, a mesh without triangles, hexahedra and other cells, labels that are
/// not whole numbers.
MeshFile read_mesh(const std::string& path, const MeshReadOptions& options = {});

/// Moves points and elements (with labels and mid-side nodes) out of a file; its triangles and its space stay there.
TetMesh take_elements(MeshFile& file);

/// The mesh's tets with their interface triangles: those of the file where it has them, else the faces between
/// tets of different labels.
TetMesh tet_mesh_of(MeshFile file);

/// The faces between tets of different labels (0 outside), oriented by the tets; a tet whose nodes run against
/// most of its neighbours' is turned round first.
std::vector<InterfaceTriangle> faces_of_tets(const TetMesh& mesh);

}  // namespace stackmesh
