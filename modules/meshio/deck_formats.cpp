#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "meshio/formats.h"
#include "meshio/output_buffer.h"

namespace stackmesh {
namespace {

/// Corners of the faces S1 to S4 of C3D4.
constexpr int kDeckFaces[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};

struct TetFace {
  std::int64_t tet = -1;
  int face = 0;
};

/// For each triangle the tet of its label `below` (if that is 0, `above`) that has it as a face; every label
/// of the triangle but 0 must have one.
std::vector<TetFace> find_owners(const PreparedMesh& mesh) {
  // Triangles listed by their smallest corner.
  const auto smallest = [](const auto& v) { return std::min({v[0], v[1], v[2]}); };
  std::vector<std::size_t> begins(mesh.points.size() + 1, 0);
  std::vector<char> on_triangle(mesh.points.size(), 0);
  for (const InterfaceTriangle& t : mesh.triangles) {
    ++begins[smallest(t.v) + 1];
    for (const std::int32_t v : t.v) on_triangle[v] = 1;
  }
  for (std::size_t i = 0; i + 1 < begins.size(); ++i) begins[i + 1] += begins[i];
  std::vector<std::size_t> next(begins.begin(), begins.end() - 1), listed(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) listed[next[smallest(mesh.triangles[i].v)]++] = i;

  std::vector<TetFace> owners(mesh.triangles.size());
  std::vector<char> has_below(mesh.triangles.size(), 0), has_above(mesh.triangles.size(), 0);
  for (const LabelGroup& group : mesh.labels)
    for (std::size_t t = group.begin; t < group.end; ++t)
      for (int f = 0; f < 4; ++f) {
        std::array<std::int32_t, 3> face;
        bool candidate = true;
        for (int k = 0; k < 3; ++k) {
          face[k] = mesh.tets[t][kDeckFaces[f][k]];
          candidate = candidate && on_triangle[face[k]];
        }
        if (!candidate) continue;
        const std::int32_t first = smallest(face);
        for (std::size_t k = begins[first]; k < begins[first + 1]; ++k) {
          const InterfaceTriangle& triangle = mesh.triangles[listed[k]];
          if (group.label != triangle.below && group.label != triangle.above) continue;
          if (!std::is_permutation(face.begin(), face.end(), triangle.v.begin())) continue;
          (group.label == triangle.below ? has_below : has_above)[listed[k]] = 1;
          if (group.label == (triangle.below != 0 ? triangle.below : triangle.above))
            owners[listed[k]] = {static_cast<std::int64_t>(t), f};
        }
      }
  for (std::size_t i = 0; i < owners.size(); ++i)
    if ((mesh.triangles[i].below != 0 && !has_below[i]) || (mesh.triangles[i].above != 0 && !has_above[i]))
      fail_internal("an interface triangle is not a face of a tet of each of its labels",
                    "triangle " + std::to_string(i) + " between labels " +
                        std::to_string(mesh.triangles[i].below) + " and " +
                        std::to_string(mesh.triangles[i].above));
  return owners;
}

}  // namespace

// Abaqus and CalculiX: at most 16 entries a line, 20 characters a number, 80 a name.
void write_inp(std::FILE* file, const PreparedMesh& mesh) {
  const std::vector<TetFace> owners = find_owners(mesh);
  OutputBuffer out(file);
  out << "*HEADING\nstackmesh\n** units: mm\n";
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

  UniqueNames element_sets(80), node_sets(80), surfaces(80);
  element_sets.add("EALL");
  node_sets.add("NALL");
  for (const LabelGroup& g : mesh.labels) {
    out << "** label " << g.label << ": " << g.name
        << "\n*ELEMENT, TYPE=" << (mesh.second_order() ? "C3D10" : "C3D4") << ", ELSET=" << element_sets.add(deck_name(g.name)) << '\n';
    for (std::size_t t = g.begin; t < g.end; ++t) {
      const auto& v = mesh.tets[t];
      out << t + 1 << ", " << v[0] + 1 << ", " << v[1] + 1 << ", " << v[2] + 1 << ", " << v[3] + 1;
      if (mesh.second_order())
        for (const std::int32_t m : mesh.tet_mids[t]) out << ", " << m + 1;
      out << '\n';
    }
  }
  out << "*ELSET, ELSET=EALL, GENERATE\n1, " << mesh.tets.size() << ", 1\n";

  for (const PairGroup& g : mesh.pairs) {
    std::vector<std::int32_t> nodes;
    for (std::size_t t = g.begin; t < g.end; ++t) {
      nodes.insert(nodes.end(), mesh.triangles[t].v.begin(), mesh.triangles[t].v.end());
      if (mesh.second_order()) nodes.insert(nodes.end(), mesh.triangle_mids[t].begin(), mesh.triangle_mids[t].end());
    }
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    out << "** labels " << g.below << '|' << g.above << ": " << g.name
        << "\n*NSET, NSET=" << node_sets.add("N_" + deck_name(g.name)) << '\n';
    for (std::size_t i = 0; i < nodes.size(); ++i)
      out << nodes[i] + 1 << (i + 1 == nodes.size() ? "\n" : i % 16 == 15 ? ",\n" : ", ");
    out << "*SURFACE, NAME=" << surfaces.add("S_" + deck_name(g.name)) << ", TYPE=ELEMENT\n";
    for (std::size_t t = g.begin; t < g.end; ++t)
      out << owners[t].tet + 1 << ", S" << owners[t].face + 1 << '\n';
  }
}

// Medit, ASCII; version 2 stands for doubles.
void write_medit(std::FILE* file, const PreparedMesh& mesh) {
  if (mesh.second_order()) fail_usage("second-order tetrahedra are not written to Medit's .mesh", "--order 2", "choose .vtu .msh .inp or .vtk");
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
