#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "meshio/element_nodes.h"
#include "meshio/formats.h"
#include "meshio/nastran_steps.h"
#include "meshio/output_buffer.h"

namespace stackmesh {
namespace {

/// Bulk data: large fields (16 characters) for real numbers, small ones (8) for whole numbers.
class NastranFile : FixedFields {
 public:
  NastranFile(OutputBuffer& out, const PreparedMesh& mesh)
      : FixedFields(out), mesh_(mesh), sets_(mesh.sets), steps_(out, mesh) {
    if (mesh.points.size() > 99999999 || mesh.elements() > 99999999)
      fail_output("Nastran's numbers have at most 8 digits", std::to_string(mesh.points.size()) + " nodes",
                  "write another format");
  }

  void write() {
    out_ << "$ stackmesh\n$ units: mm, N, MPa, t/mm3\n";
    if (!mesh_.space.empty()) out_ << "$ " << mesh_.space_mark() << '\n';
    out_ << "SOL " << steps_.solution() << "\nCEND\nTITLE = stackmesh\n";
    case_sets();
    steps_.case_control();
    out_ << "BEGIN BULK\n";
    nodes();
    elements();
    materials();
    ties();
    steps_.bulk(number_, last_property_);
    out_ << "ENDDATA\n";
  }

 private:
  /// SET n = 1,2,3, ... in lines of at most 72 characters.
  void set(int number, const std::string& what, const std::vector<std::int64_t>& ids) {
    if (ids.empty()) return;
    out_ << "$ SET " << number << ": " << what << '\n';
    std::string line = "SET " + std::to_string(number) + " = ";
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const std::string text = std::to_string(ids[i]) + (i + 1 < ids.size() ? "," : "");
      if (line.size() + text.size() > 70) {
        out_ << line << '\n';
        line = "  ";
      }
      line += text;
    }
    out_ << line << '\n';
  }

  void case_sets() {
    int number = 100;
    for (const LabelGroup& g : mesh_.labels) {
      std::vector<std::int64_t> ids;
      for (std::size_t t = g.begin; t < g.end; ++t) ids.push_back(static_cast<std::int64_t>(t) + 1);
      set(++number, "elements of " + deck_name(g.name) + " (label " + std::to_string(g.label) + ")", ids);
    }
    for (const NodeSet& s : sets_.node_sets) {
      std::vector<std::int64_t> ids;
      for (const std::int32_t v : s.nodes) ids.push_back(static_cast<std::int64_t>(v) + 1);
      set(++number, "nodes of " + s.name, ids);
    }
    for (const FaceSet& s : sets_.surfaces) {
      std::vector<std::int64_t> ids;
      for (const TetFace f : s.faces)
        if (ids.empty() || ids.back() != f.tet + 1) ids.push_back(static_cast<std::int64_t>(f.tet) + 1);
      set(++number, "elements that have a face on " + s.name, ids);
    }
  }

  void nodes() {
    for (std::size_t i = 0; i < mesh_.points.size(); ++i) {
      const Vec3 p = mesh_.points[i];
      out_ << "GRID*   ";
      large(static_cast<std::int64_t>(i) + 1);
      padded("", 16);
      large(p.x);
      large(p.y);
      out_ << "\n*       ";
      large(p.z);
      out_ << '\n';
    }
  }

  /// Properties: the label's number where it has one material, else beyond all labels.
  std::vector<std::int64_t> properties() const {
    std::int64_t next = 0;
    for (const LabelGroup& g : mesh_.labels) next = std::max<std::int64_t>(next, g.label);
    std::vector<std::int64_t> ids;
    for (const ElementMaterial& m : sets_.materials) {
      bool whole = m.label > 0 && m.label < 10000000;
      for (const LabelGroup& g : mesh_.labels)
        if (g.label == m.label) whole = whole && g.elements() == m.tets.size();
      ids.push_back(whole ? m.label : ++next);
    }
    if (next + static_cast<std::int64_t>(sets_.shells.size()) > 99999999)
      fail_output("Nastran's numbers have at most 8 digits", "label " + std::to_string(next), "renumber the labels");
    return ids;
  }

  void element(const char* card, std::int64_t number, std::int64_t property, const std::vector<std::int32_t>& nodes) {
    out_ << card;
    small(number);
    small(property);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (k == 6 || k == 14) out_ << "+       \n+       ";  // marked, as older readers want it
      small(static_cast<std::int64_t>(nodes[k]) + 1);
    }
    out_ << '\n';
  }

  void elements() {
    ids_ = properties();
    std::vector<std::int64_t> property(mesh_.elements(), 0);
    for (std::size_t i = 0; i < ids_.size(); ++i)
      for (const std::int32_t t : sets_.materials[i].tets) property[t] = ids_[i];
    for (std::size_t t = 0; t < mesh_.tets.size(); ++t) {
      std::vector<std::int32_t> nodes(mesh_.tets[t].begin(), mesh_.tets[t].end());
      if (mesh_.second_order()) nodes.insert(nodes.end(), mesh_.tet_mids[t].begin(), mesh_.tet_mids[t].end());
      element("CTETRA  ", static_cast<std::int64_t>(t) + 1, property[t], nodes);
    }
    for (std::size_t w = 0; w < mesh_.wedges.size(); ++w) {
      const std::size_t e = mesh_.tets.size() + w;
      element(is_pyramid(mesh_.wedges[w]) ? "CPYRAM  " : "CPENTA  ", static_cast<std::int64_t>(e) + 1, property[e],
              wedge_nodes_of(mesh_, w, WedgeOrder::exodus));
    }
    shell_ = 0;
    for (const std::int64_t id : ids_) shell_ = std::max(shell_, id);
    for (const LabelGroup& g : mesh_.labels) shell_ = std::max<std::int64_t>(shell_, g.label);
    std::int64_t number = static_cast<std::int64_t>(mesh_.elements()), id = shell_;
    for (const ShellSet& s : sets_.shells) {
      ++id;
      for (const TetFace f : s.faces) {
        const auto face = mesh_.outward_face(f);
        element(mesh_.second_order() ? "CTRIA6  " : "CTRIA3  ", ++number, id,
                {face.begin(), face.begin() + (mesh_.second_order() ? 6 : 3)});
      }
    }
  }

  void material(std::int64_t id, double young_mpa, double poisson, double density_t_mm3) {
    out_ << "MAT1*   ";
    large(id);
    large(young_mpa);
    padded("", 16);
    large(poisson);
    out_ << "\n*       ";
    large(density_t_mm3);
    out_ << '\n';
  }

  /// A property and its material of one number.
  void solid(std::int64_t id, const ElementMaterial& m) {
    const bool hyperelastic = m.kind == MaterialKind::neo_hooke || m.kind == MaterialKind::mooney_rivlin;
    out_ << (hyperelastic ? "PLSOLID " : "PSOLID  ");
    small(id);
    small(id);
    if (m.kind == MaterialKind::orthotropic && has_one_frame(m)) {  // its axes are a frame's of the same number
      small(id);
      out_ << '\n';
      orthotropic(id, m);
      return;
    }
    out_ << '\n';
    if (!hyperelastic) return material(id, m.young_mpa, m.poisson, m.density_t_mm3);
    const double c01 = m.kind == MaterialKind::mooney_rivlin ? m.constants[1] : 0;
    out_ << "MATHP*  ";
    large(id);
    large(m.constants[0]);
    large(c01);
    large(m.constants.back() / 2);
    out_ << "\n*       ";
    large(m.density_t_mm3);
    out_ << '\n';
  }

  bool has_one_frame(const ElementMaterial& m) const {
    const auto& axes = sets_.axes;
    for (const std::int32_t t : m.tets)
      if (norm(axes[t][0] - axes[m.tets[0]][0]) + norm(axes[t][1] - axes[m.tets[0]][1]) > 0) return false;
    return true;
  }

  void orthotropic(std::int64_t id, const ElementMaterial& m) {
    const auto& [a, b] = sets_.axes[m.tets[0]];
    const Vec3 z = cross(a, b);
    out_ << "CORD2R* ";  // origin, a point on its z axis, a point in its xz plane
    large(id);
    padded("", 16);
    large(0.0), large(0.0);
    out_ << "\n*       ";
    large(0.0), large(z.x), large(z.y), large(z.z);
    out_ << "\n*       ";
    large(a.x), large(a.y), large(a.z);
    out_ << '\n' << "MAT11*  ";
    large(id);
    const std::vector<double>& c = m.constants;
    large(c[0]), large(c[1]), large(c[2]);
    out_ << "\n*       ";
    large(c[3]), large(c[4]), large(c[5]), large(c[6]);
    out_ << "\n*       ";
    large(c[7]), large(c[8]), large(m.density_t_mm3);
    out_ << '\n';
  }

  void materials() {
    if (sets_.placeholder_materials) out_ << "$ No material law was given: E = 1 MPa and a nu = 0.3 hold the place.\n";
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      const ElementMaterial& m = sets_.materials[i];
      out_ << "$ " << m.name << '\n';
      solid(ids_[i], m);
    }
    std::int64_t id = shell_;
    for (const ShellSet& s : sets_.shells) {
      ++id;
      out_ << "$ " << s.name << '\n' << "PSHELL* ";
      large(id);
      large(id);
      large(s.thickness_mm);
      large(id);
      out_ << "\n*       \n";
      material(id, s.young_mpa, s.poisson, s.density_t_mm3);
    }
  }

  /// Nodes that follow another one at the same place: a rigid element each.
  void ties() {
    std::int64_t& number = number_ = static_cast<std::int64_t>(mesh_.elements());
    for (const ShellSet& s : sets_.shells) number += static_cast<std::int64_t>(s.faces.size());
    last_property_ = shell_ + static_cast<std::int64_t>(sets_.shells.size());
    for (const Tie& t : sets_.ties) {
      out_ << "$ " << t.name << '\n';
      for (const Tie::Node& n : t.nodes) {
        std::string axes;
        for (int axis = 0; axis < 3; ++axis)
          if (n.axes[axis]) axes += static_cast<char>('1' + axis);
        out_ << "RBE2    ";
        small(++number);
        small(static_cast<std::int64_t>(n.followed) + 1);
        padded(axes, 8);
        small(static_cast<std::int64_t>(n.node) + 1);
        out_ << '\n';
      }
    }
    for (const SurfacePair& p : sets_.pairs)
      if (p.contact != Contact::tie)
        out_ << "$ surfaces that face each other, without contact here: " << p.primary << " and " << p.secondary
             << '\n';
  }

  const PreparedMesh& mesh_;
  const SolverSets& sets_;
  std::vector<std::int64_t> ids_;                // of properties and materials
  std::int64_t shell_ = 0;                       // the last number before those of the skins
  std::int64_t number_ = 0, last_property_ = 0;  // of the last element and property so far
  NastranSteps steps_;
};

}  // namespace

void write_bdf(std::FILE* file, const PreparedMesh& mesh) {
  OutputBuffer out(file);
  NastranFile(out, mesh).write();
}

}  // namespace stackmesh
