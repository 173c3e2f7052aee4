#include <cstdint>
#include <string>
#include <vector>

#include "meshio/formats.h"
#include "meshio/output_buffer.h"

namespace stackmesh {
namespace {

constexpr const char* kAxes = "xyz";

/// FEBio 4 (febio_spec 4.0). Names are references, so every one is written by the function that also writes what it names.
class FebioFile {
 public:
  FebioFile(std::FILE* file, const PreparedMesh& mesh) : out_(file), mesh_(mesh), sets_(mesh.sets) {
    UniqueNames names(80);
    for (const LabelGroup& g : mesh.labels) parts_.push_back(names.add(deck_name(g.name)));
  }

  void write() {
    out_ << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<febio_spec version=\"4.0\">\n<!-- stackmesh; units: mm, N, MPa, t/mm3";
    if (!mesh_.space.empty()) out_ << "; " << mesh_.space_mark();
    out_ << " -->\n<Module type=\"solid\">\n<units>mm-N-s</units>\n</Module>\n"
            "<Control>\n<analysis>STATIC</analysis>\n";
    out_ << (sets_.has_contact() ? "<time_steps>10</time_steps>\n<step_size>0.1</step_size>\n" : "<time_steps>1</time_steps>\n<step_size>1</step_size>\n");
    out_ << "<solver type=\"solid\">\n<symmetric_stiffness>" << (has_friction() ? "non-symmetric" : "symmetric")
         << "</symmetric_stiffness>\n</solver>\n</Control>\n";
    materials();
    mesh();
    domains();
    data();
    boundary();
    loads();
    contact();
    load_curve();
    out_ << "<Output>\n<plotfile type=\"febio\">\n<var type=\"displacement\"/>\n<var type=\"stress\"/>\n</plotfile>\n</Output>\n"
            "</febio_spec>\n";
  }

 private:
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
    for (std::size_t t = mesh_.labels[g].begin; t < mesh_.labels[g].end; ++t)
      if (sets_.density_t_mm3[t] > 0) return true;
    return false;
  }

  void constant(const char* name, double value) { out_ << '<' << name << '>' << value << "</" << name << ">\n"; }

  void materials() {
    out_ << "<Material>\n";
    if (sets_.placeholder_materials) out_ << "<!-- no material law was given: E = 1 MPa and v = 0.3 hold the place -->\n";
    int id = 0;
    for (std::size_t g = 0; g < parts_.size(); ++g) {
      const ElementMaterial& m = material_of(mesh_.labels[g].label);
      out_ << "<material id=\"" << ++id << "\" name=\"M_" << parts_[g] << "\" type=\"isotropic elastic\">\n";
      if (is_mapped(m.label)) {
        if (has_density(g)) out_ << "<density type=\"map\">density_" << parts_[g] << "</density>\n";
        out_ << "<E type=\"map\">E_" << parts_[g] << "</E>\n";
      } else {
        if (m.density_t_mm3 > 0) constant("density", m.density_t_mm3);
        constant("E", m.young_mpa);
      }
      constant("v", m.poisson);
      out_ << "</material>\n";
    }
    for (const ShellSet& s : sets_.shells) {
      out_ << "<material id=\"" << ++id << "\" name=\"M_" << s.name << "\" type=\"isotropic elastic\">\n";
      if (s.density_t_mm3 > 0) constant("density", s.density_t_mm3);
      constant("E", s.young_mpa);
      constant("v", s.poisson);
      out_ << "</material>\n";
    }
    out_ << "</Material>\n";
  }

  template <class Nodes>
  void list(const Nodes& nodes, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (i > begin) out_ << ',';
      out_ << nodes[i] + 1;
    }
  }

  void mesh() {
    out_ << "<Mesh>\n<Nodes name=\"NALL\">\n";
    for (std::size_t i = 0; i < mesh_.points.size(); ++i) {
      const Vec3 p = mesh_.points[i];
      out_ << "<node id=\"" << i + 1 << "\">" << p.x << ',' << p.y << ',' << p.z << "</node>\n";
    }
    out_ << "</Nodes>\n";
    const bool quadratic = mesh_.second_order();
    for (std::size_t g = 0; g < parts_.size(); ++g) {
      out_ << "<!-- label " << mesh_.labels[g].label << " -->\n<Elements type=\"" << (quadratic ? "tet10" : "tet4") << "\" name=\""
           << parts_[g] << "\">\n";
      for (std::size_t t = mesh_.labels[g].begin; t < mesh_.labels[g].end; ++t) {
        out_ << "<elem id=\"" << t + 1 << "\">";
        list(mesh_.tets[t], 0, 4);
        if (quadratic) {
          out_ << ',';
          list(mesh_.tet_mids[t], 0, 6);
        }
        out_ << "</elem>\n";
      }
      out_ << "</Elements>\n";
    }
    std::size_t number = mesh_.tets.size();
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
    if (!sets_.forces_n.empty()) {
      std::vector<std::int32_t> nodes;
      for (const auto& [node, force] : sets_.forces_n) nodes.push_back(node);
      node_set("loaded_nodes", nodes);
    }
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
      out_ << "<SurfacePair name=\"" << p.name << "\">\n<primary>" << p.primary << "</primary>\n<secondary>" << p.secondary
           << "</secondary>\n</SurfacePair>\n";
    out_ << "</Mesh>\n";
  }

  void node_set(const std::string& name, const std::vector<std::int32_t>& nodes) {
    out_ << "<NodeSet name=\"" << name << "\">";
    list(nodes, 0, nodes.size());
    out_ << "</NodeSet>\n";
  }

  void domains() {
    out_ << "<MeshDomains>\n";
    for (const std::string& part : parts_) out_ << "<SolidDomain name=\"" << part << "\" mat=\"M_" << part << "\"/>\n";
    for (const ShellSet& s : sets_.shells) {
      out_ << "<ShellDomain name=\"" << s.name << "\" mat=\"M_" << s.name << "\">\n";
      constant("shell_thickness", s.thickness_mm);
      out_ << "</ShellDomain>\n";
    }
    out_ << "</MeshDomains>\n";
  }

  /// The modulus of each element of a mapped label, and the forces on nodes.
  void data() {
    if (sets_.mapped.empty() && sets_.forces_n.empty()) return;
    out_ << "<MeshData>\n";
    for (std::size_t g = 0; g < parts_.size(); ++g) {
      const LabelGroup& group = mesh_.labels[g];
      if (!is_mapped(group.label)) continue;
      const auto map = [&](const char* what, const std::vector<double>& values) {
        out_ << "<ElementData name=\"" << what << '_' << parts_[g] << "\" elem_set=\"" << parts_[g] << "\">\n";
        for (std::size_t t = group.begin; t < group.end; ++t)
          out_ << "<elem lid=\"" << t - group.begin + 1 << "\">" << values[t] << "</elem>\n";
        out_ << "</ElementData>\n";
      };
      if (has_density(g)) map("density", sets_.density_t_mm3);
      map("E", sets_.modulus_mpa);
    }
    if (!sets_.forces_n.empty()) {
      out_ << "<NodeData name=\"nodal_forces\" node_set=\"loaded_nodes\" data_type=\"vec3\">\n";
      for (std::size_t i = 0; i < sets_.forces_n.size(); ++i) {
        const Vec3 f = sets_.forces_n[i].second;
        out_ << "<node lid=\"" << i + 1 << "\">" << f.x << ',' << f.y << ',' << f.z << "</node>\n";
      }
      out_ << "</NodeData>\n";
    }
    out_ << "</MeshData>\n";
  }

  void boundary() {
    if (!sets_.has_load_case()) return;
    out_ << "<Boundary>\n";
    for (const Support& s : sets_.supports) support(s);
    out_ << "</Boundary>\n";
  }
  void loads() {
    if (!sets_.forces_n.empty())
      out_ << "<Loads>\n<nodal_load name=\"load\" node_set=\"loaded_nodes\" type=\"nodal_force\">\n"
              "<value lc=\"1\" type=\"map\">nodal_forces</value>\n</nodal_load>\n</Loads>\n";
  }

  bool has_friction() const {
    for (const SurfacePair& p : sets_.pairs)
      if (p.contact == Contact::contact && p.friction > 0) return true;
    return false;
  }

  /// Ties are held by augmentation, contact by a penalty: the pressure per mm of penetration.
  void contact() {
    bool any = false;
    for (const SurfacePair& p : sets_.pairs) {
      if (p.contact == Contact::none) continue;
      if (!any) out_ << "<Contact>\n";
      any = true;
      const bool tied = p.contact == Contact::tie;
      out_ << "<contact name=\"" << p.name << "_contact\" surface_pair=\"" << p.name << "\" type=\"" << (tied ? "tied-elastic" : "sliding-elastic") << "\">\n";
      if (tied) {
        out_ << "<laugon>AUGLAG</laugon>\n<tolerance>0.01</tolerance>\n<penalty>10</penalty>\n<auto_penalty>1</auto_penalty>\n";
      } else {
        out_ << "<laugon>PENALTY</laugon>\n";
        constant("penalty", p.stiffness_mpa_mm);
        out_ << "<auto_penalty>0</auto_penalty>\n";
        constant("fric_coeff", p.friction);
      }
      out_ << "<two_pass>0</two_pass>\n<symmetric_stiffness>" << (!tied && p.friction > 0 ? 0 : 1) << "</symmetric_stiffness>\n</contact>\n";
    }
    if (any) out_ << "</Contact>\n";
  }

  void load_curve() {
    if (!sets_.has_load_case()) return;
    out_ << "<LoadData>\n<load_controller id=\"1\" type=\"loadcurve\">\n<interpolate>LINEAR</interpolate>\n"
            "<extend>CONSTANT</extend>\n<points>\n<pt>0,0</pt>\n<pt>1,1</pt>\n</points>\n</load_controller>\n</LoadData>\n";
  }

  void support(const Support& s) {
    bool any_fixed = false;
    for (const auto& v : s.value_mm) any_fixed = any_fixed || (v && *v == 0);
    if (any_fixed) {
      out_ << "<bc name=\"fixed_" << ++bcs_ << "\" node_set=\"" << s.set << "\" type=\"zero displacement\">\n";
      for (int axis = 0; axis < 3; ++axis)
        out_ << '<' << kAxes[axis] << "_dof>" << (s.value_mm[axis] && *s.value_mm[axis] == 0 ? '1' : '0') << "</" << kAxes[axis] << "_dof>\n";
      out_ << "</bc>\n";
    }
    for (int axis = 0; axis < 3; ++axis) {
      if (!s.value_mm[axis] || *s.value_mm[axis] == 0) continue;
      out_ << "<bc name=\"moved_" << ++bcs_ << "\" node_set=\"" << s.set << "\" type=\"prescribed displacement\">\n<dof>" << kAxes[axis]
           << "</dof>\n<value lc=\"1\">" << *s.value_mm[axis] << "</value>\n<relative>0</relative>\n</bc>\n";
    }
  }

  OutputBuffer out_;
  const PreparedMesh& mesh_;
  const SolverSets& sets_;
  std::vector<std::string> parts_;
  int bcs_ = 0;
};

}  // namespace

void write_feb(std::FILE* file, const PreparedMesh& mesh) { FebioFile(file, mesh).write(); }

}  // namespace stackmesh
