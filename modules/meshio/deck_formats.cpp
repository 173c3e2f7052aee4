#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "meshio/abaqus_cards.h"
#include "meshio/element_nodes.h"
#include "meshio/formats.h"
#include "meshio/output_buffer.h"

namespace stackmesh {
namespace {

template <std::size_t N>
void write_element(OutputBuffer& out, std::size_t number, const std::array<std::int32_t, N>& nodes, std::size_t count) {
  out << number;
  for (std::size_t k = 0; k < count; ++k) out << ", " << nodes[k] + 1;
}

/// A face as shells of three nodes: Abaqus and CalculiX have none of six in common (STRI65, S6), so a second-order face
/// gets four.
std::vector<std::array<std::int32_t, 3>> shells_of_three_nodes(const PreparedMesh& mesh, TetFace face) {
  const auto v = mesh.outward_face(face);
  if (!mesh.second_order()) return {{v[0], v[1], v[2]}};
  return {{v[0], v[3], v[5]}, {v[3], v[1], v[4]}, {v[5], v[4], v[2]}, {v[3], v[4], v[5]}};
}

/// What parts do to each other. Ties are equations of nodes that lie on each other: exact, while CalculiX's *TIE misses
/// some nodes at the borders of its surfaces. An axis that a support holds is left out. Of a contact pair the first
/// surface is the one whose nodes follow (Abaqus's and CalculiX's slave).
void write_contact(OutputBuffer& out, const SolverSets& sets) {
  for (const Tie& t : sets.ties) {
    out << "** tie: the nodes of " << t.name << "\n*EQUATION\n";
    for (const Tie::Node& n : t.nodes)
      for (int axis = 0; axis < 3; ++axis)
        if (n.axes[axis])
          out << "2\n" << n.node + 1 << ", " << axis + 1 << ", 1., " << n.followed + 1 << ", " << axis + 1 << ", -1.\n";
  }
  for (const SurfacePair& p : sets.pairs) {
    if (p.contact == Contact::none)
      out << "** surfaces that face each other: " << p.primary << " and " << p.secondary << '\n';
    if (p.contact != Contact::contact) continue;
    out << "** contact: pressure per mm of penetration, MPa/mm\n*SURFACE INTERACTION, NAME=" << p.name
        << "\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n";
    out.print20(p.stiffness_mpa_mm);
    out << '\n';
    // the second number is CalculiX's stick slope, MPa/mm; Abaqus reads it as a slip rate, on which nothing depends
    if (p.friction > 0) {
      out << "*FRICTION\n";
      out.print20(p.friction);
      out << ", ";
      out.print20(0.1 * p.stiffness_mpa_mm);
      out << '\n';
    }
    out << "*CONTACT PAIR, INTERACTION=" << p.name << ", TYPE=SURFACE TO SURFACE\n"
        << p.primary << ", " << p.secondary << '\n';
  }
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
  // Pyramids, too: neither solver has them of both orders, so they are wedges whose third side is one edge.
  for (std::size_t g = 0; g < mesh.labels.size(); ++g) {
    if (mesh.labels[g].wedge_begin == mesh.labels[g].wedge_end) continue;
    out << "** layer of label " << mesh.labels[g].label
        << "\n*ELEMENT, TYPE=" << (mesh.second_order() ? "C3D15" : "C3D6") << ", ELSET=" << label_sets[g] << '\n';
    for (std::size_t w = mesh.labels[g].wedge_begin; w < mesh.labels[g].wedge_end; ++w) {
      write_element(out, mesh.tets.size() + w + 1, mesh.wedges[w], 6);
      if (mesh.second_order())
        for (const std::int32_t v : mesh.wedge_mids[w]) out << ", " << v + 1;
      out << '\n';
    }
  }
  out << "*ELSET, ELSET=EALL, GENERATE\n1, " << mesh.elements() << ", 1\n";
  std::size_t number = mesh.elements();
  for (const ShellSet& s : mesh.sets.shells) {
    out << "** skin of label " << s.label << "\n*ELEMENT, TYPE=S3, ELSET=" << s.name << '\n';
    for (const TetFace f : s.faces)
      for (const auto& v : shells_of_three_nodes(mesh, f)) {
        write_element(out, ++number, v, 3);
        out << '\n';
      }
  }

  const SolverSets& sets = mesh.sets;
  // a surface behind its nodes
  for (std::size_t i = 0; i < std::max(sets.node_sets.size(), sets.surfaces.size()); ++i) {
    if (i < sets.node_sets.size()) {
      if (!sets.node_sets[i].note.empty()) out << "** " << sets.node_sets[i].note << '\n';
      out << "*NSET, NSET=" << sets.node_sets[i].name << '\n';
      abaqus_list(out, sets.node_sets[i].nodes);
    }
    if (i < sets.surfaces.size()) {
      if (!sets.surfaces[i].note.empty()) out << "** " << sets.surfaces[i].note << '\n';
      out << "*SURFACE, NAME=" << sets.surfaces[i].name << ", TYPE=ELEMENT\n";
      for (const TetFace f : sets.surfaces[i].faces) out << f.tet + 1 << ", S" << f.face + 1 << '\n';
    }
  }
  abaqus_materials(out, mesh, label_sets, element_sets);
  write_contact(out, mesh.sets);
  abaqus_points_and_springs(out, mesh, number);
  abaqus_steps(out, mesh);
}

// Medit, ASCII; version 2 stands for doubles.
void write_medit(std::FILE* file, const PreparedMesh& mesh) {
  if (mesh.second_order())
    fail_usage("second-order tetrahedra are not written to Medit's .mesh", "--order 2",
               "choose .vtu .msh .inp .feb .bdf or .vtk");
  OutputBuffer out(file);
  out << "MeshVersionFormatted 2\n# stackmesh, mm" << (mesh.space.empty() ? "" : ". " + mesh.space_mark()) << '\n';
  for (std::size_t i = 0; i < mesh.pairs.size(); ++i)
    out << "# triangles of reference " << i + 1 << ": labels " << mesh.pairs[i].below << '|' << mesh.pairs[i].above
        << '\n';
  out << "Dimension 3\nVertices\n" << mesh.points.size() << '\n';
  for (const Vec3 p : mesh.points) out << p.x << ' ' << p.y << ' ' << p.z << " 0\n";
  out << "Triangles\n" << mesh.triangles.size() << '\n';
  for (std::size_t i = 0; i < mesh.pairs.size(); ++i)
    for (std::size_t t = mesh.pairs[i].begin; t < mesh.pairs[i].end; ++t) {
      const auto& v = mesh.triangles[t].v;
      out << v[0] + 1 << ' ' << v[1] + 1 << ' ' << v[2] + 1 << ' ' << i + 1 << '\n';
    }
  std::size_t tets = mesh.tets.size();
  for (const auto& w : mesh.wedges) tets += tets_of_wedge(w).size();
  out << "Tetrahedra\n" << tets << '\n';
  for (const LabelGroup& g : mesh.labels)
    for (std::size_t t = g.begin; t < g.end; ++t) {
      const auto& v = mesh.tets[t];
      out << v[0] + 1 << ' ' << v[1] + 1 << ' ' << v[2] + 1 << ' ' << v[3] + 1 << ' ' << g.label << '\n';
    }
  for (const LabelGroup& g : mesh.labels)
    for (std::size_t w = g.wedge_begin; w < g.wedge_end; ++w)
      for (const auto& v : tets_of_wedge(mesh.wedges[w]))
        out << v[0] + 1 << ' ' << v[1] + 1 << ' ' << v[2] + 1 << ' ' << v[3] + 1 << ' ' << g.label << '\n';
  out << "End\n";
}

}  // namespace stackmesh
