#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "meshio/formats.h"
#include "meshio/output_buffer.h"

namespace stackmesh {
namespace {

/// Numbers, 16 a line.
void write_list(OutputBuffer& out, const std::vector<std::int32_t>& from_zero) {
  for (std::size_t i = 0; i < from_zero.size(); ++i)
    out << from_zero[i] + 1 << (i + 1 == from_zero.size() ? "\n" : i % 16 == 15 ? ",\n" : ", ");
}

template <std::size_t N>
void write_element(OutputBuffer& out, std::size_t number, const std::array<std::int32_t, N>& nodes, std::size_t count) {
  out << number;
  for (std::size_t k = 0; k < count; ++k) out << ", " << nodes[k] + 1;
}

/// A face as shells of three nodes: Abaqus and CalculiX have none of six in common (STRI65, S6), so a second-order face gets four.
std::vector<std::array<std::int32_t, 3>> shells_of_three_nodes(const PreparedMesh& mesh, TetFace face) {
  const auto v = mesh.outward_face(face);
  if (!mesh.second_order()) return {{v[0], v[1], v[2]}};
  return {{v[0], v[3], v[5]}, {v[3], v[1], v[4]}, {v[5], v[4], v[2]}, {v[3], v[4], v[5]}};
}

void write_elastic(OutputBuffer& out, const std::string& name, double young_mpa, double poisson, double density_t_mm3) {
  out << "*MATERIAL, NAME=" << name << "\n*ELASTIC\n";
  out.print20(young_mpa);
  out << ", ";
  out.print20(poisson);
  out << '\n';
  if (density_t_mm3 <= 0) return;
  out << "*DENSITY\n";
  out.print20(density_t_mm3);
  out << '\n';
}

/// Materials, with an element set each where a label has several, and sections.
void write_materials(OutputBuffer& out, const PreparedMesh& mesh, const std::vector<std::string>& label_sets, UniqueNames& element_sets) {
  const SolverSets& sets = mesh.sets;
  if (sets.placeholder_materials) return;  // this format can be read without
  for (const ElementMaterial& m : sets.materials) {
    std::string set;
    for (std::size_t g = 0; g < mesh.labels.size(); ++g)
      if (mesh.labels[g].label == m.label && mesh.labels[g].end - mesh.labels[g].begin == m.tets.size()) set = label_sets[g];
    if (set.empty()) {
      set = element_sets.add("E_" + m.name);
      out << "*ELSET, ELSET=" << set << '\n';
      write_list(out, m.tets);
    }
    write_elastic(out, m.name, m.young_mpa, m.poisson, m.density_t_mm3);
    out << "*SOLID SECTION, ELSET=" << set << ", MATERIAL=" << m.name << '\n';
  }
  for (const ShellSet& s : sets.shells) {
    write_elastic(out, "M_" + s.name, s.young_mpa, s.poisson, s.density_t_mm3);
    out << "*SHELL SECTION, ELSET=" << s.name << ", MATERIAL=M_" << s.name << '\n';
    out.print20(s.thickness_mm);
    out << '\n';
  }
}

/// What parts do to each other. Ties are equations of nodes that lie on each other: exact, while CalculiX's *TIE misses some nodes at the
/// borders of its surfaces. An axis that a support holds is left out. Of a contact pair the first surface is the one whose nodes
/// follow (Abaqus's and CalculiX's slave).
void write_contact(OutputBuffer& out, const SolverSets& sets) {
  for (const Tie& t : sets.ties) {
    out << "** tie: the nodes of " << t.name << "\n*EQUATION\n";
    for (const Tie::Node& n : t.nodes)
      for (int axis = 0; axis < 3; ++axis)
        if (n.axes[axis]) out << "2\n" << n.node + 1 << ", " << axis + 1 << ", 1., " << n.followed + 1 << ", " << axis + 1 << ", -1.\n";
  }
  for (const SurfacePair& p : sets.pairs) {
    if (p.contact == Contact::none) out << "** surfaces that face each other: " << p.primary << " and " << p.secondary << '\n';
    if (p.contact != Contact::contact) continue;
    out << "** contact: pressure per mm of penetration, MPa/mm\n*SURFACE INTERACTION, NAME=" << p.name
        << "\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n";
    out.print20(p.stiffness_mpa_mm);
    out << '\n';
    if (p.friction > 0) {  // the second number is CalculiX's stick slope, MPa/mm; Abaqus reads it as a slip rate, on which nothing depends
      out << "*FRICTION\n";
      out.print20(p.friction);
      out << ", ";
      out.print20(0.1 * p.stiffness_mpa_mm);
      out << '\n';
    }
    out << "*CONTACT PAIR, INTERACTION=" << p.name << ", TYPE=SURFACE TO SURFACE\n" << p.primary << ", " << p.secondary << '\n';
  }
}

/// One static step with the supports and forces; where there is contact in up to ten increments.
void write_step(OutputBuffer& out, const SolverSets& sets) {
  if (!sets.has_load_case()) return;
  out << "*STEP\n*STATIC\n";
  if (sets.has_contact()) out << "0.1, 1.\n";
  for (const Support& s : sets.supports)
    for (int axis = 0; axis < 3; ++axis) {
      if (!s.value_mm[axis]) continue;
      out << "*BOUNDARY\n" << s.set << ", " << axis + 1 << ", " << axis + 1 << ", ";
      out.print20(*s.value_mm[axis]);
      out << '\n';
    }
  if (!sets.forces_n.empty()) out << "*CLOAD\n";
  for (const auto& [node, force] : sets.forces_n) {
    const double part[3] = {force.x, force.y, force.z};
    for (int axis = 0; axis < 3; ++axis) {
      if (part[axis] == 0) continue;
      out << node + 1 << ", " << axis + 1 << ", ";
      out.print20(part[axis]);
      out << '\n';
    }
  }
  out << "*NODE FILE\nU, RF\n*EL FILE\nS, E\n*END STEP\n";
}

}  // namespace

// Abaqus and CalculiX: at most 16 entries a line, 20 characters a number, 80 a name.
void write_inp(std::FILE* file, const PreparedMesh& mesh) {
  OutputBuffer out(file);
  out << "*HEADING\nstackmesh\n** units: mm, N, MPa, t/mm3\n";
  if (!mesh.space.empty()) out << "** " << mesh.space_mark() << '\n';
  out << "*NODE, NSET=NALL\n";
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    const Vec3 p = mesh.points[i];
    out << i + 1 << ", ";
    out.print20(p.x);
    out << ", ";
    out.print20(p.y);
    out << ", ";
    out.print20(p.z);
    out << '\n';
  }

  UniqueNames element_sets(80);
  element_sets.add("EALL");
  std::vector<std::string> label_sets;
  for (const LabelGroup& g : mesh.labels) {
    label_sets.push_back(element_sets.add(deck_name(g.name)));
    out << "** label " << g.label << ": " << g.name << "\n*ELEMENT, TYPE=" << (mesh.second_order() ? "C3D10" : "C3D4")
        << ", ELSET=" << label_sets.back() << '\n';
    for (std::size_t t = g.begin; t < g.end; ++t) {
      write_element(out, t + 1, mesh.tets[t], 4);
      if (mesh.second_order())
        for (const std::int32_t v : mesh.tet_mids[t]) out << ", " << v + 1;
      out << '\n';
    }
  }
  out << "*ELSET, ELSET=EALL, GENERATE\n1, " << mesh.tets.size() << ", 1\n";
  std::size_t number = mesh.tets.size();
  for (const ShellSet& s : mesh.sets.shells) {
    out << "** skin of label " << s.label << "\n*ELEMENT, TYPE=S3, ELSET=" << s.name << '\n';
    for (const TetFace f : s.faces)
      for (const auto& v : shells_of_three_nodes(mesh, f)) {
        write_element(out, ++number, v, 3);
        out << '\n';
      }
  }

  const SolverSets& sets = mesh.sets;
  for (std::size_t i = 0; i < std::max(sets.node_sets.size(), sets.surfaces.size()); ++i) {  // a surface behind its nodes
    if (i < sets.node_sets.size()) {
      if (!sets.node_sets[i].note.empty()) out << "** " << sets.node_sets[i].note << '\n';
      out << "*NSET, NSET=" << sets.node_sets[i].name << '\n';
      write_list(out, sets.node_sets[i].nodes);
    }
    if (i < sets.surfaces.size()) {
      if (!sets.surfaces[i].note.empty()) out << "** " << sets.surfaces[i].note << '\n';
      out << "*SURFACE, NAME=" << sets.surfaces[i].name << ", TYPE=ELEMENT\n";
      for (const TetFace f : sets.surfaces[i].faces) out << f.tet + 1 << ", S" << f.face + 1 << '\n';
    }
  }
  write_materials(out, mesh, label_sets, element_sets);
  write_contact(out, mesh.sets);
  write_step(out, mesh.sets);
}

// Medit, ASCII; version 2 stands for doubles.
void write_medit(std::FILE* file, const PreparedMesh& mesh) {
  if (mesh.second_order())
    fail_usage("second-order tetrahedra are not written to Medit's .mesh", "--order 2", "choose .vtu .msh .inp .feb .bdf or .vtk");
  OutputBuffer out(file);
  out << "MeshVersionFormatted 2\n# stackmesh, mm" << (mesh.space.empty() ? "" : ". " + mesh.space_mark())
      << '\n';
  for (std::size_t i = 0; i < mesh.pairs.size(); ++i)
    out << "# triangles of reference " << i + 1 << ": labels " << mesh.pairs[i].below << '|'
        << mesh.pairs[i].above << '\n';
  out << "Dimension 3\nVertices\n" << mesh.points.size() << '\n';
  for (const Vec3 p : mesh.points) out << p.x << ' ' << p.y << ' ' << p.z << " 0\n";
  out << "Triangles\n" << mesh.triangles.size() << '\n';
  for (std::size_t i = 0; i < mesh.pairs.size(); ++i)
    for (std::size_t t = mesh.pairs[i].begin; t < mesh.pairs[i].end; ++t) {
      const auto& v = mesh.triangles[t].v;
      out << v[0] + 1 << ' ' << v[1] + 1 << ' ' << v[2] + 1 << ' ' << i + 1 << '\n';
    }
  out << "Tetrahedra\n" << mesh.tets.size() << '\n';
  for (const LabelGroup& g : mesh.labels)
    for (std::size_t t = g.begin; t < g.end; ++t) {
      const auto& v = mesh.tets[t];
      out << v[0] + 1 << ' ' << v[1] + 1 << ' ' << v[2] + 1 << ' ' << v[3] + 1 << ' ' << g.label << '\n';
    }
  out << "End\n";
}

}  // namespace stackmesh
