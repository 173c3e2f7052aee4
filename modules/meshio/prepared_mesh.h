#pragma once
#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "meshio/write_mesh.h"
#include "model/solver_model.h"

namespace stackmesh {

/// Tets of one label: [begin, end) of PreparedMesh::tets. And its wedges: [wedge_begin, wedge_end) of
/// PreparedMesh::wedges.
struct LabelGroup {
  Label label = 0;
  std::size_t begin = 0, end = 0;
  std::string name;  ///< unique in the mesh
  std::size_t wedge_begin = 0, wedge_end = 0;

  std::size_t elements() const { return end - begin + wedge_end - wedge_begin; }
};

/// Triangles of one pair of labels: [begin, end) of PreparedMesh::triangles.
struct PairGroup {
  Label below = 0, above = 0;
  std::size_t begin = 0, end = 0;
  std::string name;  ///< "femur|background"
};

/// What every format writer gets: indices and coordinates checked, no unused points, triangles oriented as
/// write_mesh.h says and grouped by pair, tets grouped by label.
struct PreparedMesh {
  std::vector<Vec3> points;
  std::vector<InterfaceTriangle> triangles;
  std::vector<std::array<std::int32_t, 4>> tets;
  std::vector<std::array<std::int32_t, 6>> tet_mids;  ///< second order: mid-side nodes of the tets (kTetEdges)
  /// as TetMesh has them; elements are counted through, tets first
  std::vector<std::array<std::int32_t, 6>> wedges;
  std::vector<std::array<std::int32_t, 9>> wedge_mids;     ///< second order
  std::vector<std::array<std::int32_t, 3>> triangle_mids;  ///< second order: of the triangles, each behind its corner
  std::vector<PairGroup> pairs;                            ///< ascending (below, above)
  std::vector<LabelGroup> labels;                          ///< ascending; empty for a surface
  std::vector<LabelInfo> named;  ///< every label of the mesh but the background, with its unique name and its colour
  std::string space;             ///< "LPS", "RAS" or ""
  SolverSets sets;               ///< of a solver model; for a deck of a mere mesh by add_interface_sets()

  bool second_order() const { return !tet_mids.empty() || !wedge_mids.empty(); }
  std::size_t elements() const { return tets.size() + wedges.size(); }
  /// Visits the elements of a label: its tets, then its wedges.
  template <class Visit>
  void each_element(const LabelGroup& g, Visit visit) const {
    for (std::size_t t = g.begin; t < g.end; ++t) visit(t);
    for (std::size_t w = g.wedge_begin; w < g.wedge_end; ++w) visit(tets.size() + w);
  }
  /// Corners and mid-side nodes of an element's face, outward (from inside anticlockwise turned round).
  std::array<std::int32_t, 6> outward_face(TetFace f) const;

  /// "SPACE=LPS", or "SPACE=" of nothing: empty.
  std::string space_mark() const { return space.empty() ? "" : "SPACE=" + space; }
};

PreparedMesh prepare_surface(const InterfaceComplex& surface, const MeshWriteOptions& options, const std::string& path);
/// The closed surface of one label, normals out of it.
PreparedMesh prepare_label_surface(const InterfaceComplex& surface, Label label, const MeshWriteOptions& options,
                                   const std::string& path);
PreparedMesh prepare_volume(const TetMesh& mesh, const MeshWriteOptions& options, const std::string& path);
PreparedMesh prepare_model(const SolverModel& model, const MeshWriteOptions& options, const std::string& path);

/// For each triangle the element of its label `below` (where there is none, `above`) that has it as a face.
/// @param both_sides every label of a triangle but 0 must have such a tet; else one of them (parts have nodes of their
/// own)
/// @throws Error(internal) where that is not so
std::vector<TetFace> face_owners(const PreparedMesh& mesh, bool both_sides);

/// A node set and a face set for each pair of labels, and a placeholder material for each label.
void add_interface_sets(PreparedMesh& mesh);

/// The nodes of a set. @throws Error(internal) where there is no such set
const std::vector<std::int32_t>& nodes_of(const SolverSets& sets, const std::string& name);

/// For each element the place of its material in SolverSets::materials.
std::vector<std::int32_t> material_of_tets(const PreparedMesh& mesh);

/// The first static step; null where there is none.
const LoadStep* first_static_step(const SolverSets& sets);

/// Makes names distinct, whatever their letter case, within a length.
class UniqueNames {
 public:
  explicit UniqueNames(std::size_t max_length) : max_length_(max_length) {}
  std::string add(std::string name);

 private:
  std::size_t max_length_;
  std::set<std::string> taken_;
};

/// `name` with everything but letters, digits and '_' replaced by '_', beginning with a letter.
std::string deck_name(const std::string& name);

}  // namespace stackmesh
