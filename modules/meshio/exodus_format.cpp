#include <exodusII.h>

#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "meshio/formats.h"

namespace stackmesh {
namespace {

/// Sides of an Exodus tetrahedron that are the faces of kTetFaces.
constexpr int kSide[4] = {4, 1, 2, 3};
constexpr int kNameLength = 80;

/// An open file; every call that fails is an error that names it.
class ExodusFile {
 public:
  explicit ExodusFile(const std::string& path) : path_(path) {
    ex_opts(0);  // it prints nothing of its own
    int words = 8, stored = 8;
    id_ = ex_create(path.c_str(), EX_CLOBBER | EX_LARGE_MODEL, &words, &stored);
    check(id_);
    check(ex_set_max_name_length(id_, kNameLength));
  }
  ExodusFile(const ExodusFile&) = delete;
  ExodusFile& operator=(const ExodusFile&) = delete;
  ~ExodusFile() {
    if (id_ >= 0) ex_close(id_);
  }
  void close() {
    const int id = id_;
    id_ = -1;
    check(ex_close(id));
  }
  void check(int code) const {
    if (code < 0) fail_output("the Exodus library could not write (code " + std::to_string(code) + ")", path_, "free some space or choose another folder");
  }
  void names(ex_entity_type type, const std::vector<std::string>& names) const { check(ex_put_names(id_, type, pointers(names).data())); }
  void variables(const std::vector<std::string>& names) const {
    check(ex_put_variable_param(id_, EX_ELEM_BLOCK, static_cast<int>(names.size())));
    check(ex_put_variable_names(id_, EX_ELEM_BLOCK, static_cast<int>(names.size()), pointers(names).data()));
  }
  int id() const { return id_; }

 private:
  /// The library takes names that it could change, and does not.
  static std::vector<char*> pointers(const std::vector<std::string>& names) {
    std::vector<char*> list;
    for (const std::string& n : names) list.push_back(const_cast<char*>(n.c_str()));
    return list;
  }
  std::string path_;
  int id_ = -1;
};

void put_coordinates(const ExodusFile& file, const PreparedMesh& mesh) {
  std::vector<double> x, y, z;
  for (const Vec3 p : mesh.points) x.push_back(p.x), y.push_back(p.y), z.push_back(p.z);
  file.check(ex_put_coord(file.id(), x.data(), y.data(), z.data()));
  char x_name[] = "x", y_name[] = "y", z_name[] = "z";
  char* names[] = {x_name, y_name, z_name};
  file.check(ex_put_coord_names(file.id(), names));
}

/// A block of elements for each label, numbered by it.
void put_blocks(const ExodusFile& file, const PreparedMesh& mesh) {
  std::vector<std::string> names;
  UniqueNames unique(kNameLength);
  for (const LabelGroup& g : mesh.labels) {
    const int nodes = mesh.second_order() ? 10 : 4;
    file.check(ex_put_block(file.id(), EX_ELEM_BLOCK, g.label, nodes == 10 ? "TETRA10" : "TETRA4", static_cast<std::int64_t>(g.end - g.begin), nodes, 0, 0, 0));
    std::vector<int> list;
    for (std::size_t t = g.begin; t < g.end; ++t) {
      for (const std::int32_t v : mesh.tets[t]) list.push_back(v + 1);
      if (mesh.second_order())
        for (const std::int32_t v : mesh.tet_mids[t]) list.push_back(v + 1);
    }
    file.check(ex_put_conn(file.id(), EX_ELEM_BLOCK, g.label, list.data(), nullptr, nullptr));
    names.push_back(unique.add(deck_name(g.name)));
  }
  file.names(EX_ELEM_BLOCK, names);
}

void put_sets(const ExodusFile& file, const SolverSets& sets) {
  UniqueNames node_names(kNameLength), side_names(kNameLength);
  std::vector<std::string> names;
  int id = 0;
  for (const NodeSet& s : sets.node_sets) {
    std::vector<int> nodes;
    for (const std::int32_t v : s.nodes) nodes.push_back(v + 1);
    file.check(ex_put_set_param(file.id(), EX_NODE_SET, ++id, static_cast<std::int64_t>(nodes.size()), 0));
    if (!nodes.empty()) file.check(ex_put_set(file.id(), EX_NODE_SET, id, nodes.data(), nullptr));
    names.push_back(node_names.add(s.name));
  }
  if (!names.empty()) file.names(EX_NODE_SET, names);
  names.clear();
  id = 0;
  const auto put = [&](const std::string& name, const std::vector<TetFace>& faces) {
    std::vector<int> elements, sides;
    for (const TetFace f : faces) elements.push_back(f.tet + 1), sides.push_back(kSide[f.face]);
    file.check(ex_put_set_param(file.id(), EX_SIDE_SET, ++id, static_cast<std::int64_t>(faces.size()), 0));
    if (!faces.empty()) file.check(ex_put_set(file.id(), EX_SIDE_SET, id, elements.data(), sides.data()));
    names.push_back(side_names.add(name));
  };
  for (const FaceSet& s : sets.surfaces) put(s.name, s.faces);
  for (const ShellSet& s : sets.shells) put(s.name, s.faces);
  if (!names.empty()) file.names(EX_SIDE_SET, names);
}

/// What every element is made of, as element variables of the only time step.
void put_materials(const ExodusFile& file, const PreparedMesh& mesh) {
  const SolverSets& sets = mesh.sets;
  if (sets.materials.empty() || sets.placeholder_materials) return;
  const std::vector<std::int32_t> material = material_of_tets(mesh);
  std::vector<std::vector<double>> values(3, std::vector<double>(mesh.tets.size()));
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const ElementMaterial& m = sets.materials[material[t]];
    values[0][t] = sets.modulus_mpa.empty() ? m.young_mpa : sets.modulus_mpa[t];
    values[1][t] = m.poisson;
    values[2][t] = sets.density_t_mm3.empty() ? m.density_t_mm3 : sets.density_t_mm3[t];
  }
  file.variables({"modulus_MPa", "poisson", "density_t_mm3"});
  const double time = 0;
  file.check(ex_put_time(file.id(), 1, &time));
  for (std::size_t k = 0; k < values.size(); ++k)
    for (const LabelGroup& g : mesh.labels)
      file.check(ex_put_var(file.id(), 1, EX_ELEM_BLOCK, static_cast<int>(k) + 1, g.label, static_cast<std::int64_t>(g.end - g.begin), values[k].data() + g.begin));
}

}  // namespace

void write_exodus(const std::string& path, const PreparedMesh& mesh) {
  for (const LabelGroup& g : mesh.labels)
    if (g.label <= 0) fail_output("Exodus numbers its blocks from 1", "label " + std::to_string(g.label), "renumber the label or write another format");
  ExodusFile file(path);
  const SolverSets& sets = mesh.sets;
  const std::string title = "stackmesh, mm" + (mesh.space.empty() ? "" : ", " + mesh.space_mark());
  file.check(ex_put_init(file.id(), title.c_str(), 3, static_cast<std::int64_t>(mesh.points.size()), static_cast<std::int64_t>(mesh.tets.size()),
                         static_cast<std::int64_t>(mesh.labels.size()), static_cast<std::int64_t>(sets.node_sets.size()),
                         static_cast<std::int64_t>(sets.surfaces.size() + sets.shells.size())));
  put_coordinates(file, mesh);
  put_blocks(file, mesh);
  put_sets(file, sets);
  put_materials(file, mesh);
  file.close();
}

}  // namespace stackmesh
