#include "enhance/ridges.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace stackmesh {

std::size_t mark_ridges(ComplexMesh& mesh, double feature_deg, double length_mm) {
  const double limit = std::cos(feature_deg * M_PI / 180);
  std::map<std::int32_t, std::vector<std::int32_t>> sharp;
  std::vector<std::int32_t> around;
  for (const auto& [a, b] : mesh.edges()) {
    if (mesh.is_curve_edge(a, b)) continue;
    mesh.edge_triangles(a, b, around);
    const Vec3 n = mesh.area_vector(mesh.triangles[around[0]].v), m = mesh.area_vector(mesh.triangles[around[1]].v);
    if (dot(n, m) > limit * norm(n) * norm(m)) continue;
    sharp[a].push_back(b);
    sharp[b].push_back(a);
  }
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
      for (int side = 0; side < 2; ++side) {
        std::int32_t from = side ? b : a, v = side ? a : b;
        for (std::int32_t w = next(from, v); w >= 0; w = next(from, v)) {
          const std::array<std::int32_t, 2> e = {std::min(v, w), std::max(v, w)};
          if (seen[e]) break;
          seen[e] = 1;
          chain.push_back(e);
          length += norm(mesh.points[w] - mesh.points[v]);
          from = v;
          v = w;
        }
      }
      if (length >= length_mm) chosen.insert(chosen.end(), chain.begin(), chain.end());
    }
  for (const auto& [a, b] : chosen) {
    mesh.add_ridge(a, b);
    ++count;
  }
  if (count) mesh.find_pinned();
  return count;
}

}  // namespace stackmesh
