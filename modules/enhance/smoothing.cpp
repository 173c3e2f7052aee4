#include "enhance/smoothing.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "enhance/guard.h"

namespace stackmesh {
namespace {

/// Whom each vertex averages over: its neighbours, on a curve those along it, none for a fixed point.
struct Neighbours {
  std::vector<std::size_t> first;
  std::vector<std::int32_t> list;

  Neighbours(const ComplexMesh& mesh, int threads) {
    std::vector<ShortList> of(mesh.points.size());
    for_each_index(of.size(), threads, [&](std::size_t n) {
      const auto v = static_cast<std::int32_t>(n);
      if (mesh.star[v].empty() || mesh.is_fixed(v)) return;
      if (!mesh.curve[v].empty()) {
        of[v] = mesh.curve[v];
        return;
      }
      for (std::int32_t t : mesh.star[v])
        for (std::int32_t w : mesh.triangles[t].v)
          if (w != v && std::find(of[v].begin(), of[v].end(), w) == of[v].end()) of[v].push_back(w);
      std::sort(of[v].begin(), of[v].end());
    });
    first.push_back(0);
    for (const ShortList& l : of) {
      list.insert(list.end(), l.begin(), l.end());
      first.push_back(list.size());
    }
  }

  Vec3 mean(const std::vector<Vec3>& p, std::size_t v) const {
    Vec3 sum;
    for (std::size_t i = first[v]; i < first[v + 1]; ++i) sum = sum + p[list[i]];
    return (1.0 / static_cast<double>(first[v + 1] - first[v])) * sum;
  }
  bool moves(std::size_t v) const { return first[v] != first[v + 1]; }
};

/// Places of the vertices at which every label has the volume requested, to first order: label l grows by offset[l]
/// along its normals; between a and b the sheet moves by the difference.
std::vector<Vec3> places_of_volumes(const ComplexMesh& mesh, const std::map<Label, double>& volumes, double limit_mm,
                                    int threads) {
  std::map<Label, double> lack = volumes, offset, area;
  for (const auto& [label, v] : label_volumes(mesh)) lack[label] -= v;
  std::vector<double> shared(mesh.pair_count(), 0);
  for (const MeshTriangle& t : mesh.triangles)
    if (t.patch >= 0 && !mesh.is_cap(t.patch)) shared[t.patch >> 1] += norm(mesh.area_vector(t.v));
  const auto labels = [&](std::size_t pair) { return mesh.labels_of(static_cast<std::int32_t>(2 * pair)); };
  for (std::size_t p = 0; p < shared.size(); ++p)
    for (Label l : {labels(p).first, labels(p).second}) area[l] += shared[p];
  for (int pass = 0; pass < 60; ++pass)
    for (const auto& [label, missing] : lack) {
      if (label == 0 || !(area[label] > 0)) continue;
      double sum = missing;
      for (std::size_t p = 0; p < shared.size(); ++p) {
        const auto [below, above] = labels(p);
        if (below == label && above != 0) sum += shared[p] * offset[above];
        if (above == label && below != 0) sum += shared[p] * offset[below];
      }
      offset[label] = std::clamp(sum / area[label], -limit_mm, limit_mm);
    }
  offset[0] = 0;
  std::vector<double> step(shared.size());
  for (std::size_t p = 0; p < step.size(); ++p) step[p] = offset[labels(p).first] - offset[labels(p).second];
  std::vector<Vec3> targets = mesh.points;
  for_each_index(targets.size(), threads, [&](std::size_t v) {
    if (mesh.star[v].empty() || mesh.is_fixed(static_cast<std::int32_t>(v))) return;
    Vec3 move;
    double sum = 0;
    for (std::int32_t t : mesh.star[v]) {
      const std::int32_t patch = mesh.triangles[t].patch;
      if (mesh.is_cap(patch)) continue;
      const Vec3 a = mesh.area_vector(mesh.triangles[t].v);
      move = move + step[patch >> 1] * a;
      sum += norm(a);
    }
    if (!(sum > 0)) return;
    if (mesh.flat[v]) move.z = 0;
    targets[v] = targets[v] + (1 / sum) * move;
  });
  return targets;
}

double mean_edge(const ComplexMesh& mesh) {
  double sum = 0;
  std::size_t count = 0;
  for (const MeshTriangle& t : mesh.triangles)
    if (t.patch >= 0)
      for (int k = 0; k < 3; ++k, ++count) sum += norm(mesh.points[t.v[k]] - mesh.points[t.v[(k + 1) % 3]]);
  return count ? sum / static_cast<double>(count) : 1;
}

}  // namespace

std::vector<Vec3> smoothed_places(const ComplexMesh& mesh, const SmoothingOptions& o) {
  const std::size_t n = mesh.points.size();
  const Neighbours around(mesh, o.threads);
  std::vector<Vec3> p = mesh.points, q = p, b(n);
  const std::vector<Vec3>& origin = mesh.points;
  const auto limited = [&](std::size_t v, Vec3 to) {
    Vec3 d = to - origin[v];
    if (mesh.flat[v]) d.z = 0;
    const double s = std::sqrt((d.x * d.x + d.y * d.y) / (o.limit_xy_mm * o.limit_xy_mm) +
                               d.z * d.z / (o.limit_z_mm * o.limit_z_mm)) /
                     (o.share.empty() ? 1.0 : std::max(1e-6f, o.share[v]));
    return s > 1 ? origin[v] + (1 / s) * d : origin[v] + d;
  };
  const bool taubin = o.taubin_lambda != 0;
  for (int pass = 0; pass < o.passes; ++pass) {
    if (taubin) {
      for (double factor : {o.taubin_lambda, o.taubin_mu}) {
        for_each_index(n, o.threads, [&](std::size_t v) {
          if (around.moves(v)) q[v] = p[v] + factor * (around.mean(p, v) - p[v]);
        });
        std::swap(p, q);
      }
      for_each_index(n, o.threads, [&](std::size_t v) {
        if (around.moves(v)) p[v] = limited(v, p[v]);
      });
      continue;
    }
    for_each_index(n, o.threads, [&](std::size_t v) {
      if (!around.moves(v)) return;
      q[v] = around.mean(p, v);
      b[v] = q[v] - (o.alpha * origin[v] + (1 - o.alpha) * p[v]);
    });
    for_each_index(n, o.threads, [&](std::size_t v) {
      if (around.moves(v)) p[v] = limited(v, q[v] - (o.beta * b[v] + (1 - o.beta) * around.mean(b, v)));
    });
    q = p;
  }
  return p;
}

SmoothingResult move_guarded(ComplexMesh& mesh, const std::vector<Vec3>& targets, const MoveLimits& keep, int threads) {
  SmoothingResult result;
  const std::size_t n = mesh.points.size();
  const std::vector<Vec3> before = mesh.points;
  std::vector<Vec3> now = targets;
  std::vector<float> share(n, 1);
  const double cell = 1.5 * mean_edge(mesh);
  TriangleGrid grid;
  const std::vector<float> clearance = clearances(mesh, keep);
  grid.build(mesh, now, cell, clearance);
  std::vector<std::int32_t> suspects;
  const auto moves = [&](std::int32_t v) {
    return now[v].x != before[v].x || now[v].y != before[v].y || now[v].z != before[v].z;
  };
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.triangles.size()); ++t) {
    const auto& v = mesh.triangles[t].v;
    if (mesh.alive(t) && (moves(v[0]) || moves(v[1]) || moves(v[2]))) suspects.push_back(t);
  }
  std::vector<std::int32_t> changed;
  for (;;) {
    ++result.rounds;
    const std::vector<std::int32_t> bad = find_offenders(mesh, grid, clearance, before, now, suspects, keep, threads);
    changed.clear();
    for (std::int32_t t : bad)
      for (std::int32_t v : mesh.triangles[t].v)
        if (share[v] > 0) changed.push_back(v);
    std::sort(changed.begin(), changed.end());
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    if (changed.empty()) break;
    suspects.clear();
    for (std::int32_t v : changed) {
      if (!moves(v)) {
        share[v] = 0;
        continue;
      }
      share[v] = share[v] > 0.2f ? share[v] / 2 : 0;
      now[v] = share[v] > 0 ? before[v] + static_cast<double>(share[v]) * (targets[v] - before[v]) : before[v];
      suspects.insert(suspects.end(), mesh.star[v].begin(), mesh.star[v].end());
    }
    std::sort(suspects.begin(), suspects.end());
    suspects.erase(std::unique(suspects.begin(), suspects.end()), suspects.end());
    for (std::int32_t t : suspects) {
      grid.remove(t);
      const auto& v = mesh.triangles[t].v;
      grid.insert(t, {now[v[0]], now[v[1]], now[v[2]]});
    }
  }
  for (std::size_t v = 0; v < n; ++v) {
    result.moved += share[v] > 0 && norm(now[v] - before[v]) > 0;
    result.held_back += share[v] < 1;
  }
  mesh.points = std::move(now);
  return result;
}

SmoothingResult smooth(ComplexMesh& mesh, const SmoothingOptions& options) {
  std::vector<Vec3> to = smoothed_places(mesh, options);
  if (options.volume_limit_mm > 0) {
    std::swap(mesh.points, to);
    std::vector<Vec3> restored = places_of_volumes(mesh, options.volumes, options.volume_limit_mm, options.threads);
    std::swap(mesh.points, to);
    to = std::move(restored);
  }
  return move_guarded(mesh, to, options.keep, options.threads);
}

std::map<Label, double> label_volumes(const ComplexMesh& mesh) {
  std::vector<double> of_pair(mesh.pair_count(), 0);
  for (const MeshTriangle& t : mesh.triangles)
    if (t.patch >= 0) of_pair[t.patch >> 1] += dot(mesh.points[t.v[0]], mesh.area_vector(t.v)) / 3;
  std::map<Label, double> out;
  for (std::size_t p = 0; p < of_pair.size(); ++p) {
    const auto [below, above] = mesh.labels_of(static_cast<std::int32_t>(2 * p));
    out[below] += of_pair[p];
    out[above] -= of_pair[p];
  }
  out.erase(0);
  return out;
}

SmoothingResult restore_volumes(ComplexMesh& mesh, const std::map<Label, double>& volumes, double limit_mm,
                                const MoveLimits& keep, int threads) {
  return move_guarded(mesh, places_of_volumes(mesh, volumes, limit_mm, threads), keep, threads);
}

}  // namespace stackmesh
