// The sets that a deck of a mere mesh gets: its interfaces, and materials to be replaced.
#include <algorithm>
#include <set>

#include "base/error.h"
#include "meshio/prepared_mesh.h"

namespace stackmesh {

std::vector<TetFace> face_owners(const PreparedMesh& mesh, bool both_sides) {
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

  std::vector<TetFace> owners(mesh.triangles.size(), {-1, 0});
  std::vector<char> has_below(mesh.triangles.size(), 0), has_above(mesh.triangles.size(), 0);
  for (const LabelGroup& group : mesh.labels)
    mesh.each_element(group, [&](std::size_t t) {
      for (int f = 0; f < (t < mesh.tets.size() ? 4 : 2); ++f) {
        std::array<std::int32_t, 3> face;
        bool candidate = true;
        for (int k = 0; k < 3; ++k) {
          face[k] = t < mesh.tets.size() ? mesh.tets[t][kTetFaces[f][k]]
                                         : mesh.wedges[t - mesh.tets.size()][kWedgeFaces[f][k]];
          candidate = candidate && on_triangle[face[k]];
        }
        if (!candidate) continue;
        const std::int32_t first = smallest(face);
        for (std::size_t k = begins[first]; k < begins[first + 1]; ++k) {
          const InterfaceTriangle& triangle = mesh.triangles[listed[k]];
          if (group.label != triangle.below && group.label != triangle.above) continue;
          if (!std::is_permutation(face.begin(), face.end(), triangle.v.begin())) continue;
          const bool below = group.label == triangle.below;
          (below ? has_below : has_above)[listed[k]] = 1;
          if (below || has_below[listed[k]] == 0) owners[listed[k]] = {static_cast<std::int32_t>(t), f};
        }
      }
    });
  std::set<Label> filled;  // a label without tets is a void
  for (const LabelGroup& group : mesh.labels) filled.insert(group.label);
  for (std::size_t i = 0; i < owners.size(); ++i) {
    const InterfaceTriangle& t = mesh.triangles[i];
    const bool below = filled.count(t.below) == 0 || has_below[i] != 0,
               above = filled.count(t.above) == 0 || has_above[i] != 0;
    if (owners[i].tet < 0 || (both_sides && !(below && above)))
      fail_internal("an interface triangle is not a face of a tet of each of its labels",
                    "triangle " + std::to_string(i) + " between labels " + std::to_string(mesh.triangles[i].below) +
                        " and " + std::to_string(mesh.triangles[i].above));
  }
  return owners;
}

void add_interface_sets(PreparedMesh& mesh) {
  const std::vector<TetFace> owners = face_owners(mesh, true);
  UniqueNames node_sets(80), surfaces(80), materials(78);
  node_sets.add("NALL");
  for (const PairGroup& g : mesh.pairs) {
    NodeSet nodes;
    FaceSet faces;
    nodes.note = "labels " + std::to_string(g.below) + '|' + std::to_string(g.above) + ": " + g.name;
    nodes.name = node_sets.add("N_" + deck_name(g.name));
    faces.name = surfaces.add("S_" + deck_name(g.name));
    for (std::size_t t = g.begin; t < g.end; ++t) {
      nodes.nodes.insert(nodes.nodes.end(), mesh.triangles[t].v.begin(), mesh.triangles[t].v.end());
      if (mesh.second_order())
        nodes.nodes.insert(nodes.nodes.end(), mesh.triangle_mids[t].begin(), mesh.triangle_mids[t].end());
      faces.faces.push_back(owners[t]);
    }
    std::sort(nodes.nodes.begin(), nodes.nodes.end());
    nodes.nodes.erase(std::unique(nodes.nodes.begin(), nodes.nodes.end()), nodes.nodes.end());
    mesh.sets.node_sets.push_back(std::move(nodes));
    mesh.sets.surfaces.push_back(std::move(faces));
  }
  mesh.sets.placeholder_materials = true;
  for (const LabelGroup& g : mesh.labels) {
    ElementMaterial m;
    m.name = materials.add("M_" + deck_name(g.name));
    m.label = g.label;
    m.young_mpa = 1;
    m.poisson = 0.3;
    mesh.each_element(g, [&](std::size_t t) { m.tets.push_back(static_cast<std::int32_t>(t)); });
    mesh.sets.materials.push_back(std::move(m));
  }
}

const std::vector<std::int32_t>& nodes_of(const SolverSets& sets, const std::string& name) {
  for (const NodeSet& s : sets.node_sets)
    if (s.name == name) return s.nodes;
  fail_internal("a step or point names a set that is not there", name);
}

std::vector<std::int32_t> material_of_tets(const PreparedMesh& mesh) {
  std::vector<std::int32_t> material(mesh.elements(), 0);
  for (std::size_t i = 0; i < mesh.sets.materials.size(); ++i)
    for (const std::int32_t t : mesh.sets.materials[i].tets) material[t] = static_cast<std::int32_t>(i);
  return material;
}

const LoadStep* first_static_step(const SolverSets& sets) {
  const auto found = std::find_if(sets.steps.begin(), sets.steps.end(),
                                  [](const LoadStep& s) { return s.analysis == Analysis::statics; });
  return found == sets.steps.end() ? nullptr : &*found;
}

}  // namespace stackmesh
