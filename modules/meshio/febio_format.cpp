#include <cstdint>
#include <string>
#include <vector>

#include "meshio/element_nodes.h"
#include "meshio/febio_steps.h"
#include "meshio/formats.h"
#include "meshio/output_buffer.h"

namespace stackmesh {
namespace {

/// FEBio 4 (febio_spec 4.0). Names are references, so every one is written by the function that also writes what it
/// names.
class FebioFile {
 public:
  FebioFile(std::FILE* file, const PreparedMesh& mesh) : out_(file), mesh_(mesh), sets_(mesh.sets) {
    UniqueNames names(80);
    for (const LabelGroup& g : mesh.labels) {
      Part part{names.add(deck_name(g.name)), g.label, mesh.second_order() ? "tet10" : "tet4", {}};
      for (std::size_t t = g.begin; t < g.end; ++t) part.elements.push_back(t);
      if (!part.elements.empty()) parts_.push_back(std::move(part));
    }
    for (const LabelGroup& g : mesh.labels)
      for (const bool pyramids : {false, true}) {
        Part part{deck_name(g.name) + (pyramids ? "_pyramids" : "_wedges"),
                  g.label,
                  pyramids ? (mesh.second_order() ? "pyra13" : "pyra5") : (mesh.second_order() ? "penta15" : "penta6"),
                  {}};
        for (std::size_t w = g.wedge_begin; w < g.wedge_end; ++w)
          if (is_pyramid(mesh.wedges[w]) == pyramids) part.elements.push_back(mesh.tets.size() + w);
        if (part.elements.empty()) continue;
        part.name = names.add(part.name);
        parts_.push_back(std::move(part));
      }
  }

  void write() {
    out_ << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<febio_spec version=\"4.0\">\n<!-- stackmesh; units: mm, N, "
            "MPa, t/mm3";
    if (!mesh_.space.empty()) out_ << "; " << mesh_.space_mark();
    out_ << " -->\n<Module type=\"solid\">\n<units>mm-N-s</units>\n</Module>\n";
    FebioSteps steps(out_, mesh_);
    steps.control();
    materials();
    mesh(steps);
    domains();
    data(steps);
    steps.acting();
    contact();
    steps.springs();
    steps.further();
    steps.load_curves();
    out_ << "<Output>\n<plotfile type=\"febio\">\n<var type=\"displacement\"/>\n<var "
            "type=\"stress\"/>\n</plotfile>\n</Output>\n"
            "</febio_spec>\n";
  }

 private:
  /// Elements of one label and one shape; FEBio wants them apart, and each part has a material of its own.
  struct Part {
    std::string name;
    Label label;
    const char* type;
    std::vector<std::size_t> elements;
  };

  bool is_mapped(Label label) const {
    for (const Label l : sets_.mapped)
      if (l == label) return true;
    return false;
  }
  /// The material of a label; of a mapped one its first bin (the ratio is the same in all).
  const ElementMaterial& material_of(Label label) const {
    for (const ElementMaterial& m : sets_.materials)
      if (m.label == label) return m;
    return sets_.materials.front();
  }

  /// A material without a density keeps FEBio's own.
  bool has_density(std::size_t g) const {
    for (const std::size_t t : parts_[g].elements)
      if (sets_.density_t_mm3[t] > 0) return true;
    return false;
  }

  void constant(const char* name, double value) { out_ << '<' << name << '>' << value << "</" << name << ">\n"; }

  void materials() {
    out_ << "<Material>\n";
    if (sets_.placeholder_materials)
      out_ << "<!-- no material law was given: E = 1 MPa and v = 0.3 hold the place -->\n";
    int id = 0;
    for (std::size_t g = 0; g < parts_.size(); ++g) {
      const ElementMaterial& m = material_of(parts_[g].label);
      material(++id, g, m);
    }
    for (const ShellSet& s : sets_.shells) {
      out_ << "<material id=\"" << ++id << "\" name=\"M_" << s.name << "\" type=\"isotropic elastic\">\n";
      if (s.density_t_mm3 > 0) constant("density", s.density_t_mm3);
      constant("E", s.young_mpa);
      constant("v", s.poisson);
      out_ << "</material>\n";
    }
    for (const RigidPoint& p : sets_.points)
      out_ << "<material id=\"" << ++id << "\" name=\"" << p.name
           << "\" type=\"rigid body\">\n<density>1</density>\n<center_of_mass>" << p.at_mm.x << ',' << p.at_mm.y << ','
           << p.at_mm.z << "</center_of_mass>\n</material>\n";
    out_ << "</Material>\n";
  }

  void material(int id, std::size_t g, const ElementMaterial& m) {
    const std::vector<double>& c = m.constants;
    const auto begin = [&](const char* type) {
      out_ << "<material id=\"" << id << "\" name=\"M_" << parts_[g].name << "\" type=\"" << type << "\">\n";
      if (!is_mapped(m.label) && m.density_t_mm3 > 0) constant("density", m.density_t_mm3);
    };
    switch (m.kind) {
      case MaterialKind::linear:
        begin("isotropic elastic");
        if (is_mapped(m.label)) {
          if (has_density(g)) out_ << "<density type=\"map\">density_" << parts_[g].name << "</density>\n";
          out_ << "<E type=\"map\">E_" << parts_[g].name << "</E>\n";
        } else {
          constant("E", m.young_mpa);
        }
        constant("v", m.poisson);
        break;
      case MaterialKind::orthotropic:  // FEBio asks for nu31, Abaqus and the law file for nu13
        begin("orthotropic elastic");
        constant("E1", c[0]), constant("E2", c[1]), constant("E3", c[2]), constant("G12", c[6]), constant("G23", c[8]),
            constant("G31", c[7]);
        constant("v12", c[3]), constant("v23", c[5]), constant("v31", c[4] * c[2] / c[0]);
        break;
      case MaterialKind::neo_hooke:  // FEBio's own neo-Hookean is another one: not uncoupled
        begin("Mooney-Rivlin");
        constant("c1", c[0]), constant("c2", 0), constant("k", c[1]);
        break;
      case MaterialKind::mooney_rivlin:
        begin("Mooney-Rivlin");
        constant("c1", c[0]), constant("c2", c[1]), constant("k", c[2]);
        break;
      case MaterialKind::holzapfel:
        begin("Holzapfel-Gasser-Ogden");
        constant("c", 2 * c[0]), constant("k1", c[1]), constant("k2", c[2]), constant("kappa", c[3]),
            constant("gamma", c[4]), constant("k", c[5]);
        break;
    }
    out_ << "</material>\n";
  }

  template <class Nodes>
  void list(const Nodes& nodes, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (i > begin) out_ << ',';
      out_ << nodes[i] + 1;
    }
  }

  void node(std::size_t number, Vec3 p) {
    out_ << "<node id=\"" << number << "\">" << p.x << ',' << p.y << ',' << p.z << "</node>\n";
  }

  void mesh(FebioSteps& steps) {
    out_ << "<Mesh>\n<Nodes name=\"NALL\">\n";
    for (std::size_t i = 0; i < mesh_.points.size(); ++i) node(i + 1, mesh_.points[i]);
    steps.ground_nodes([&](std::size_t number, Vec3 p) { node(number, p); });
    out_ << "</Nodes>\n";
    const bool quadratic = mesh_.second_order();
    for (std::size_t g = 0; g < parts_.size(); ++g) {
      out_ << "<!-- label " << parts_[g].label << " -->\n<Elements type=\"" << parts_[g].type << "\" name=\""
           << parts_[g].name << "\">\n";
      for (const std::size_t t : parts_[g].elements) {
        out_ << "<elem id=\"" << t + 1 << "\">";
        if (t >= mesh_.tets.size()) {
          const std::vector<std::int32_t> nodes = wedge_nodes_of(mesh_, t - mesh_.tets.size(), WedgeOrder::abaqus);
          list(nodes, 0, nodes.size());
          out_ << "</elem>\n";
          continue;
        }
        list(mesh_.tets[t], 0, 4);
        if (quadratic) {
          out_ << ',';
          list(mesh_.tet_mids[t], 0, 6);
        }
        out_ << "</elem>\n";
      }
      out_ << "</Elements>\n";
    }
    std::size_t number = mesh_.elements();
    for (const ShellSet& s : sets_.shells) {
      out_ << "<Elements type=\"" << (quadratic ? "tri6" : "tri3") << "\" name=\"" << s.name << "\">\n";
      for (const TetFace f : s.faces) {
        out_ << "<elem id=\"" << ++number << "\">";
        list(mesh_.outward_face(f), 0, quadratic ? 6 : 3);
        out_ << "</elem>\n";
      }
      out_ << "</Elements>\n";
    }
    for (const NodeSet& s : sets_.node_sets) node_set(s.name, s.nodes);
    steps.node_sets([&](const std::string& name, const std::vector<std::int32_t>& nodes) { node_set(name, nodes); });
    for (const FaceSet& s : sets_.surfaces) {
      out_ << "<Surface name=\"" << s.name << "\">\n";
      const char* tag = quadratic ? "tri6" : "tri3";
      for (std::size_t i = 0; i < s.faces.size(); ++i) {
        out_ << '<' << tag << " id=\"" << i + 1 << "\">";
        list(mesh_.outward_face(s.faces[i]), 0, quadratic ? 6 : 3);
        out_ << "</" << tag << ">\n";
      }
      out_ << "</Surface>\n";
    }
    for (const SurfacePair& p : sets_.pairs)
      out_ << "<SurfacePair name=\"" << p.name << "\">\n<primary>" << p.primary << "</primary>\n<secondary>"
           << p.secondary << "</secondary>\n</SurfacePair>\n";
    steps.discrete_sets();
    out_ << "</Mesh>\n";
  }

  void node_set(const std::string& name, const std::vector<std::int32_t>& nodes) {
    out_ << "<NodeSet name=\"" << name << "\">";
    list(nodes, 0, nodes.size());
    out_ << "</NodeSet>\n";
  }

  void domains() {
    out_ << "<MeshDomains>\n";
    for (const Part& part : parts_)
      out_ << "<SolidDomain name=\"" << part.name << "\" mat=\"M_" << part.name << "\"/>\n";
    for (const ShellSet& s : sets_.shells) {
      out_ << "<ShellDomain name=\"" << s.name << "\" mat=\"M_" << s.name << "\">\n";
      constant("shell_thickness", s.thickness_mm);
      out_ << "</ShellDomain>\n";
    }
    out_ << "</MeshDomains>\n";
  }

  /// The modulus of each element of a mapped label, and the forces on nodes.
  void data(FebioSteps& steps) {
    if (sets_.mapped.empty() && sets_.axes.empty() && !steps.has_forces()) return;
    out_ << "<MeshData>\n";
    for (std::size_t g = 0; g < parts_.size(); ++g) {
      const Part& part = parts_[g];
      if (!is_mapped(part.label)) continue;
      const auto map = [&](const char* what, const std::vector<double>& values) {
        out_ << "<ElementData name=\"" << what << '_' << part.name << "\" elem_set=\"" << part.name << "\">\n";
        for (std::size_t i = 0; i < part.elements.size(); ++i)
          out_ << "<elem lid=\"" << i + 1 << "\">" << values[part.elements[i]] << "</elem>\n";
        out_ << "</ElementData>\n";
      };
      if (has_density(g)) map("density", sets_.density_t_mm3);
      map("E", sets_.modulus_mpa);
    }
    for (std::size_t g = 0; g < parts_.size(); ++g) axes(g);
    steps.node_data();
    out_ << "</MeshData>\n";
  }

  /// Material axes of a label's elements.
  void axes(std::size_t g) {
    const Part& part = parts_[g];
    if (sets_.axes.empty() || norm(sets_.axes[part.elements[0]][0]) == 0) return;
    out_ << "<ElementData type=\"mat_axis\" elem_set=\"" << part.name << "\">\n";
    for (std::size_t i = 0; i < part.elements.size(); ++i) {
      const auto& [a, d] = sets_.axes[part.elements[i]];
      out_ << "<elem lid=\"" << i + 1 << "\"><a>" << a.x << ',' << a.y << ',' << a.z << "</a><d>" << d.x << ',' << d.y
           << ',' << d.z << "</d></elem>\n";
    }
    out_ << "</ElementData>\n";
  }

  /// Ties are held by augmentation, contact by a penalty: the pressure per mm of penetration.
  void contact() {
    bool any = false;
    for (const SurfacePair& p : sets_.pairs) {
      if (p.contact == Contact::none) continue;
      if (!any) out_ << "<Contact>\n";
      any = true;
      const bool tied = p.contact == Contact::tie;
      out_ << "<contact name=\"" << p.name << "_contact\" surface_pair=\"" << p.name << "\" type=\""
           << (tied ? "tied-elastic" : "sliding-elastic") << "\">\n";
      if (tied) {
        out_ << "<laugon>AUGLAG</laugon>\n<tolerance>0.01</tolerance>\n<penalty>10</penalty>\n<auto_penalty>1</"
                "auto_penalty>\n";
      } else {
        out_ << "<laugon>PENALTY</laugon>\n";
        constant("penalty", p.stiffness_mpa_mm);
        out_ << "<auto_penalty>0</auto_penalty>\n";
        constant("fric_coeff", p.friction);
      }
      out_ << "<two_pass>0</two_pass>\n<symmetric_stiffness>" << (!tied && p.friction > 0 ? 0 : 1)
           << "</symmetric_stiffness>\n</contact>\n";
    }
    if (any) out_ << "</Contact>\n";
  }

  OutputBuffer out_;
  const PreparedMesh& mesh_;
  const SolverSets& sets_;
  std::vector<Part> parts_;
};

}  // namespace

void write_feb(std::FILE* file, const PreparedMesh& mesh) {
  FebioFile(file, mesh).write();
}

}  // namespace stackmesh
