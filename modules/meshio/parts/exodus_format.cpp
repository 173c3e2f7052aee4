#include <exodusII.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "meshio/element_nodes.h"
#include "meshio/formats.h"

namespace stackmesh {
namespace {

/// Sides of an Exodus tetrahedron that are the faces of kTetFaces.
constexpr int kSide[4] = {4, 1, 2, 3};
/// And of a wedge and a pyramid those of kWedgeFaces.
constexpr int kWedgeSide[2] = {4, 5}, kPyramidSide[2] = {4, 2};
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
    if (code < 0)
      fail_output("the Exodus library could not write (code " + std::to_string(code) + ")", path_,
                  "free some space or choose another folder");
  }
  void names(ex_entity_type type, const std::vector<std::string>& names) const {
    check(ex_put_names(id_, type, pointers(names).data()));
  }
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

/// Elements of one label and one shape. Those of tetrahedra are numbered by the label, the others behind all labels.
struct Block {
  std::int64_t id;
  std::string type, name;
  std::vector<std::size_t> elements;
};

std::vector<Block> blocks_of(const PreparedMesh& mesh) {
  std::vector<Block> blocks;
  UniqueNames unique(kNameLength);
  std::int64_t next = 0;
  for (const LabelGroup& g : mesh.labels) {
    next = std::max<std::int64_t>(next, g.label);
    Block b{g.label, mesh.second_order() ? "TETRA10" : "TETRA4", unique.add(deck_name(g.name)), {}};
    for (std::size_t t = g.begin; t < g.end; ++t) b.elements.push_back(t);
    if (!b.elements.empty()) blocks.push_back(std::move(b));
  }
  for (const LabelGroup& g : mesh.labels)
    for (const bool pyramids : {false, true}) {
      Block b{
          0,
          pyramids ? (mesh.second_order() ? "PYRAMID13" : "PYRAMID5") : (mesh.second_order() ? "WEDGE15" : "WEDGE6"),
          deck_name(g.name) + (pyramids ? "_pyramids" : "_wedges"),
          {}};
      for (std::size_t w = g.wedge_begin; w < g.wedge_end; ++w)
        if (is_pyramid(mesh.wedges[w]) == pyramids) b.elements.push_back(mesh.tets.size() + w);
      if (b.elements.empty()) continue;
      b.id = ++next;
      b.name = unique.add(b.name);
      blocks.push_back(std::move(b));
    }
  return blocks;
}

/// Exodus counts elements block by block: the number of each, from 1.
std::vector<int> numbers_in(const std::vector<Block>& blocks, std::size_t elements) {
  std::vector<int> number(elements, 0);
  int next = 0;
  for (const Block& b : blocks)
    for (const std::size_t e : b.elements) number[e] = ++next;
  return number;
}

void put_blocks(const ExodusFile& file, const PreparedMesh& mesh, const std::vector<Block>& blocks) {
  std::vector<std::string> names;
  for (const Block& b : blocks) {
    std::vector<int> list;
    for (const std::size_t e : b.elements) {
      if (e >= mesh.tets.size()) {
        for (const std::int32_t v : wedge_nodes_of(mesh, e - mesh.tets.size(), WedgeOrder::exodus))
          list.push_back(v + 1);
        continue;
      }
      for (const std::int32_t v : mesh.tets[e]) list.push_back(v + 1);
      if (mesh.second_order())
        for (const std::int32_t v : mesh.tet_mids[e]) list.push_back(v + 1);
    }
    file.check(ex_put_block(file.id(), EX_ELEM_BLOCK, b.id, b.type.c_str(),
                            static_cast<std::int64_t>(b.elements.size()),
                            static_cast<std::int64_t>(list.size() / b.elements.size()), 0, 0, 0));
    file.check(ex_put_conn(file.id(), EX_ELEM_BLOCK, b.id, list.data(), nullptr, nullptr));
    names.push_back(b.name);
  }
  file.names(EX_ELEM_BLOCK, names);
}

void put_sets(const ExodusFile& file, const PreparedMesh& mesh, const std::vector<int>& number) {
  const SolverSets& sets = mesh.sets;
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
    for (const TetFace f : faces) {
      const auto e = static_cast<std::size_t>(f.tet);
      elements.push_back(number[e]);
      sides.push_back(e < mesh.tets.size()                            ? kSide[f.face]
                      : is_pyramid(mesh.wedges[e - mesh.tets.size()]) ? kPyramidSide[f.face]
                                                                      : kWedgeSide[f.face]);
    }
    file.check(ex_put_set_param(file.id(), EX_SIDE_SET, ++id, static_cast<std::int64_t>(faces.size()), 0));
    if (!faces.empty()) file.check(ex_put_set(file.id(), EX_SIDE_SET, id, elements.data(), sides.data()));
    names.push_back(side_names.add(name));
  };
  for (const FaceSet& s : sets.surfaces) put(s.name, s.faces);
  for (const ShellSet& s : sets.shells) put(s.name, s.faces);
  if (!names.empty()) file.names(EX_SIDE_SET, names);
}

/// What every element is made of, as element variables of the only time step.
void put_materials(const ExodusFile& file, const PreparedMesh& mesh, const std::vector<Block>& blocks) {
  const SolverSets& sets = mesh.sets;
  if (sets.materials.empty() || sets.placeholder_materials) return;
  const std::vector<std::int32_t> material = material_of_tets(mesh);
  std::vector<std::vector<double>> values(3, std::vector<double>(mesh.elements()));
  for (std::size_t t = 0; t < mesh.elements(); ++t) {
    const ElementMaterial& m = sets.materials[material[t]];
    values[0][t] = sets.modulus_mpa.empty() ? m.young_mpa : sets.modulus_mpa[t];
    values[1][t] = m.poisson;
    values[2][t] = sets.density_t_mm3.empty() ? m.density_t_mm3 : sets.density_t_mm3[t];
  }
  file.variables({"modulus_MPa", "poisson", "density_t_mm3"});
  const double time = 0;
  file.check(ex_put_time(file.id(), 1, &time));
  for (std::size_t k = 0; k < values.size(); ++k)
    for (const Block& b : blocks) {
      std::vector<double> of_block;
      for (const std::size_t e : b.elements) of_block.push_back(values[k][e]);
      file.check(ex_put_var(file.id(), 1, EX_ELEM_BLOCK, static_cast<int>(k) + 1, b.id,
                            static_cast<std::int64_t>(of_block.size()), of_block.data()));
    }
}

}  // namespace

void write_exodus(const std::string& path, const PreparedMesh& mesh) {
  for (const LabelGroup& g : mesh.labels)
    if (g.label <= 0)
      fail_output("Exodus numbers its blocks from 1", "label " + std::to_string(g.label),
                  "renumber the label or write another format");
  ExodusFile file(path);
  const std::vector<Block> blocks = blocks_of(mesh);
  const SolverSets& sets = mesh.sets;
  const std::string title = "stackmesh, mm" + (mesh.space.empty() ? "" : ", " + mesh.space_mark());
  file.check(ex_put_init(file.id(), title.c_str(), 3, static_cast<std::int64_t>(mesh.points.size()),
                         static_cast<std::int64_t>(mesh.elements()), static_cast<std::int64_t>(blocks.size()),
                         static_cast<std::int64_t>(sets.node_sets.size()),
                         static_cast<std::int64_t>(sets.surfaces.size() + sets.shells.size())));
  put_coordinates(file, mesh);
  put_blocks(file, mesh, blocks);
  put_sets(file, mesh, numbers_in(blocks, mesh.elements()));
  put_materials(file, mesh, blocks);
  file.close();
}

}  // namespace stackmesh
