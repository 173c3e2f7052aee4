// LocalOperations::unfold: a pleat of a sheet is cut out along a loop of edges and the hole is filled by its best
// triangulation.
#include <algorithm>
#include <cmath>

#include "enhance/local_operations.h"
#include "model/triangle_contact.h"

namespace stackmesh {
namespace {

constexpr std::size_t kMostTriangles = 48, kLongestLoop = 18;  // of what is cut out
constexpr double kUpright = 0.3;    // cosine: the least between a new triangle's normal and that of the loop
constexpr double kTurned = -0.5;    // cosine: a triangle beyond the loop that faces away more is a part of the pleat
constexpr double kThickness = 0.3;  // of the edge length: vertices that go are no further from the new triangles

/// Adds what is missing of the vertex's star, if that lies in one patch and is not frozen.
bool add_star(const ComplexMesh& mesh, std::int32_t v, std::vector<std::int32_t>& region) {
  for (std::int32_t t : mesh.star[v]) {
    if (mesh.is_frozen(t) || (!region.empty() && mesh.triangles[t].patch != mesh.triangles[region[0]].patch))
      return false;
    if (std::find(region.begin(), region.end(), t) == region.end()) region.push_back(t);
  }
  return region.size() <= kMostTriangles;
}

/// The loop of edges round a region, in the direction of its triangles; empty when there is not one that visits each
/// vertex once.
std::vector<std::int32_t> loop_round(const ComplexMesh& mesh, const std::vector<std::int32_t>& region) {
  std::vector<std::array<std::int32_t, 2>> rim;
  for (std::int32_t t : region)
    for (int k = 0; k < 3; ++k) {
      const std::array<std::int32_t, 2> back{mesh.triangles[t].v[(k + 1) % 3], mesh.triangles[t].v[k]};
      const auto it = std::find(rim.begin(), rim.end(), back);
      if (it != rim.end()) rim.erase(it);
      else rim.push_back({back[1], back[0]});
    }
  std::vector<std::int32_t> loop;
  if (rim.size() < 3 || rim.size() > kLongestLoop) return loop;
  loop.push_back(rim[0][0]);
  for (std::int32_t at = rim[0][1]; at != loop[0];) {
    if (loop.size() == rim.size() || std::find(loop.begin(), loop.end(), at) != loop.end()) return {};
    loop.push_back(at);
    const auto next = std::find_if(rim.begin(), rim.end(), [&](const auto& e) { return e[0] == at; });
    if (next == rim.end()) return {};
    at = (*next)[1];
  }
  if (loop.size() != rim.size()) return {};
  return loop;
}

}  // namespace

bool LocalOperations::may_vanish(std::int32_t v) const {
  return !mesh_.is_held(v) && !mesh_.pinned[v] && !mesh_.flat[v] && mesh_.curve[v].empty();
}

bool LocalOperations::fill_loop(const std::vector<std::int32_t>& region, const std::vector<std::int32_t>& loop,
                                const Vec3& normal) {
  const int n = static_cast<int>(loop.size());
  const auto inside = [&](std::int32_t t) { return std::find(region.begin(), region.end(), t) != region.end(); };
  // A side of a new triangle that is no side of the loop must not be an edge elsewhere.
  std::vector<std::int32_t> around;
  const auto is_free = [&](int i, int j) {
    if (j - i == 1 || (i == 0 && j == n - 1)) return true;
    if (!mesh_.has_edge(loop[i], loop[j])) return true;
    mesh_.edge_triangles(loop[i], loop[j], around);
    return std::all_of(around.begin(), around.end(), inside);
  };
  // The triangulation with the largest smallest angle, by parts of the loop.
  std::vector<double> best(n * n, -1);
  std::vector<int> apex(n * n, -1);
  for (int i = 0; i + 1 < n; ++i) best[i * n + i + 1] = 10;
  for (int span = 2; span < n; ++span)
    for (int i = 0; i + span < n; ++i) {
      const int j = i + span;
      if (!is_free(i, j)) continue;
      for (int k = i + 1; k < j; ++k) {
        double worst = std::min(best[i * n + k], best[k * n + j]);
        if (worst <= best[i * n + j]) continue;
        const std::array<std::int32_t, 3> t{loop[i], loop[k], loop[j]};
        const Vec3 a = mesh_.area_vector(t);
        if (!(dot(a, normal) > kUpright * norm(a))) continue;
        worst = std::min(worst, angle(t));
        if (worst <= best[i * n + j]) continue;
        best[i * n + j] = worst;
        apex[i * n + j] = k;
      }
    }
  double before = 10;
  for (std::int32_t t : region) before = std::min(before, angle(mesh_.triangles[t].v));
  if (best[n - 1] < before) return false;
  added_.clear();
  std::vector<std::array<int, 2>> open = {{0, n - 1}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i < 2) continue;
    const int k = apex[i * n + j];
    added_.push_back({loop[i], loop[k], loop[j]});
    open.push_back({i, k});
    open.push_back({k, j});
  }
  // Neither may what goes be far from what comes, nor the other way round.
  const auto from = [&](const Vec3& p, const std::array<std::int32_t, 3>& t) {
    return norm(p - nearest_on_triangle(p, mesh_.points[t[0]], mesh_.points[t[1]], mesh_.points[t[2]]));
  };
  const double thick = kThickness * size_[loop[0]];
  for (std::int32_t t : region)
    for (std::int32_t v : mesh_.triangles[t].v)
      if (std::none_of(added_.begin(), added_.end(), [&](const auto& a) { return from(mesh_.points[v], a) <= thick; }))
        return false;
  for (const auto& a : added_) {
    const Vec3 middle = (1 / 3.0) * (mesh_.points[a[0]] + mesh_.points[a[1]] + mesh_.points[a[2]]);
    if (std::none_of(region.begin(), region.end(),
                     [&](std::int32_t t) { return from(middle, mesh_.triangles[t].v) <= thick; }))
      return false;
  }
  removed_ = region;
  Change change;
  change.removed = &removed_;
  change.added = &added_;
  change.clearance_mm = 1e-6 * size_[loop[0]];
  if (!guard.allows(change)) return false;
  mesh_.replace_disc(removed_, added_);
  guard.update(removed_);
  ++counts.collapses;
  return true;
}

bool LocalOperations::unfold(std::int32_t triangle) {
  const auto corners = mesh_.triangles[triangle].v;
  for (std::int32_t first : corners) {
    if (!may_vanish(first)) continue;
    std::vector<std::int32_t> region;
    if (!add_star(mesh_, first, region)) continue;
    for (int step = 0; step < 8; ++step) {
      const std::vector<std::int32_t> loop = loop_round(mesh_, region);
      if (loop.empty()) break;
      Vec3 area;
      for (std::size_t i = 1; i + 1 < loop.size(); ++i)
        area = area + mesh_.area_vector({loop[0], loop[i], loop[i + 1]});
      const double l = norm(area);
      if (!(l > 0)) break;
      const Vec3 normal = (1 / l) * area;
      const auto along = [&](std::int32_t t) {
        const Vec3 a = mesh_.area_vector(mesh_.triangles[t].v);
        return norm(a) > 0 ? dot(a, normal) / norm(a) : -1;
      };
      const bool pleated = std::any_of(region.begin(), region.end(), [&](std::int32_t t) { return along(t) < 0; });
      // Vertices of the loop whose triangles face away from it belong to the pleat, the worst first.
      std::int32_t next = -1;
      double worst = 1, beyond = 1;
      for (std::int32_t v : loop)
        for (std::int32_t t : mesh_.star[v]) {
          if (mesh_.triangles[t].patch != mesh_.triangles[triangle].patch) continue;
          const double here = along(t);
          if (std::find(region.begin(), region.end(), t) == region.end()) beyond = std::min(beyond, here);
          if (here < worst && may_vanish(v)) {
            worst = here;
            next = v;
          }
        }
      // A disc: as many triangles as its vertices within and on the loop mean.
      std::vector<std::int32_t> vertices;
      for (std::int32_t t : region)
        vertices.insert(vertices.end(), mesh_.triangles[t].v.begin(), mesh_.triangles[t].v.end());
      std::sort(vertices.begin(), vertices.end());
      vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
      const std::size_t within = vertices.size() - loop.size();
      if (region.size() == 2 * within + loop.size() - 2 && pleated && beyond > kTurned &&
          fill_loop(region, loop, normal))
        return true;
      if (next < 0 || !add_star(mesh_, next, region)) break;
    }
  }
  return false;
}

}  // namespace stackmesh
