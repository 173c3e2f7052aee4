#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "base/error.h"
#include "meshio/formats.h"
#include "meshio/output_buffer.h"

namespace stackmesh {
namespace {

/// The first tag of the surfaces: beyond the labels, so that no tag stands for two things.
std::int32_t first_surface_tag(const PreparedMesh& mesh) {
  std::int64_t last = 0;
  for (const LabelGroup& g : mesh.labels) {
    if (g.label <= 0)
      fail_output("Gmsh numbers its volumes from 1", "label " + std::to_string(g.label),
                  "renumber the label or write another format");
    last = std::max<std::int64_t>(last, g.label);
  }
  if (last + static_cast<std::int64_t>(mesh.pairs.size()) > std::numeric_limits<std::int32_t>::max())
    fail_output("no Gmsh tag is left for the surfaces", "label " + std::to_string(last),
                "renumber the label or write another format");
  return static_cast<std::int32_t>(last) + 1;
}

void write_names(OutputBuffer& out, const PreparedMesh& mesh, std::int32_t surface_tag) {
  if (!mesh.space.empty()) out << "$Comments\n" << mesh.space_mark() << ", mm\n$EndComments\n";
  out << "$PhysicalNames\n" << mesh.pairs.size() + mesh.labels.size() << '\n';
  for (std::size_t i = 0; i < mesh.pairs.size(); ++i)
    out << "2 " << surface_tag + static_cast<std::int32_t>(i) << " \"" << mesh.pairs[i].name << "\"\n";
  for (const LabelGroup& g : mesh.labels) out << "3 " << g.label << " \"" << g.name << "\"\n";
  out << "$EndPhysicalNames\n";
}

struct Box {
  Vec3 low{std::numeric_limits<double>::max(), std::numeric_limits<double>::max(),
           std::numeric_limits<double>::max()};
  Vec3 high = -1.0 * low;
  void add(Vec3 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
};

/// Gmsh's element types.
int triangle_type(const PreparedMesh& mesh) { return mesh.second_order() ? 9 : 2; }
int tet_type(const PreparedMesh& mesh) { return mesh.second_order() ? 11 : 4; }

void write_triangle(OutputBuffer& out, const PreparedMesh& mesh, std::size_t i) {
  for (const std::int32_t v : mesh.triangles[i].v) out << ' ' << v + 1;
  if (mesh.second_order())
    for (const std::int32_t v : mesh.triangle_mids[i]) out << ' ' << v + 1;
  out << '\n';
}

/// Gmsh has the last two mid-side nodes the other way round: on edges 23, 13.
void write_tet(OutputBuffer& out, const PreparedMesh& mesh, std::size_t i) {
  for (const std::int32_t v : mesh.tets[i]) out << ' ' << v + 1;
  if (mesh.second_order())
    for (const int k : {0, 1, 2, 3, 5, 4}) out << ' ' << mesh.tet_mids[i][k] + 1;
  out << '\n';
}

/// An entity of Gmsh's: a surface between two labels, or the volume of one. It owns the nodes that no entity
/// before it owns, surfaces first.
struct Entity {
  int dimension = 2;
  std::int32_t tag = 0;
  Box box;
  std::vector<std::int32_t> nodes;
  std::string bounds;  ///< of a volume: its surfaces, negative where their normals point into it
  int bound_count = 0;
};

std::vector<Entity> make_entities(const PreparedMesh& mesh, std::int32_t surface_tag) {
  std::vector<Entity> entities;
  std::vector<char> owned(mesh.points.size(), 0);
  const auto take = [&](Entity& entity, std::int32_t v) {
    entity.box.add(mesh.points[v]);
    if (!owned[v]) entity.nodes.push_back(v);
    owned[v] = 1;
  };
  for (std::size_t i = 0; i < mesh.pairs.size(); ++i) {
    Entity entity;
    entity.tag = surface_tag + static_cast<std::int32_t>(i);
    for (std::size_t t = mesh.pairs[i].begin; t < mesh.pairs[i].end; ++t) {
      for (const std::int32_t v : mesh.triangles[t].v) take(entity, v);
      if (mesh.second_order())
        for (const std::int32_t v : mesh.triangle_mids[t]) take(entity, v);
    }
    entities.push_back(std::move(entity));
  }
  for (const LabelGroup& group : mesh.labels) {
    Entity entity;
    entity.dimension = 3;
    entity.tag = group.label;
    for (std::size_t t = group.begin; t < group.end; ++t) {
      for (const std::int32_t v : mesh.tets[t]) take(entity, v);
      if (mesh.second_order())
        for (const std::int32_t v : mesh.tet_mids[t]) take(entity, v);
    }
    for (std::size_t i = 0; i < mesh.pairs.size(); ++i) {
      if (mesh.pairs[i].below != group.label && mesh.pairs[i].above != group.label) continue;
      entity.bounds += mesh.pairs[i].below == group.label ? " " : " -";
      entity.bounds += std::to_string(surface_tag + static_cast<std::int32_t>(i));
      ++entity.bound_count;
    }
    entities.push_back(std::move(entity));
  }
  for (Entity& entity : entities) std::sort(entity.nodes.begin(), entity.nodes.end());
  return entities;
}

}  // namespace

void write_msh4(std::FILE* file, const PreparedMesh& mesh) {
  const std::int32_t surface_tag = first_surface_tag(mesh);
  const std::vector<Entity> entities = make_entities(mesh, surface_tag);
  OutputBuffer out(file);
  out << "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
  write_names(out, mesh, surface_tag);

  out << "$Entities\n0 0 " << mesh.pairs.size() << ' ' << mesh.labels.size() << '\n';
  for (const Entity& e : entities) {
    out << e.tag;
    for (const Vec3 p : {e.box.low, e.box.high}) out << ' ' << p.x << ' ' << p.y << ' ' << p.z;
    out << " 1 " << e.tag << ' ' << e.bound_count << e.bounds << '\n';
  }
  out << "$EndEntities\n";

  const auto blocks =
      std::count_if(entities.begin(), entities.end(), [](const Entity& e) { return !e.nodes.empty(); });
  out << "$Nodes\n"
      << static_cast<std::int64_t>(blocks) << ' ' << mesh.points.size() << " 1 " << mesh.points.size()
      << '\n';
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
  const std::size_t count = mesh.triangles.size() + mesh.tets.size();
  out << "$Elements\n" << entities.size() << ' ' << count << " 1 " << count << '\n';
  for (std::size_t i = 0; i < mesh.pairs.size(); ++i) {
    const PairGroup& g = mesh.pairs[i];
    out << "2 " << surface_tag + static_cast<std::int32_t>(i) << ' ' << triangle_type(mesh) << ' ' << g.end - g.begin << '\n';
    for (std::size_t t = g.begin; t < g.end; ++t) {
      out << mesh.tets.size() + t + 1;
      write_triangle(out, mesh, t);
    }
  }
  for (const LabelGroup& g : mesh.labels) {
    out << "3 " << g.label << ' ' << tet_type(mesh) << ' ' << g.end - g.begin << '\n';
    for (std::size_t t = g.begin; t < g.end; ++t) {
      out << t + 1;
      write_tet(out, mesh, t);
    }
  }
  out << "$EndElements\n";
}

void write_msh2(std::FILE* file, const PreparedMesh& mesh) {
  const std::int32_t surface_tag = first_surface_tag(mesh);
  OutputBuffer out(file);
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  write_names(out, mesh, surface_tag);
  out << "$Nodes\n" << mesh.points.size() << '\n';
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    const Vec3 p = mesh.points[i];
    out << i + 1 << ' ' << p.x << ' ' << p.y << ' ' << p.z << '\n';
  }
  out << "$EndNodes\n$Elements\n" << mesh.triangles.size() + mesh.tets.size() << '\n';
  // Number, type, two tags (physical group and entity, the same here), corners.
  for (const LabelGroup& g : mesh.labels)
    for (std::size_t t = g.begin; t < g.end; ++t) {
      out << t + 1 << ' ' << tet_type(mesh) << " 2 " << g.label << ' ' << g.label;
      write_tet(out, mesh, t);
    }
  for (std::size_t i = 0; i < mesh.pairs.size(); ++i)
    for (std::size_t t = mesh.pairs[i].begin; t < mesh.pairs[i].end; ++t) {
      const std::int32_t tag = surface_tag + static_cast<std::int32_t>(i);
      out << mesh.tets.size() + t + 1 << ' ' << triangle_type(mesh) << " 2 " << tag << ' ' << tag;
      write_triangle(out, mesh, t);
    }
  out << "$EndElements\n";
}

}  // namespace stackmesh
