#include <med.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "meshio/formats.h"
#include "meshio/output_buffer.h"
#include "meshio/parts/hdf5_times.h"

namespace stackmesh {
namespace {

constexpr char kMesh[] = "stackmesh";
/// Longest group name of Code_Aster.
constexpr std::size_t kNameLength = 24;
/// MED's tetrahedra are wound the other way: corners, then mid-side nodes (kTetEdges) of its edges 12, 23, 31, 14,
/// 24, 34.
constexpr int kCorner[4] = {0, 2, 1, 3}, kMid[6] = {2, 1, 0, 3, 5, 4};
/// And so are its wedges (kWedgeEdges), and pyramids: the base 0 1 4 3, the apex 2; edges of the base, then those to
/// the apex.
constexpr int kWedgeCorner[6] = {0, 2, 1, 3, 5, 4}, kWedgeMid[9] = {2, 1, 0, 5, 4, 3, 6, 8, 7};
constexpr int kPyramidCorner[5] = {0, 1, 4, 3, 2}, kPyramidMid[8] = {0, 7, 3, 6, 2, 1, 4, 5};

/// Names in fields of a fixed width, one behind the other.
std::string fields(const std::vector<std::string>& names, std::size_t width) {
  std::string text;
  for (const std::string& n : names) {
    text += n.substr(0, width);
    text.resize((text.size() + width - 1) / width * width, ' ');
  }
  return text;
}

/// A file in memory: HDF5 (1.10) crashes at the end of a program that could not write to a disk. Every call that fails
/// is an error.
class MedFile {
 public:
  MedFile() : id_(MEDmemFileOpen("stackmesh.med", &image_, MED_FALSE, MED_ACC_CREAT)) { check(id_ < 0 ? -1 : 0); }
  MedFile(const MedFile&) = delete;
  MedFile& operator=(const MedFile&) = delete;
  ~MedFile() {
    if (id_ >= 0) MEDfileClose(id_);
    std::free(image_.app_image_ptr);
  }
  /// Closes it and writes what it holds.
  void write(std::FILE* file) {
    const med_idt id = id_;
    id_ = -1;
    check(MEDfileClose(id));
    clear_hdf5_times(static_cast<unsigned char*>(image_.app_image_ptr), image_.app_image_size);
    OutputBuffer(file).bytes(image_.app_image_ptr, image_.app_image_size);
  }
  void check(med_err code) const {
    if (code < 0) fail_output("the MED library failed", ".med", "free some memory, or write another format");
  }
  void cells(med_geometry_type type, med_entity_type entity, std::size_t count,
             const std::vector<med_int>& nodes) const {
    check(MEDmeshElementConnectivityWr(id_, kMesh, MED_NO_DT, MED_NO_IT, MED_UNDEF_DT, entity, type, MED_NODAL,
                                       MED_FULL_INTERLACE, static_cast<med_int>(count), nodes.data()));
  }
  void families(med_geometry_type type, med_entity_type entity, const std::vector<med_int>& numbers) const {
    check(MEDmeshEntityFamilyNumberWr(id_, kMesh, MED_NO_DT, MED_NO_IT, entity, type,
                                      static_cast<med_int>(numbers.size()), numbers.data()));
  }
  med_idt id() const { return id_; }

 private:
  med_memfile image_ = MED_MEMFILE_INIT;
  med_idt id_;
};

/// Which groups each entity is in; all that are in the same ones are a family. Nodes have numbers above 0, elements
/// below.
class Families {
 public:
  explicit Families(int sign) : sign_(sign) {}
  med_int of(const std::vector<int>& groups) {
    if (groups.empty()) return 0;
    return families_.insert({groups, sign_ * static_cast<med_int>(families_.size() + 1)}).first->second;
  }
  void write(const MedFile& file, const std::vector<std::string>& names) const {
    for (const auto& [groups, number] : families_) {
      std::vector<std::string> list;
      for (const int g : groups) list.push_back(names[g]);
      const std::string family = "FAM_" + std::to_string(number);
      file.check(MEDfamilyCr(file.id(), kMesh, family.c_str(), number, static_cast<med_int>(list.size()),
                             fields(list, MED_LNAME_SIZE).c_str()));
    }
  }

 private:
  int sign_;
  std::map<std::vector<int>, med_int> families_;
};

void put_nodes(const MedFile& file, const PreparedMesh& mesh, const std::map<std::string, std::string>& short_names) {
  std::vector<med_float> coordinates;
  for (const Vec3 p : mesh.points) coordinates.insert(coordinates.end(), {p.x, p.y, p.z});
  file.check(MEDmeshNodeCoordinateWr(file.id(), kMesh, MED_NO_DT, MED_NO_IT, MED_UNDEF_DT, MED_FULL_INTERLACE,
                                     static_cast<med_int>(mesh.points.size()), coordinates.data()));
  std::vector<std::vector<int>> groups(mesh.points.size());
  std::vector<std::string> names;
  for (const NodeSet& s : mesh.sets.node_sets) {
    for (const std::int32_t v : s.nodes) groups[v].push_back(static_cast<int>(names.size()));
    names.push_back(short_names.at(s.name));
  }
  Families families(1);
  std::vector<med_int> numbers;
  for (const auto& g : groups) numbers.push_back(families.of(g));
  families.write(file, names);
  file.families(MED_NONE, MED_NODE, numbers);
}

med_geometry_type wedge_type(const PreparedMesh& mesh, bool pyramid) {
  return mesh.second_order() ? (pyramid ? MED_PYRA13 : MED_PENTA15) : (pyramid ? MED_PYRA5 : MED_PENTA6);
}

/// Elements in groups of their label and of their material; faces of sets as triangles in theirs.
/// @return the elements behind the triangles
std::vector<std::int32_t> put_cells(const MedFile& file, const PreparedMesh& mesh,
                                    const std::map<std::string, std::string>& short_names) {
  const SolverSets& sets = mesh.sets;
  std::vector<std::string> names;
  std::vector<std::vector<int>> groups(mesh.elements());
  UniqueNames unique(kNameLength);
  for (const LabelGroup& g : mesh.labels) {
    mesh.each_element(g, [&](std::size_t t) { groups[t].push_back(static_cast<int>(names.size())); });
    names.push_back(unique.add(deck_name(g.name)));
  }
  if (!sets.placeholder_materials)
    for (const ElementMaterial& m : sets.materials) {
      for (const std::int32_t t : m.tets) groups[t].push_back(static_cast<int>(names.size()));
      names.push_back(short_names.at(m.name));
    }
  Families families(-1);
  std::vector<med_int> numbers, nodes;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    numbers.push_back(families.of(groups[t]));
    for (const int k : kCorner) nodes.push_back(mesh.tets[t][k] + 1);
    if (mesh.second_order())
      for (const int k : kMid) nodes.push_back(mesh.tet_mids[t][k] + 1);
  }
  const med_geometry_type tet = mesh.second_order() ? MED_TETRA10 : MED_TETRA4,
                          triangle = mesh.second_order() ? MED_TRIA6 : MED_TRIA3;
  if (!mesh.tets.empty()) {
    file.cells(tet, MED_CELL, mesh.tets.size(), nodes);
    file.families(tet, MED_CELL, numbers);
  }
  for (const bool pyramids : {false, true}) {
    numbers.clear(), nodes.clear();
    for (std::size_t w = 0; w < mesh.wedges.size(); ++w) {
      if (is_pyramid(mesh.wedges[w]) != pyramids) continue;
      numbers.push_back(families.of(groups[mesh.tets.size() + w]));
      const auto put_nodes = [&](const auto& of, const auto& order) {
        for (const int k : order) nodes.push_back(of[k] + 1);
      };
      pyramids ? put_nodes(mesh.wedges[w], kPyramidCorner) : put_nodes(mesh.wedges[w], kWedgeCorner);
      if (mesh.second_order())
        pyramids ? put_nodes(mesh.wedge_mids[w], kPyramidMid) : put_nodes(mesh.wedge_mids[w], kWedgeMid);
    }
    if (numbers.empty()) continue;
    file.cells(wedge_type(mesh, pyramids), MED_CELL, numbers.size(), nodes);
    file.families(wedge_type(mesh, pyramids), MED_CELL, numbers);
  }

  // A face that is in several sets is one triangle. Sets look at an interface from either side: the first one's winding
  // stays.
  std::map<std::array<std::int32_t, 3>, std::size_t> place;
  std::vector<std::vector<int>> in;
  std::vector<std::int32_t> behind;
  nodes.clear();
  const auto put = [&](const std::string& name, const std::vector<TetFace>& faces) {
    const int group = static_cast<int>(names.size());
    names.push_back(short_names.at(name));
    for (const TetFace f : faces) {
      const auto face = mesh.outward_face(f);
      std::array<std::int32_t, 3> key = {face[0], face[1], face[2]};
      std::sort(key.begin(), key.end());
      const auto [at, fresh] = place.insert({key, in.size()});
      if (fresh) {
        in.emplace_back();
        behind.push_back(f.tet);
        for (int k = 0; k < (mesh.second_order() ? 6 : 3); ++k) nodes.push_back(face[k] + 1);
      }
      if (in[at->second].empty() || in[at->second].back() != group) in[at->second].push_back(group);
    }
  };
  for (const FaceSet& s : sets.surfaces) put(s.name, s.faces);
  for (const ShellSet& s : sets.shells) put(s.name, s.faces);
  if (!in.empty()) {
    numbers.clear();
    for (const auto& g : in) numbers.push_back(families.of(g));
    file.cells(triangle, MED_CELL, in.size(), nodes);
    file.families(triangle, MED_CELL, numbers);
  }
  families.write(file, names);
  return behind;
}

/// A value for each element, and for each triangle that of the one behind it (meshio wants one for all).
void put_field(const MedFile& file, const PreparedMesh& mesh, const std::string& name, const std::string& unit,
               const std::vector<double>& values, const std::vector<std::int32_t>& behind) {
  const std::string component = fields({name}, MED_SNAME_SIZE), in = fields({unit}, MED_SNAME_SIZE);
  file.check(MEDfieldCr(file.id(), name.c_str(), MED_FLOAT64, 1, component.c_str(), in.c_str(), "", kMesh));
  const auto put = [&](med_geometry_type type, const std::vector<double>& of) {
    file.check(MEDfieldValueWr(file.id(), name.c_str(), MED_NO_DT, MED_NO_IT, 0, MED_CELL, type, MED_FULL_INTERLACE,
                               MED_ALL_CONSTITUENT, static_cast<med_int>(of.size()),
                               reinterpret_cast<const unsigned char*>(of.data())));
  };
  if (!mesh.tets.empty())
    put(mesh.second_order() ? MED_TETRA10 : MED_TETRA4,
        {values.begin(), values.begin() + static_cast<std::ptrdiff_t>(mesh.tets.size())});
  for (const bool pyramids : {false, true}) {
    std::vector<double> of_wedges;
    for (std::size_t w = 0; w < mesh.wedges.size(); ++w)
      if (is_pyramid(mesh.wedges[w]) == pyramids) of_wedges.push_back(values[mesh.tets.size() + w]);
    if (!of_wedges.empty()) put(wedge_type(mesh, pyramids), of_wedges);
  }
  std::vector<double> on_triangles;
  for (const std::int32_t t : behind) on_triangles.push_back(values[t]);
  if (!behind.empty()) put(mesh.second_order() ? MED_TRIA6 : MED_TRIA3, on_triangles);
}

}  // namespace

void write_med(std::FILE* file, const PreparedMesh& mesh) {
  // Sets of nodes and of faces keep a name in common, so names are shortened once each.
  UniqueNames unique(kNameLength);
  std::map<std::string, std::string> short_names;
  const auto shorten = [&](const std::string& name) {
    if (short_names.count(name) == 0) short_names[name] = unique.add(name);
  };
  const SolverSets& sets = mesh.sets;
  for (const LabelGroup& g : mesh.labels) unique.add(deck_name(g.name));  // put_cells() names them alike
  for (const NodeSet& s : sets.node_sets) shorten(s.name);
  for (const FaceSet& s : sets.surfaces) shorten(s.name);
  for (const ShellSet& s : sets.shells) shorten(s.name);
  for (const ElementMaterial& m : sets.materials) shorten(m.name);

  MedFile med;
  const std::string description = "stackmesh, mm, N, MPa, t/mm3" + (mesh.space.empty() ? "" : "; " + mesh.space_mark());
  const std::string axes = fields({"x", "y", "z"}, MED_SNAME_SIZE), units = fields({"mm", "mm", "mm"}, MED_SNAME_SIZE);
  med.check(MEDmeshCr(med.id(), kMesh, 3, 3, MED_UNSTRUCTURED_MESH, description.c_str(), "", MED_SORT_DTIT,
                      MED_CARTESIAN, axes.c_str(), units.c_str()));
  med.check(MEDfamilyCr(med.id(), kMesh, "FAMILLE_ZERO", 0, 0, ""));
  put_nodes(med, mesh, short_names);
  const std::vector<std::int32_t> behind = put_cells(med, mesh, short_names);
  if (!sets.placeholder_materials && !sets.modulus_mpa.empty())
    put_field(med, mesh, "modulus_MPa", "MPa", sets.modulus_mpa, behind);
  if (!sets.placeholder_materials && !sets.density_t_mm3.empty())
    put_field(med, mesh, "density_t_mm3", "t/mm3", sets.density_t_mm3, behind);
  med.write(file);
}

}  // namespace stackmesh
