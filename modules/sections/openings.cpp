#include "sections/openings.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

namespace stackmesh {
namespace {

constexpr std::size_t kMostOpenings = 12;

struct Opening {
  double length_mm = 0, x = 0, y = 0;  // places are sums, weighted with length
};

}  // namespace

std::string list_openings(const std::vector<OpenEdge>& edges, double z_mm, double thickness_mm) {
  std::map<std::int32_t, std::int32_t> parent;
  const auto find = [&](std::int32_t v) {
    auto at = parent.insert({v, v}).first;
    while (at->second != at->first) at = parent.find(at->second);
    return at->first;
  };
  for (const OpenEdge& e : edges) {
    const std::int32_t a = find(e.a), b = find(e.b);
    parent[std::max(a, b)] = std::min(a, b);
  }
  std::map<std::int32_t, Opening> by_root;
  for (const OpenEdge& e : edges) {
    const double length = std::hypot(e.to[0] - e.from[0], e.to[1] - e.from[1]);
    Opening& o = by_root[find(e.a)];
    o.length_mm += length;
    o.x += length * 0.5 * (e.from[0] + e.to[0]);
    o.y += length * 0.5 * (e.from[1] + e.to[1]);
  }
  std::vector<Opening> list;
  for (const auto& [root, o] : by_root)
    if (o.length_mm > 0) list.push_back(o);
  std::stable_sort(list.begin(), list.end(),
                   [](const Opening& a, const Opening& b) { return a.length_mm > b.length_mm; });
  std::string text;
  for (std::size_t i = 0; i < list.size() && i < kMostOpenings; ++i) {
    char one[120];
    std::snprintf(one, sizeof one, "%s %.3g mm2 at (%.1f, %.1f, %.6g)", i > 0 ? "," : "",
                  list[i].length_mm * thickness_mm, list[i].x / list[i].length_mm, list[i].y / list[i].length_mm, z_mm);
    text += one;
  }
  if (list.size() > kMostOpenings) text += ", and " + std::to_string(list.size() - kMostOpenings) + " smaller ones";
  return text;
}

}  // namespace stackmesh
