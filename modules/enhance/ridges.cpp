#include "enhance/ridges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/parallel.h"

namespace stackmesh {
namespace {

constexpr double kUpright = 0.7;  // rise of an edge that runs from section to section, of its length

/// Centre and area vector of every triangle.
struct Facets {
  std::vector<Vec3> centre, area;
  Facets(const ComplexMesh& mesh, int threads) : centre(mesh.triangles.size()), area(mesh.triangles.size()) {
    for_each_index(centre.size(), threads, [&](std::size_t t) {
      const auto& v = mesh.triangles[t].v;
      centre[t] = (1 / 3.0) * (mesh.points[v[0]] + mesh.points[v[1]] + mesh.points[v[2]]);
      area[t] = mesh.area_vector(v);
    });
  }
};

/// Mean normal of the triangles within `reach` of the edge a b that are connected to `start` and lie on its
/// side of the edge: over treads and risers of a staircase alike.
Vec3 wide_normal(const ComplexMesh& mesh, const Facets& facets, std::int32_t a, std::int32_t b, std::int32_t start,
                 std::int32_t other, double reach, std::vector<std::int32_t>& stamp, std::int32_t now,
                 std::vector<std::int32_t>& list) {
  const Vec3 middle = 0.5 * (mesh.points[a] + mesh.points[b]), along = mesh.points[b] - mesh.points[a];
  Vec3 across = facets.centre[start] - facets.centre[other];
  across = across - (dot(across, along) / std::max(1e-300, dot(along, along))) * along;
  list.assign(1, start);
  stamp[start] = now;
  Vec3 sum;
  for (std::size_t i = 0; i < list.size() && list.size() < 200; ++i) {
    sum = sum + facets.area[list[i]];
    for (std::int32_t v : mesh.triangles[list[i]].v)
      for (std::int32_t t : mesh.star[v]) {
        if (stamp[t] == now) continue;
        stamp[t] = now;
        const Vec3 d = facets.centre[t] - middle;
        if (dot(d, d) < reach * reach && dot(d, across) > 0 && mesh.triangles[t].patch == mesh.triangles[start].patch)
          list.push_back(t);
      }
  }
  return sum;
}

bool is_upright(const ComplexMesh& mesh, const RidgeOptions& o, std::int32_t a, std::int32_t b) {
  const Vec3 d = mesh.points[b] - mesh.points[a];
  return o.upright_deg > 0 && std::abs(d.z) > kUpright * norm(d);
}

/// Neighbours of each vertex along edges at which the surface is bent sharply, between its two triangles and over
/// wider places beside them.
std::map<std::int32_t, std::vector<std::int32_t>> sharp_edges(const ComplexMesh& mesh, const RidgeOptions& o) {
  const auto limit = [&](bool upright, double share) {
    return std::cos(share * (upright ? o.upright_deg : o.feature_deg) * M_PI / 180);
  };
  const Facets facets(mesh, o.threads);
  const std::vector<std::array<std::int32_t, 2>> edges = mesh.edges();
  std::vector<char> is_sharp(edges.size(), 0);
  for_each_index(edges.size(), o.threads, [&](std::size_t e) {
    const auto [a, b] = edges[e];
    if (mesh.is_curve_edge(a, b)) return;
    ShortList around;
    for (std::int32_t t : mesh.star[a])
      if (mesh.triangles[t].v[0] == b || mesh.triangles[t].v[1] == b || mesh.triangles[t].v[2] == b)
        around.push_back(t);
    const Vec3 &n = facets.area[around[0]], &m = facets.area[around[1]];
    is_sharp[e] = dot(n, m) <= limit(is_upright(mesh, o, a, b), 1) * norm(n) * norm(m);
  });
  const std::size_t run = edges.size() / 16 + 1;
  parallel_for(16, o.threads, [&](std::size_t part) {
    std::vector<std::int32_t> around, list, stamp(mesh.triangles.size(), 0);
    std::int32_t now = 0;
    for (std::size_t e = part * run; e < std::min(edges.size(), (part + 1) * run); ++e) {
      if (!is_sharp[e]) continue;
      const auto [a, b] = edges[e];
      mesh.edge_triangles(a, b, around);
      const bool upright = is_upright(mesh, o, a, b);
      const double reach = upright ? o.upright_reach_mm : 0.375 * o.length_mm;
      const Vec3 left = wide_normal(mesh, facets, a, b, around[0], around[1], reach, stamp, ++now, list);
      const Vec3 right = wide_normal(mesh, facets, a, b, around[1], around[0], reach, stamp, ++now, list);
      is_sharp[e] = dot(left, right) <= limit(upright, 0.75) * norm(left) * norm(right);
    }
  });
  std::map<std::int32_t, std::vector<std::int32_t>> sharp;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (!is_sharp[e]) continue;
    sharp[edges[e][0]].push_back(edges[e][1]);
    sharp[edges[e][1]].push_back(edges[e][0]);
  }
  return sharp;
}

}  // namespace

std::size_t mark_ridges(ComplexMesh& mesh, const RidgeOptions& o) {
  std::map<std::int32_t, std::vector<std::int32_t>> sharp = sharp_edges(mesh, o);
  // Chains go on where exactly two sharp edges meet, nearly straight; a bundle of sharp edges is noise.
  const auto next = [&](std::int32_t from, std::int32_t v) {
    const auto& list = sharp[v];
    if (list.size() != 2 || !mesh.curve[v].empty()) return -1;
    const std::int32_t w = list[0] == from ? list[1] : list[0];
    const Vec3 d = mesh.points[v] - mesh.points[from], e = mesh.points[w] - mesh.points[v];
    return dot(d, e) > 0.7 * norm(d) * norm(e) ? w : -1;
  };
  std::size_t count = 0;
  std::vector<std::array<std::int32_t, 2>> chain, chosen;
  std::map<std::array<std::int32_t, 2>, char> seen;
  for (const auto& [a, list] : sharp)
    for (std::int32_t b : list) {
      if (a > b || seen[{a, b}]) continue;
      chain.assign(1, {a, b});
      seen[{a, b}] = 1;
      double length = norm(mesh.points[a] - mesh.points[b]);
      bool upright = is_upright(mesh, o, a, b);
      int caps = 0;  // ends of the chain on a curve, such as the rim of a cap
      for (int side = 0; side < 2; ++side) {
        std::int32_t from = side ? b : a, v = side ? a : b;
        for (std::int32_t w = next(from, v); w >= 0; w = next(from, v)) {
          const std::array<std::int32_t, 2> e = {std::min(v, w), std::max(v, w)};
          if (seen[e]) break;
          seen[e] = 1;
          chain.push_back(e);
          length += norm(mesh.points[w] - mesh.points[v]);
          upright = upright && is_upright(mesh, o, v, w);
          from = v;
          v = w;
        }
        caps += !mesh.curve[v].empty();
      }
      if (length >= o.length_mm || (upright && (length >= o.upright_length_mm || caps == 2)))
        chosen.insert(chosen.end(), chain.begin(), chain.end());
    }
  for (const auto& [a, b] : chosen) {
    mesh.add_ridge(a, b);
    ++count;
  }
  if (count) mesh.find_pinned(o.threads);
  return count;
}

}  // namespace stackmesh
