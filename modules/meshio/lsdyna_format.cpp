#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "meshio/fixed_fields.h"
#include "meshio/formats.h"

namespace stackmesh {
namespace {

/// LS-DYNA's keyword file: a part for each material, sets, and the first static step as an implicit analysis.
class DynaFile : FixedFields {
 public:
  DynaFile(OutputBuffer& out, const PreparedMesh& mesh) : FixedFields(out), mesh_(mesh), sets_(mesh.sets) {
    if (mesh.points.size() > 99999999 || mesh.elements() > 99999999)
      fail_output("LS-DYNA's numbers have at most 8 digits here", std::to_string(mesh.points.size()) + " nodes",
                  "write another format");
  }

  void write() {
    out_ << "*KEYWORD\n*TITLE\nstackmesh\n$ units: mm, N, MPa, t/mm3\n";
    if (!mesh_.space.empty()) out_ << "$ " << mesh_.space_mark() << '\n';
    parts();
    nodes();
    elements();
    skins();
    label_sets();
    node_sets();
    segment_sets();
    ties();
    step();
    out_ << "*END\n";
  }

 private:
  static std::int64_t number(std::size_t i) { return static_cast<std::int64_t>(i) + 1; }
  void row(const std::vector<std::int64_t>& values) {  // cards of eight fields of ten characters
    for (const std::int64_t v : values) whole(v, 10);
  }

  void material(std::int64_t id, double young_mpa, double poisson, double density_t_mm3) {
    out_ << "*MAT_ELASTIC\n";
    row({id});
    real(density_t_mm3 > 0 ? density_t_mm3 : 1e-9, 10), real(young_mpa, 10), real(poisson, 10);
    out_ << '\n';
  }
  void part(const std::string& name, std::int64_t id, std::int64_t section) {
    out_ << "*PART\n" << name << '\n';
    row({id, section, id});
    out_ << '\n';
  }

  void parts() {
    out_ << "*SECTION_SOLID\n";
    row({1, mesh_.second_order() ? 16 : 10});
    out_ << '\n';
    if (!mesh_.wedges.empty()) {  // wedges and pyramids, fully integrated
      out_ << "*SECTION_SOLID\n";
      row({wedge_section(), 15});
      out_ << '\n';
    }
    if (sets_.placeholder_materials)
      out_ << "$ no material law was given: E = 1 MPa and a ratio of 0.3 hold the place\n";
    for (std::size_t i = 0; i < sets_.materials.size(); ++i) {
      const ElementMaterial& m = sets_.materials[i];
      part(m.name, number(i), 1);
      material(number(i), m.young_mpa, m.poisson, m.density_t_mm3);
    }
    for (std::size_t i = 0; i < sets_.materials.size() && !mesh_.wedges.empty(); ++i) {
      const ElementMaterial& m = sets_.materials[i];
      if (m.tets.empty() || static_cast<std::size_t>(m.tets.back()) < mesh_.tets.size()) continue;
      part(m.name + "_wedges", wedge_part(i), wedge_section());
      material(wedge_part(i), m.young_mpa, m.poisson, m.density_t_mm3);
    }
    for (std::size_t i = 0; i < sets_.shells.size(); ++i) {
      const ShellSet& s = sets_.shells[i];
      const std::int64_t id = number(sets_.materials.size() + i), section = number(i) + 1;
      out_ << "*SECTION_SHELL\n";
      row({section, 2});
      out_ << '\n';
      for (int k = 0; k < 4; ++k) real(s.thickness_mm, 10);
      out_ << '\n';
      part(s.name, id, section);
      material(id, s.young_mpa, s.poisson, s.density_t_mm3);
    }
  }

  /// Of wedges: parts behind those of materials and skins, a section behind those of skins.
  std::int64_t wedge_part(std::size_t material) const {
    return number(sets_.materials.size() + sets_.shells.size() + material);
  }
  std::int64_t wedge_section() const { return number(sets_.shells.size()) + 1; }

  void nodes() {
    out_ << "*NODE\n";
    for (std::size_t i = 0; i < mesh_.points.size(); ++i) {
      small(number(i));
      large(mesh_.points[i].x), large(mesh_.points[i].y), large(mesh_.points[i].z);
      out_ << '\n';
    }
  }

  /// Number and part on one line, the nodes on the next: four, the last one repeated to eight, or ten.
  void elements() {
    const std::vector<std::int32_t> material = material_of_tets(mesh_);
    out_ << "*ELEMENT_SOLID\n";
    for (std::size_t t = 0; t < mesh_.tets.size(); ++t) {
      small(number(t)), small(number(material[t]));
      out_ << '\n';
      const auto& v = mesh_.tets[t];
      for (const std::int32_t n : v) small(number(n));
      if (mesh_.second_order())
        for (const std::int32_t n : mesh_.tet_mids[t]) small(number(n));
      else
        for (int k = 0; k < 4; ++k) small(number(v[3]));
      out_ << '\n';
    }
    // corners repeated: n5 = n6 and n7 = n8 make a wedge, n5 to n8 a pyramid
    for (std::size_t i = 0; i < mesh_.wedges.size(); ++i) {
      const std::size_t e = mesh_.tets.size() + i;
      small(number(e)), small(wedge_part(static_cast<std::size_t>(material[e])));
      out_ << '\n';
      const auto& w = mesh_.wedges[i];
      const std::array<int, 8> order =
          is_pyramid(w) ? std::array<int, 8>{0, 3, 4, 1, 2, 2, 2, 2} : std::array<int, 8>{1, 0, 3, 4, 2, 2, 5, 5};
      for (const int k : order) small(number(w[k]));
      out_ << '\n';
    }
  }

  /// Shells of the corners: LS-DYNA's triangles of six nodes go with few materials.
  void skins() {
    std::int64_t element = static_cast<std::int64_t>(mesh_.elements());
    for (std::size_t i = 0; i < sets_.shells.size(); ++i) {
      out_ << "*ELEMENT_SHELL\n";
      for (const TetFace f : sets_.shells[i].faces) {
        small(++element), small(number(sets_.materials.size() + i));
        corners(f, 8);
        out_ << '\n';
      }
    }
  }
  void corners(TetFace f, std::size_t width) {
    const auto face = mesh_.outward_face(f);
    for (const int k : {0, 1, 2, 2}) whole(number(face[k]), width);
  }

  void list(const char* keyword, const std::string& name, std::int64_t id, const std::vector<std::int64_t>& ids) {
    out_ << keyword << '\n' << name << '\n';
    row({id});
    for (std::size_t i = 0; i < ids.size(); ++i) {
      if (i % 8 == 0) out_ << '\n';
      whole(ids[i], 10);
    }
    out_ << '\n';
  }

  void label_sets() {
    for (std::size_t g = 0; g < mesh_.labels.size(); ++g) {
      std::vector<std::int64_t> ids;
      for (std::size_t i = 0; i < sets_.materials.size(); ++i)
        if (sets_.materials[i].label == mesh_.labels[g].label) ids.push_back(number(i));
      for (std::size_t i = 0; i < sets_.materials.size() && !mesh_.wedges.empty(); ++i)
        if (sets_.materials[i].label == mesh_.labels[g].label &&
            static_cast<std::size_t>(sets_.materials[i].tets.back()) >= mesh_.tets.size())
          ids.push_back(wedge_part(i));
      list("*SET_PART_LIST_TITLE", deck_name(mesh_.labels[g].name), number(g), ids);
    }
  }
  void node_sets() {
    for (std::size_t s = 0; s < sets_.node_sets.size(); ++s) {
      std::vector<std::int64_t> ids;
      for (const std::int32_t v : sets_.node_sets[s].nodes) ids.push_back(number(v));
      list("*SET_NODE_LIST_TITLE", sets_.node_sets[s].name, number(s), ids);
    }
    next_node_set_ = number(sets_.node_sets.size());
  }
  void segment_sets() {
    for (std::size_t s = 0; s < sets_.surfaces.size(); ++s) {
      out_ << "*SET_SEGMENT_TITLE\n" << sets_.surfaces[s].name << '\n';
      row({number(s)});
      out_ << '\n';
      for (const TetFace f : sets_.surfaces[s].faces) {
        corners(f, 10);
        out_ << '\n';
      }
    }
  }

  /// Nodes that move alike along axes: x, y, z, xy, yz, zx, xyz are 1 to 7. All that follow a node along the same axes
  /// are one set.
  void ties() {
    constexpr int kKind[8] = {0, 1, 2, 4, 3, 6, 5, 7};  // of axes as bits: x = 1, y = 2, z = 4
    std::map<std::pair<std::int32_t, int>, std::vector<std::int64_t>> sets;
    for (const Tie& t : sets_.ties)
      for (const Tie::Node& n : t.nodes) {
        const int kind = kKind[(n.axes[0] ? 1 : 0) + (n.axes[1] ? 2 : 0) + (n.axes[2] ? 4 : 0)];
        if (kind > 0) sets[{n.followed, kind}].push_back(number(n.node));
      }
    for (auto& [key, nodes] : sets) {
      nodes.insert(nodes.begin(), number(key.first));
      list("*SET_NODE_LIST_TITLE", "tied_to_" + std::to_string(number(key.first)), next_node_set_, nodes);
      out_ << "*CONSTRAINED_NODE_SET\n";
      row({next_node_set_++, key.second});
      out_ << '\n';
    }
  }

  std::int64_t node_set(const std::string& name) const {
    for (std::size_t s = 0; s < sets_.node_sets.size(); ++s)
      if (sets_.node_sets[s].name == name) return number(s);
    fail_internal("a support names a set that is not there", name);
  }

  /// Loads grow with curve 1 from 0 to all of them at time 1.
  void step() {
    const LoadStep* step = first_static_step(sets_);
    if (step == nullptr) return;
    out_ << "*CONTROL_IMPLICIT_GENERAL\n";
    row({1});
    real(step->large_displacements || sets_.is_hyperelastic() ? 0.1 : 1.0, 10);
    out_ << "\n*CONTROL_IMPLICIT_SOLUTION\n";
    row({step->large_displacements || sets_.is_hyperelastic() ? 12 : 1});
    out_ << "\n*CONTROL_TERMINATION\n";
    real(1, 10);
    out_ << "\n*DATABASE_BINARY_D3PLOT\n";
    real(1, 10);
    out_ << "\n*DEFINE_CURVE\n";
    row({1});
    out_ << '\n';
    for (const double x : {0.0, 1.0}) {
      real(x, 20), real(x, 20);
      out_ << '\n';
    }
    for (const Support& s : step->supports) {
      std::vector<std::int64_t> card = {node_set(s.set), 0, 0, 0, 0};
      bool held = false;
      for (int axis = 0; axis < 3; ++axis)
        if (s.value_mm[axis] && *s.value_mm[axis] == 0) card[2 + axis] = 1, held = true;
      if (held) {
        out_ << "*BOUNDARY_SPC_SET\n";
        row(card);
        out_ << '\n';
      }
      for (int axis = 0; axis < 3; ++axis)
        if (s.value_mm[axis] && *s.value_mm[axis] != 0) {  // 2: a displacement
          out_ << "*BOUNDARY_PRESCRIBED_MOTION_SET\n";
          row({node_set(s.set), axis + 1, 2, 1});
          real(*s.value_mm[axis], 10);
          out_ << '\n';
        }
    }
    if (!step->forces_n.empty()) out_ << "*LOAD_NODE_POINT\n";
    for (const auto& [node, force] : step->forces_n) {
      const double f[3] = {force.x, force.y, force.z};
      for (int axis = 0; axis < 3; ++axis)
        if (f[axis] != 0) {
          row({number(node), axis + 1, 1});
          real(f[axis], 10);
          out_ << '\n';
        }
    }
    for (const Pressure& p : step->pressures)
      for (std::size_t s = 0; s < sets_.surfaces.size(); ++s)
        if (sets_.surfaces[s].name == p.set) {
          out_ << "*LOAD_SEGMENT_SET\n";
          row({number(s), 1});
          real(p.mpa, 10);
          out_ << '\n';
        }
    const double g[3] = {step->gravity_mm_s2.x, step->gravity_mm_s2.y, step->gravity_mm_s2.z};
    for (int axis = 0; axis < 3; ++axis)
      if (g[axis] != 0) {  // the base is accelerated: bodies the other way
        out_ << "*LOAD_BODY_"
             << "XYZ"[axis] << '\n';
        row({1});
        real(-g[axis], 10);
        out_ << '\n';
      }
  }

  const PreparedMesh& mesh_;
  const SolverSets& sets_;
  std::int64_t next_node_set_ = 1;
};

}  // namespace

void write_dyna(std::FILE* file, const PreparedMesh& mesh) {
  if (mesh.second_order() && !mesh.wedges.empty())
    fail_usage("second-order wedges are not written to LS-DYNA's .k", "--layer with --order 2",
               "take --order 1, or choose .inp .feb .bdf .cdb or .vtu");
  OutputBuffer out(file);
  DynaFile(out, mesh).write();
}

}  // namespace stackmesh
