#include "report/join_cells.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

namespace stackmesh {
namespace {

/// For each vertex the number of the set of labels that meet there; 0: of no triangle.
std::vector<std::int32_t> label_sets(const DrawnSurface& fine) {
  std::vector<std::int32_t> set_of(fine.points.size(), 0);
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> extended;  // (set, label) -> set
  std::vector<std::vector<std::int32_t>> sets = {{}};
  std::map<std::vector<std::int32_t>, std::int32_t> known = {{{}, 0}};
  for (const DrawnTriangle& t : fine.triangles)
    for (const std::int32_t v : t.v)
      for (const std::int32_t label : {t.below, t.above}) {
        const auto [it, fresh] = extended.emplace(std::pair(set_of[v], label), 0);
        if (fresh) {
          std::vector<std::int32_t> larger = sets[set_of[v]];
          const auto at = std::lower_bound(larger.begin(), larger.end(), label);
          if (at == larger.end() || *at != label) larger.insert(at, label);
          const auto [found, is_new] = known.emplace(larger, static_cast<std::int32_t>(sets.size()));
          if (is_new) sets.push_back(larger);
          it->second = found->second;
        }
        set_of[v] = it->second;
      }
  return set_of;
}

struct Key {
  std::int32_t x, y, z, set;
  bool operator==(const Key& o) const { return x == o.x && y == o.y && z == o.z && set == o.set; }
};
struct Hash {
  std::size_t operator()(const Key& k) const {
    std::uint64_t h = 1469598103934665603u;
    for (const std::int32_t part : {k.x, k.y, k.z, k.set}) h = (h ^ static_cast<std::uint32_t>(part)) * 1099511628211u;
    return h ^ h >> 29;
  }
};

/// The triangles between clusters, each once, with the smallest angle of those it stands for.
std::vector<DrawnTriangle> without_doubles(const std::vector<DrawnTriangle>& fine,
                                           const std::vector<std::int32_t>& cluster_of) {
  struct Corner {
    std::array<std::int32_t, 3> sorted;
    std::int32_t triangle;
  };
  std::vector<Corner> corners;
  std::vector<DrawnTriangle> out;
  for (std::size_t t = 0; t < fine.size(); ++t) {
    std::array<std::int32_t, 3> c = {cluster_of[fine[t].v[0]], cluster_of[fine[t].v[1]], cluster_of[fine[t].v[2]]};
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
    std::sort(c.begin(), c.end());
    corners.push_back({c, static_cast<std::int32_t>(t)});
  }
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
    return a.sorted != b.sorted ? a.sorted < b.sorted : a.triangle < b.triangle;
  });
  for (std::size_t i = 0, j; i < corners.size(); i = j) {
    DrawnTriangle t = fine[corners[i].triangle];
    for (std::int32_t& v : t.v) v = cluster_of[v];
    for (j = i; j < corners.size() && corners[j].sorted == corners[i].sorted; ++j)
      t.angle = std::min(t.angle, fine[corners[j].triangle].angle);
    out.push_back(t);
  }
  return out;
}

}  // namespace

DrawnSurface join_cells(const DrawnSurface& fine, double cell_units) {
  const std::vector<std::int32_t> set_of = label_sets(fine);
  std::unordered_map<Key, std::int32_t, Hash> clusters;
  std::vector<std::int32_t> cluster_of(fine.points.size(), -1);
  std::vector<std::array<double, 4>> sums;
  DrawnSurface coarse;
  for (std::size_t v = 0; v < fine.points.size(); ++v) {
    if (set_of[v] == 0) continue;  // of no triangle
    const GridCell& p = fine.points[v];
    const Key key = {static_cast<std::int32_t>(p[0] / cell_units), static_cast<std::int32_t>(p[1] / cell_units),
                     static_cast<std::int32_t>(p[2] / cell_units), set_of[v]};
    const std::int32_t c = clusters.emplace(key, static_cast<std::int32_t>(sums.size())).first->second;
    if (c == static_cast<std::int32_t>(sums.size())) {
      sums.push_back({0, 0, 0, 0});
      if (!fine.distances_mm.empty()) coarse.distances_mm.push_back(0);
    }
    cluster_of[v] = c;
    for (int k = 0; k < 3; ++k) sums[c][k] += p[k];
    sums[c][3] += 1;
    if (!fine.distances_mm.empty()) coarse.distances_mm[c] = std::max(coarse.distances_mm[c], fine.distances_mm[v]);
  }
  for (const auto& s : sums)
    coarse.points.push_back({static_cast<std::uint16_t>(std::lround(s[0] / s[3])),
                             static_cast<std::uint16_t>(std::lround(s[1] / s[3])),
                             static_cast<std::uint16_t>(std::lround(s[2] / s[3]))});
  coarse.triangles = without_doubles(fine.triangles, cluster_of);
  return coarse;
}

}  // namespace stackmesh
