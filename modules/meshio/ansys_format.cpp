#include <array>
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "meshio/fixed_fields.h"
#include "meshio/formats.h"

namespace stackmesh {
namespace {

/// Faces of kTetFaces as SOLID187 numbers them, and as SOLID185 does whose nodes are I J K K M M M M.
constexpr int kFaceOfTen[4] = {1, 2, 3, 4}, kFaceOfFour[4] = {1, 2, 3, 5};
/// Wedges and pyramids are bricks with corners that coincide (SOLID185, SOLID186): I J K K M N O O, and I J K L M M M M
/// whose base is 0 3 4 1.
constexpr int kFaceOfWedge[2] = {1, 6}, kFaceOfPyramid[2] = {5, 3};

/// ANSYS's blocked archive, for CDREAD or /INPUT: nodes and elements in blocks of fixed fields, the rest as commands.
class AnsysFile : FixedFields {
 public:
  AnsysFile(OutputBuffer& out, const PreparedMesh& mesh) : FixedFields(out), mesh_(mesh), sets_(mesh.sets) {
    if (mesh.points.size() > 999999999 || mesh.elements() > 999999999)
      fail_output("the fields of .cdb hold at most 9 digits", std::to_string(mesh.points.size()) + " nodes",
                  "write another format");
  }

  void write() {
    out_ << "/COM, stackmesh\n/COM, units: mm, N, MPa, t/mm3\n";
    if (!mesh_.space.empty()) out_ << "/COM, " << mesh_.space_mark() << '\n';
    out_ << "/PREP7\nET,1," << (mesh_.second_order() ? 187 : 185) << '\n';
    if (mesh_.second_order() && !mesh_.wedges.empty()) out_ << "ET,2,186\n";
    nodes();
    elements();
    components();
    materials();
    ties();
    step();
    out_ << "FINISH\n";
  }

 private:
  static std::int64_t number(std::size_t i) { return static_cast<std::int64_t>(i) + 1; }

  void coordinate(double value) {  // Fortran's e21.13e3
    char text[32];
    std::snprintf(text, sizeof text, "%.13E", value);
    std::string field = text;
    const std::size_t digits = field.find('E') + 2;
    field.insert(digits, 3 - std::min<std::size_t>(3, field.size() - digits), '0');
    padded(field, 21);
  }

  void nodes() {
    out_ << "NBLOCK,6,SOLID," << mesh_.points.size() << ',' << mesh_.points.size() << "\n(3i9,6e21.13e3)\n";
    for (std::size_t i = 0; i < mesh_.points.size(); ++i) {
      whole(number(i), 9), whole(0, 9), whole(0, 9);
      coordinate(mesh_.points[i].x), coordinate(mesh_.points[i].y), coordinate(mesh_.points[i].z);
      out_ << '\n';
    }
    out_ << "N,R5.3,LOC,       -1,\n";
  }

  /// Linear ones are SOLID185 with coinciding corners.
  void elements() {
    const std::vector<std::int32_t> material = material_of_tets(mesh_);
    out_ << "EBLOCK,19,SOLID," << mesh_.elements() << ',' << mesh_.elements() << "\n(19i9)\n";
    for (std::size_t t = 0; t < mesh_.elements(); ++t) {
      std::vector<std::int32_t> nodes;
      const bool wedge = t >= mesh_.tets.size();
      if (wedge) {
        nodes = brick(t - mesh_.tets.size());
      } else {
        const auto& v = mesh_.tets[t];
        nodes = {v[0], v[1], v[2], v[2], v[3], v[3], v[3], v[3]};
        if (mesh_.second_order()) {
          nodes.assign(v.begin(), v.end());
          nodes.insert(nodes.end(), mesh_.tet_mids[t].begin(), mesh_.tet_mids[t].end());
        }
      }
      // material, type, constants, section, coordinate system, birth, solid, shape, number of nodes, unused, number
      for (const std::int64_t f :
           {number(material[t]), std::int64_t{wedge && mesh_.second_order() ? 2 : 1}, std::int64_t{1}, std::int64_t{1},
            std::int64_t{0}, std::int64_t{0}, std::int64_t{0}, std::int64_t{0}, static_cast<std::int64_t>(nodes.size()),
            std::int64_t{0}, number(t)})
        whole(f, 9);
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        if (k == 8) out_ << '\n';
        whole(number(nodes[k]), 9);
      }
      out_ << '\n';
    }
    whole(-1, 9);
    out_ << '\n';
  }

  /// A wedge or pyramid as a brick of 8 or 20 nodes.
  std::vector<std::int32_t> brick(std::size_t wedge) const {
    const auto& w = mesh_.wedges[wedge];
    const bool pyramid = is_pyramid(w);
    std::vector<std::int32_t> nodes = pyramid
                                          ? std::vector<std::int32_t>{w[0], w[3], w[4], w[1], w[2], w[2], w[2], w[2]}
                                          : std::vector<std::int32_t>{w[0], w[1], w[2], w[2], w[3], w[4], w[5], w[5]};
    if (!mesh_.second_order()) return nodes;
    const auto& m = mesh_.wedge_mids[wedge];  // Q R S T, U V W X, Y Z A B
    for (const std::int32_t v :
         pyramid ? std::array<std::int32_t, 12>{m[6], m[3], m[7], m[0], w[2], w[2], w[2], w[2], m[2], m[5], m[4], m[1]}
                 : std::array<std::int32_t, 12>{m[0], m[1], w[2], m[2], m[3], m[4], w[5], m[5], m[6], m[7], m[8], m[8]})
      nodes.push_back(v);
    return nodes;
  }

  int face_number(TetFace f) const {
    const auto e = static_cast<std::size_t>(f.tet);
    if (e < mesh_.tets.size()) return (mesh_.second_order() ? kFaceOfTen : kFaceOfFour)[f.face];
    return (is_pyramid(mesh_.wedges[e - mesh_.tets.size()]) ? kFaceOfPyramid : kFaceOfWedge)[f.face];
  }

  void component(const std::string& name, const char* kind, const std::vector<std::int64_t>& ids) {
    if (ids.empty()) return;
    std::string padded_name = name;
    padded_name.resize(std::max<std::size_t>(8, name.size()), ' ');
    out_ << "CMBLOCK," << padded_name << ',' << kind << ',' << ids.size() << "\n(8i10)\n";
    for (std::size_t i = 0; i < ids.size(); ++i) {
      if (i > 0 && i % 8 == 0) out_ << '\n';
      whole(ids[i], 10);
    }
    out_ << '\n';
  }

  /// Elements of labels, and of materials where a label has several; nodes of sets. Commands apply to the faces all of
  /// whose nodes are in a component.
  void components() {
    UniqueNames names(32);
    for (const LabelGroup& g : mesh_.labels) {
      std::vector<std::int64_t> ids;
      mesh_.each_element(g, [&](std::size_t t) { ids.push_back(number(t)); });
      component(names.add(deck_name(g.name)), "ELEM", ids);
    }
    for (const NodeSet& s : sets_.node_sets) {
      std::vector<std::int64_t> ids;
      for (const std::int32_t v : s.nodes) ids.push_back(number(v));
      component(names.add(s.name), "NODE", ids);
    }
  }

  void materials() {
    if (sets_.placeholder_materials)
      out_ << "/COM, no material law was given: EX = 1 MPa and PRXY = 0.3 hold the place\n";
    for (std::size_t i = 0; i < sets_.materials.size(); ++i) {
      const ElementMaterial& m = sets_.materials[i];
      out_ << "/COM, material " << i + 1 << ": " << m.name << '\n';
      command("MP,EX", i, m.young_mpa);
      command("MP,PRXY", i, m.poisson);
      if (m.density_t_mm3 > 0) command("MP,DENS", i, m.density_t_mm3);
    }
  }
  void command(const char* what, std::size_t material, double value) {
    out_ << what << ',' << material + 1 << ',';
    out_.print20(value);
    out_ << '\n';
  }

  /// Degrees of freedom in common. One may be in a single set only, so all that follow a node along an axis are in one.
  void ties() {
    std::map<std::pair<std::int32_t, int>, std::vector<std::int32_t>> sets;
    for (const Tie& t : sets_.ties)
      for (const Tie::Node& n : t.nodes)
        for (int axis = 0; axis < 3; ++axis)
          if (n.axes[axis]) sets[{n.followed, axis}].push_back(n.node);
    std::size_t set = 0;
    for (const auto& [key, nodes] : sets) {
      out_ << "CP," << ++set << ",U"
           << "XYZ"[key.second] << ',' << key.first + 1;
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (i > 0 && i % 16 == 0)
          out_ << "\nCP," << set << ",U"
               << "XYZ"[key.second];  // 17 nodes a command
        out_ << ',' << nodes[i] + 1;
      }
      out_ << '\n';
    }
  }

  void step() {
    const LoadStep* step = first_static_step(sets_);
    if (step == nullptr) return;
    out_ << "/SOLU\nANTYPE,STATIC\nNLGEOM," << (step->large_displacements ? "ON" : "OFF") << '\n';
    for (const Support& s : step->supports)
      for (const std::int32_t v : nodes_of(sets_, s.set))
        for (int axis = 0; axis < 3; ++axis)
          if (s.value_mm[axis]) {
            out_ << "D," << v + 1 << ",U"
                 << "XYZ"[axis] << ',';
            out_.print20(*s.value_mm[axis]);
            out_ << '\n';
          }
    for (const auto& [node, force] : step->forces_n) {
      const double f[3] = {force.x, force.y, force.z};
      for (int axis = 0; axis < 3; ++axis)
        if (f[axis] != 0) {
          out_ << "F," << node + 1 << ",F"
               << "XYZ"[axis] << ',';
          out_.print20(f[axis]);
          out_ << '\n';
        }
    }
    for (const Pressure& p : step->pressures)
      for (const FaceSet& s : sets_.surfaces) {
        if (s.name != p.set) continue;
        for (const TetFace f : s.faces) {
          out_ << "SFE," << f.tet + 1 << ',' << face_number(f) << ",PRES,,";
          out_.print20(p.mpa);
          out_ << '\n';
        }
      }
    if (norm(step->gravity_mm_s2) > 0) {  // ACEL moves the frame: bodies are accelerated the other way
      out_ << "ACEL";
      for (const double a : {step->gravity_mm_s2.x, step->gravity_mm_s2.y, step->gravity_mm_s2.z}) {
        out_ << ',';
        out_.print20(a == 0 ? 0.0 : -a);
      }
      out_ << '\n';
    }
  }

  const PreparedMesh& mesh_;
  const SolverSets& sets_;
};

}  // namespace

void write_cdb(std::FILE* file, const PreparedMesh& mesh) {
  OutputBuffer out(file);
  AnsysFile(out, mesh).write();
}

}  // namespace stackmesh
