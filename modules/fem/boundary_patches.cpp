#include "fem/boundary_patches.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>

#include "base/disjoint_sets.h"

namespace stackmesh {
namespace {

struct Border {
  std::int32_t a = 0, b = 0;  // places in the list of faces
  double length = 0;
  bool sharp = false, wall = false;
};

/// Edges that exactly two of the faces share.
std::vector<Border> borders(const std::vector<BoundaryFace>& all, const Patch& faces, const std::vector<char>& wall,
                            double sharp_deg) {
  struct Edge {
    std::int32_t low, high, face;
  };
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const auto& v = all[faces[i]].v;
      edges.push_back({std::min(v[k], v[(k + 1) % 3]), std::max(v[k], v[(k + 1) % 3]), static_cast<std::int32_t>(i)});
    }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.face < b.face;
  });
  const double flat = std::cos(sharp_deg * M_PI / 180);
  std::vector<Border> found;
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
    if (end - i == 2) {
      const std::int32_t a = edges[i].face, b = edges[i + 1].face;
      const BoundaryFace &f = all[faces[a]], &g = all[faces[b]];
      // The edge's length from the two triangles' areas and centres is not at hand: areas' root is a fair weight.
      found.push_back({a, b, std::sqrt(std::min(f.area_mm2, g.area_mm2)), dot(f.normal, g.normal) < flat,
                       wall[faces[a]] != wall[faces[b]]});
    }
    i = end;
  }
  return found;
}

}  // namespace

std::vector<Patch> split_at_sharp_edges(const std::vector<BoundaryFace>& all, const Patch& faces,
                                        const std::vector<char>& wall, const PatchOptions& options) {
  const std::vector<Border> edges = borders(all, faces, wall, options.sharp_deg);
  const auto sharp = std::count_if(edges.begin(), edges.end(), [](const Border& b) { return b.sharp; });
  const bool staircase = static_cast<std::size_t>(sharp) * 4 > edges.size();
  DisjointSets components(faces.size()), patches(faces.size());
  for (const Border& b : edges) {
    components.join(b.a, b.b);
    if (!b.wall && (staircase || !b.sharp)) patches.join(b.a, b.b);
  }
  std::vector<double> of_component(faces.size(), 0), of_patch(faces.size(), 0);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    of_component[components.find(static_cast<std::int32_t>(i))] += all[faces[i]].area_mm2;
    of_patch[patches.find(static_cast<std::int32_t>(i))] += all[faces[i]].area_mm2;
  }
  // The smallest patch that is too small joins the neighbour with the longest common border, until none is.
  for (;;) {
    std::int32_t smallest = -1;
    std::map<std::int32_t, std::map<std::int32_t, double>> neighbours;
    for (const Border& b : edges) {
      const std::int32_t p = patches.find(b.a), q = patches.find(b.b);
      if (p == q || b.wall) continue;
      neighbours[p][q] += b.length;
      neighbours[q][p] += b.length;
    }
    for (const auto& [p, next] : neighbours)
      if (of_patch[p] < options.least_share * of_component[components.find(p)] &&
          (smallest < 0 || of_patch[p] < of_patch[smallest]))
        smallest = p;
    if (smallest < 0) break;
    std::int32_t best = -1;
    double longest = -1;
    for (const auto& [q, length] : neighbours[smallest])
      if (length > longest) {
        longest = length;
        best = q;
      }
    const double area = of_patch[smallest] + of_patch[best];
    patches.join(smallest, best);
    of_patch[patches.find(best)] = area;
  }
  std::map<std::int32_t, Patch> by_root;
  for (std::size_t i = 0; i < faces.size(); ++i)
    by_root[patches.find(static_cast<std::int32_t>(i))].push_back(faces[i]);
  std::vector<Patch> result;
  for (auto& [root, patch] : by_root) result.push_back(std::move(patch));
  const auto area_of = [&](const Patch& p) {
    double area = 0;
    for (const std::int32_t f : p) area += all[f].area_mm2;
    return area;
  };
  std::stable_sort(result.begin(), result.end(),
                   [&](const Patch& a, const Patch& b) { return area_of(a) > area_of(b); });
  return result;
}

void join_islands(const std::vector<BoundaryFace>& all, const Patch& surface, double least_share,
                  std::vector<Patch>& patches) {
  std::int32_t points = 0;
  for (const std::int32_t f : surface) points = std::max({points, all[f].v[0] + 1, all[f].v[1] + 1, all[f].v[2] + 1});
  DisjointSets shells(static_cast<std::size_t>(points));
  for (const std::int32_t f : surface)
    for (const int k : {1, 2}) shells.join(all[f].v[0], all[f].v[k]);
  std::vector<double> areas;
  double total = 0;
  for (const Patch& p : patches) {
    areas.push_back(0);
    for (const std::int32_t f : p) areas.back() += all[f].area_mm2;
    total += areas.back();
  }
  std::size_t large = 0;
  while (large < patches.size() && areas[large] >= least_share * total) ++large;
  std::vector<Patch> kept(patches.begin(), patches.begin() + static_cast<std::ptrdiff_t>(large)), alone;
  for (std::size_t i = large; i < patches.size(); ++i) {
    const BoundaryFace& island = all[patches[i][0]];
    double nearest = std::numeric_limits<double>::max();
    std::size_t best = large;
    for (std::size_t j = 0; j < large; ++j)
      for (const std::int32_t f : patches[j]) {
        const double distance = norm(all[f].centre - island.centre);
        if (distance >= nearest || shells.find(all[f].v[0]) != shells.find(island.v[0])) continue;
        nearest = distance;
        best = j;
      }
    if (best == large) alone.push_back(patches[i]);
    else kept[best].insert(kept[best].end(), patches[i].begin(), patches[i].end());
  }
  kept.insert(kept.end(), alone.begin(), alone.end());
  patches = std::move(kept);
}

Patch flat_cap(const TetMesh& mesh, const std::vector<BoundaryFace>& all, const Patch& faces, Vec3 up) {
  double top = -std::numeric_limits<double>::max(), area = 0;
  for (const std::int32_t f : faces) {
    area += all[f].area_mm2;
    for (const std::int32_t v : all[f].v) top = std::max(top, dot(up, mesh.points[v]));
  }
  if (faces.empty()) return {};
  const double edge = std::sqrt(area / static_cast<double>(faces.size()));
  Patch cap;
  for (const std::int32_t f : faces) {
    bool flat = dot(all[f].normal, up) > 0.99;
    for (const std::int32_t v : all[f].v) flat = flat && dot(up, mesh.points[v]) > top - 0.02 * edge;
    if (flat) cap.push_back(f);
  }
  if (cap.size() < 2) return {};  // the topmost triangle of a round end may lie level
  return cap;
}

}  // namespace stackmesh
