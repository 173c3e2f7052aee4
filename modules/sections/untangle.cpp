#include <algorithm>
#include <array>
#include <unordered_map>

#include "model/edge_grid.h"
#include "sections/arcs.h"

namespace stackmesh {
namespace {

constexpr int kHalvings = 3;  // after which a vertex is at home

struct Vertex {
  GridPoint home, way;  // way: to where it is faired to
  int halved = 0;
  GridPoint place() const {
    if (halved >= kHalvings) return home;
    return {home.x + way.x / (1 << halved), home.y + way.y / (1 << halved)};
  }
};

std::uint64_t key(GridPoint p) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(p.x)) << 32) | static_cast<std::uint32_t>(p.y);
}

}  // namespace

std::size_t untangle(std::vector<Arc>& arcs) {
  // Arcs share their ends; a home belongs to one vertex.
  std::vector<Vertex> vertices;
  std::unordered_map<std::uint64_t, std::int32_t> number;
  std::vector<std::array<std::int32_t, 2>> edges;
  std::vector<std::vector<std::int32_t>> chains(arcs.size());
  for (std::size_t a = 0; a < arcs.size(); ++a)
    for (const CrackVertex& v : arcs[a].chain) {
      const auto [it, fresh] = number.emplace(key(v.home), static_cast<std::int32_t>(vertices.size()));
      if (fresh) vertices.push_back({v.home, {v.position.x - v.home.x, v.position.y - v.home.y}});
      if (!chains[a].empty()) edges.push_back({chains[a].back(), it->second});
      chains[a].push_back(it->second);
    }
  std::vector<char> changed(vertices.size(), 0);
  std::vector<GridSegment> segments(edges.size());
  for (bool any = true; any;) {
    any = false;
    for (std::size_t e = 0; e < edges.size(); ++e)
      segments[e] = {vertices[edges[e][0]].place(), vertices[edges[e][1]].place()};
    const EdgeGrid grid(segments);
    std::vector<char> offends(vertices.size(), 0);
    for (std::size_t e = 0; e < edges.size(); ++e) {
      if (segments[e].a == segments[e].b) offends[edges[e][0]] = offends[edges[e][1]] = 1;
      grid.near_segment(segments[e], [&](std::int32_t k) {
        if (static_cast<std::size_t>(k) >= e || !clash(segments[e], segments[k])) return;
        for (std::int32_t v : {edges[e][0], edges[e][1], edges[k][0], edges[k][1]}) offends[v] = 1;
      });
    }
    for (std::size_t v = 0; v < vertices.size(); ++v)
      if (offends[v] && vertices[v].halved < kHalvings) {
        ++vertices[v].halved;
        changed[v] = 1;
        any = true;
      }
  }
  for (std::size_t a = 0; a < arcs.size(); ++a)
    for (std::size_t i = 0; i < chains[a].size(); ++i) arcs[a].chain[i].position = vertices[chains[a][i]].place();
  return static_cast<std::size_t>(std::count(changed.begin(), changed.end(), 1));
}

}  // namespace stackmesh
