#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "base/error.h"
#include "meshio/element_nodes.h"
#include "meshio/formats.h"
#include "meshio/output_buffer.h"

namespace stackmesh {
namespace {

/// Triangles of one elementary surface, and the physical groups that it is part of.
struct Patch {
  Label below = 0, above = 0;
  std::vector<std::array<std::int32_t, 6>> triangles;  ///< mid-side nodes last, -1 in a linear mesh
  std::vector<std::size_t> groups;
};

/// The surfaces of a mesh as Gmsh has them. A mere mesh has a patch and a group for each pair of labels; in a solver
/// model the named surfaces are the groups, and a patch is what lies in the same ones.
struct Surfaces {
  std::vector<Patch> patches;
  std::vector<std::string> groups;

  std::vector<const NodeSet*> points;  ///< sets of nodes that are not those of a surface: groups of dimension 0

  explicit Surfaces(const PreparedMesh& mesh) {
    for (const NodeSet& n : mesh.sets.node_sets)
      if (std::none_of(mesh.sets.surfaces.begin(), mesh.sets.surfaces.end(),
                       [&](const FaceSet& f) { return f.name == n.name; }))
        points.push_back(&n);
    if (mesh.sets.surfaces.empty()) from_pairs(mesh);
    else from_sets(mesh);
  }
  std::size_t point_count() const {
    std::size_t n = 0;
    for (const NodeSet* set : points) n += set->nodes.size();
    return n;
  }
  /// The tag of a set of nodes, behind those of the surfaces.
  std::int32_t point_tag(std::int32_t surface_tag, std::size_t i) const {
    return surface_tag + static_cast<std::int32_t>(std::max(groups.size(), patches.size()) + i);
  }
  std::size_t triangles() const {
    std::size_t n = 0;
    for (const Patch& p : patches) n += p.triangles.size();
    return n;
  }

 private:
  void from_pairs(const PreparedMesh& mesh) {
    for (const PairGroup& g : mesh.pairs) {
      Patch patch{g.below, g.above, {}, {groups.size()}};
      groups.push_back(g.name);
      for (std::size_t t = g.begin; t < g.end; ++t) {
        const auto& v = mesh.triangles[t].v;
        const std::array<std::int32_t, 3> m =
            mesh.second_order() ? mesh.triangle_mids[t] : std::array<std::int32_t, 3>{-1, -1, -1};
        patch.triangles.push_back({v[0], v[1], v[2], m[0], m[1], m[2]});
      }
      patches.push_back(std::move(patch));
    }
  }

  /// Faces that lie on each other, from either side of an interface whose nodes are shared, are one triangle.
  void from_sets(const PreparedMesh& mesh) {
    struct Face {
      std::array<std::int32_t, 6> nodes;
      Label below = 0, above = 0;
      std::vector<std::size_t> groups;
    };
    std::map<std::array<std::int32_t, 3>, Face> faces;
    const auto add = [&](TetFace f, std::size_t group) {
      const std::array<std::int32_t, 6> nodes = mesh.outward_face(f);
      std::array<std::int32_t, 3> key = {nodes[0], nodes[1], nodes[2]};
      std::sort(key.begin(), key.end());
      const Label label = label_of(mesh, f.tet);
      const auto [at, fresh] = faces.insert({key, {nodes, label, 0, {}}});
      if (!fresh && at->second.below != label) at->second.above = label;
      if (at->second.groups.empty() || at->second.groups.back() != group) at->second.groups.push_back(group);
    };
    for (const FaceSet& set : mesh.sets.surfaces) {
      for (const TetFace f : set.faces) add(f, groups.size());
      groups.push_back(set.name);
    }
    for (const ShellSet& set : mesh.sets.shells) {
      for (const TetFace f : set.faces) add(f, groups.size());
      groups.push_back(set.name);
    }
    std::map<std::tuple<Label, Label, std::vector<std::size_t>>, Patch> by_key;
    for (const auto& [key, face] : faces) {
      Patch& patch = by_key[{face.below, face.above, face.groups}];
      patch.below = face.below;
      patch.above = face.above;
      patch.groups = face.groups;
      patch.triangles.push_back(face.nodes);
    }
    for (auto& [key, patch] : by_key) patches.push_back(std::move(patch));
  }

  static Label label_of(const PreparedMesh& mesh, std::int32_t tet) {
    const auto element = static_cast<std::size_t>(tet);
    for (const LabelGroup& g : mesh.labels)
      if (element < mesh.tets.size() ? element < g.end : element - mesh.tets.size() < g.wedge_end) return g.label;
    return 0;
  }
};

/// The first tag of the surfaces: beyond the labels, so that no tag stands for two things.
std::int32_t first_surface_tag(const PreparedMesh& mesh, const Surfaces& surfaces) {
  std::int64_t last = 0;
  for (const LabelGroup& g : mesh.labels) {
    if (g.label <= 0)
      fail_output("Gmsh numbers its volumes from 1", "label " + std::to_string(g.label),
                  "renumber the label or write another format");
    last = std::max<std::int64_t>(last, g.label);
  }
  if (last + static_cast<std::int64_t>(std::max(surfaces.groups.size(), surfaces.patches.size()) +
                                       surfaces.points.size()) >
      std::numeric_limits<std::int32_t>::max())
    fail_output("no Gmsh tag is left for the surfaces", "label " + std::to_string(last),
                "renumber the label or write another format");
  return static_cast<std::int32_t>(last) + 1;
}

void write_names(OutputBuffer& out, const PreparedMesh& mesh, const Surfaces& surfaces, std::int32_t surface_tag) {
  if (!mesh.space.empty()) out << "$Comments\n" << mesh.space_mark() << ", mm\n$EndComments\n";
  out << "$PhysicalNames\n" << surfaces.points.size() + surfaces.groups.size() + mesh.labels.size() << '\n';
  for (std::size_t i = 0; i < surfaces.points.size(); ++i)
    out << "0 " << surfaces.point_tag(surface_tag, i) << " \"" << surfaces.points[i]->name << "\"\n";
  for (std::size_t i = 0; i < surfaces.groups.size(); ++i)
    out << "2 " << surface_tag + static_cast<std::int32_t>(i) << " \"" << surfaces.groups[i] << "\"\n";
  for (const LabelGroup& g : mesh.labels) out << "3 " << g.label << " \"" << g.name << "\"\n";
  out << "$EndPhysicalNames\n";
}

struct Box {
  Vec3 low{std::numeric_limits<double>::max(), std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
  Vec3 high = -1.0 * low;
  void add(Vec3 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
};

/// An entity of Gmsh's: a surface between two labels, or the volume of one. It owns the nodes that no entity
/// before it owns, surfaces first.
struct Entity {
  int dimension = 2;
  std::int32_t tag = 0;
  Box box;
  std::vector<std::int32_t> nodes;
  std::string physical;  ///< its groups
  std::size_t physical_count = 1;
  std::string bounds;  ///< of a volume: its surfaces, negative where their normals point into it
  int bound_count = 0;
};

std::vector<Entity> make_entities(const PreparedMesh& mesh, const Surfaces& surfaces, std::int32_t surface_tag) {
  std::vector<Entity> entities;
  std::vector<char> owned(mesh.points.size(), 0);
  const auto take = [&](Entity& entity, std::int32_t v) {
    entity.box.add(mesh.points[v]);
    if (!owned[v]) entity.nodes.push_back(v);
    owned[v] = 1;
  };
  for (std::size_t i = 0; i < surfaces.patches.size(); ++i) {
    const Patch& patch = surfaces.patches[i];
    Entity entity;
    entity.tag = surface_tag + static_cast<std::int32_t>(i);
    entity.physical_count = patch.groups.size();
    for (const std::size_t g : patch.groups)
      entity.physical += " " + std::to_string(surface_tag + static_cast<std::int32_t>(g));
    for (const auto& t : patch.triangles)
      for (const std::int32_t v : t)
        if (v >= 0) take(entity, v);
    entities.push_back(std::move(entity));
  }
  for (const LabelGroup& group : mesh.labels) {
    Entity entity;
    entity.dimension = 3;
    entity.tag = group.label;
    entity.physical = " " + std::to_string(group.label);
    for (std::size_t t = group.begin; t < group.end; ++t) {
      for (const std::int32_t v : mesh.tets[t]) take(entity, v);
      if (mesh.second_order())
        for (const std::int32_t v : mesh.tet_mids[t]) take(entity, v);
    }
    for (std::size_t w = group.wedge_begin; w < group.wedge_end; ++w)
      for (const std::int32_t v : wedge_nodes_of(mesh, w, WedgeOrder::gmsh)) take(entity, v);
    for (std::size_t i = 0; i < surfaces.patches.size(); ++i) {
      const Patch& patch = surfaces.patches[i];
      if (patch.below != group.label && patch.above != group.label) continue;
      entity.bounds += patch.below == group.label ? " " : " -";
      entity.bounds += std::to_string(surface_tag + static_cast<std::int32_t>(i));
      ++entity.bound_count;
    }
    entities.push_back(std::move(entity));
  }
  for (Entity& entity : entities) std::sort(entity.nodes.begin(), entity.nodes.end());
  return entities;
}

/// Nodes of a triangle (of 3 or 6), and of a tet: Gmsh has the last two mid-side nodes of a tet the other way round.
void write_triangle(OutputBuffer& out, const std::array<std::int32_t, 6>& nodes) {
  for (const std::int32_t v : nodes)
    if (v >= 0) out << ' ' << v + 1;
  out << '\n';
}
void write_tet(OutputBuffer& out, const PreparedMesh& mesh, std::size_t t) {
  for (const std::int32_t v : mesh.tets[t]) out << ' ' << v + 1;
  if (mesh.second_order())
    for (const int e : {0, 1, 2, 3, 5, 4}) out << ' ' << mesh.tet_mids[t][e] + 1;
  out << '\n';
}

/// Wedges and pyramids of a label, apart: a block has one type.
struct WedgeBlocks {
  std::vector<std::size_t> of[2];
  WedgeBlocks(const PreparedMesh& mesh, const LabelGroup& g) {
    for (std::size_t w = g.wedge_begin; w < g.wedge_end; ++w) of[is_pyramid(mesh.wedges[w])].push_back(w);
  }
  static int type(const PreparedMesh& mesh, int pyramid) {
    return mesh.second_order() ? (pyramid ? 19 : 18) : (pyramid ? 7 : 6);
  }
  std::size_t blocks() const {
    return static_cast<std::size_t>(!of[0].empty()) + static_cast<std::size_t>(!of[1].empty());
  }
};
void write_wedge(OutputBuffer& out, const PreparedMesh& mesh, std::size_t w) {
  for (const std::int32_t v : wedge_nodes_of(mesh, w, WedgeOrder::gmsh)) out << ' ' << v + 1;
  out << '\n';
}

}  // namespace

void write_msh4(std::FILE* file, const PreparedMesh& mesh) {
  const Surfaces surfaces(mesh);
  const std::int32_t surface_tag = first_surface_tag(mesh, surfaces);
  const std::vector<Entity> entities = make_entities(mesh, surfaces, surface_tag);
  OutputBuffer out(file);
  out << "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
  write_names(out, mesh, surfaces, surface_tag);

  // A set of nodes is an entity with a point element at each of them; the nodes are owned by surfaces and volumes.
  out << "$Entities\n"
      << surfaces.points.size() << " 0 " << surfaces.patches.size() << ' ' << mesh.labels.size() << '\n';
  for (std::size_t i = 0; i < surfaces.points.size(); ++i) {
    const std::int32_t tag = surfaces.point_tag(surface_tag, i);
    const Vec3 p = mesh.points[surfaces.points[i]->nodes.at(0)];
    out << tag << ' ' << p.x << ' ' << p.y << ' ' << p.z << " 1 " << tag << '\n';
  }
  for (const Entity& e : entities) {
    out << e.tag;
    for (const Vec3 p : {e.box.low, e.box.high}) out << ' ' << p.x << ' ' << p.y << ' ' << p.z;
    out << ' ' << e.physical_count << e.physical << ' ' << e.bound_count << e.bounds << '\n';
  }
  out << "$EndEntities\n";

  const auto blocks = std::count_if(entities.begin(), entities.end(), [](const Entity& e) { return !e.nodes.empty(); });
  out << "$Nodes\n"
      << static_cast<std::int64_t>(blocks) << ' ' << mesh.points.size() << " 1 " << mesh.points.size() << '\n';
  for (const Entity& e : entities) {
    if (e.nodes.empty()) continue;
    out << e.dimension << ' ' << e.tag << " 0 " << e.nodes.size() << '\n';
    for (const std::int32_t v : e.nodes) out << v + 1 << '\n';
    for (const std::int32_t v : e.nodes) {
      const Vec3 p = mesh.points[v];
      out << p.x << ' ' << p.y << ' ' << p.z << '\n';
    }
  }
  out << "$EndNodes\n";

  // Tets first in number, so that a tet has the same number in every format.
  const std::size_t count = surfaces.triangles() + mesh.elements() + surfaces.point_count();
  std::size_t element_blocks = surfaces.points.size() + entities.size();
  for (const LabelGroup& g : mesh.labels) element_blocks += WedgeBlocks(mesh, g).blocks();
  out << "$Elements\n" << element_blocks << ' ' << count << " 1 " << count << '\n';
  std::size_t number = mesh.elements() + surfaces.triangles();
  for (std::size_t i = 0; i < surfaces.points.size(); ++i) {
    out << "0 " << surfaces.point_tag(surface_tag, i) << " 15 " << surfaces.points[i]->nodes.size() << '\n';
    for (const std::int32_t v : surfaces.points[i]->nodes) out << ++number << ' ' << v + 1 << '\n';
  }
  number = mesh.elements();
  for (std::size_t i = 0; i < surfaces.patches.size(); ++i) {
    const Patch& patch = surfaces.patches[i];
    out << "2 " << surface_tag + static_cast<std::int32_t>(i) << (mesh.second_order() ? " 9 " : " 2 ")
        << patch.triangles.size() << '\n';
    for (const auto& t : patch.triangles) {
      out << ++number;
      write_triangle(out, t);
    }
  }
  for (const LabelGroup& g : mesh.labels) {
    out << "3 " << g.label << (mesh.second_order() ? " 11 " : " 4 ") << g.end - g.begin << '\n';
    for (std::size_t t = g.begin; t < g.end; ++t) {
      out << t + 1;
      write_tet(out, mesh, t);
    }
    const WedgeBlocks wedges(mesh, g);
    for (const int pyramid : {0, 1}) {
      if (wedges.of[pyramid].empty()) continue;
      out << "3 " << g.label << ' ' << WedgeBlocks::type(mesh, pyramid) << ' ' << wedges.of[pyramid].size() << '\n';
      for (const std::size_t w : wedges.of[pyramid]) {
        out << mesh.tets.size() + w + 1;
        write_wedge(out, mesh, w);
      }
    }
  }
  out << "$EndElements\n";
}

void write_msh2(std::FILE* file, const PreparedMesh& mesh) {
  const Surfaces surfaces(mesh);
  const std::int32_t surface_tag = first_surface_tag(mesh, surfaces);
  OutputBuffer out(file);
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  write_names(out, mesh, surfaces, surface_tag);
  out << "$Nodes\n" << mesh.points.size() << '\n';
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    const Vec3 p = mesh.points[i];
    out << i + 1 << ' ' << p.x << ' ' << p.y << ' ' << p.z << '\n';
  }
  // This version has one group an element: a triangle of several is written once for each, as Gmsh does.
  std::size_t count = mesh.elements() + surfaces.point_count();
  for (const Patch& patch : surfaces.patches) count += patch.groups.size() * patch.triangles.size();
  out << "$EndNodes\n$Elements\n" << count << '\n';
  // Number, type, two tags (physical group and entity), nodes.
  for (const LabelGroup& g : mesh.labels)
    for (std::size_t t = g.begin; t < g.end; ++t) {
      out << t + 1 << (mesh.second_order() ? " 11 2 " : " 4 2 ") << g.label << ' ' << g.label;
      write_tet(out, mesh, t);
    }
  for (const LabelGroup& g : mesh.labels)
    for (std::size_t w = g.wedge_begin; w < g.wedge_end; ++w) {
      out << mesh.tets.size() + w + 1 << ' ' << WedgeBlocks::type(mesh, is_pyramid(mesh.wedges[w])) << " 2 " << g.label
          << ' ' << g.label;
      write_wedge(out, mesh, w);
    }
  std::size_t number = mesh.elements();
  for (std::size_t i = 0; i < surfaces.patches.size(); ++i)
    for (const std::size_t g : surfaces.patches[i].groups)
      for (const auto& t : surfaces.patches[i].triangles) {
        out << ++number << (mesh.second_order() ? " 9 2 " : " 2 2 ") << surface_tag + static_cast<std::int32_t>(g)
            << ' ' << surface_tag + static_cast<std::int32_t>(i);
        write_triangle(out, t);
      }
  for (std::size_t i = 0; i < surfaces.points.size(); ++i)
    for (const std::int32_t v : surfaces.points[i]->nodes) {
      const std::int32_t tag = surfaces.point_tag(surface_tag, i);
      out << ++number << " 15 2 " << tag << ' ' << tag << ' ' << v + 1 << '\n';
    }
  out << "$EndElements\n";
}

}  // namespace stackmesh
