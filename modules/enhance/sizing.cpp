#include "enhance/sizing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "base/disjoint_sets.h"
#include "base/parallel.h"
#include "enhance/guard.h"
#include "enhance/smoothing.h"

namespace stackmesh {
namespace {

constexpr double kTurn = 0.34;     // over one edge of a uniform length a surface turns by no more than this, radians,
constexpr double kShortest = 0.8;  // but edges are no shorter for it than this share of the length
constexpr double kTurnByCurvature = 0.4;  // the same for lengths by curvature, down to the smallest length
constexpr double kLossShare = 0.1;        // of a label's volume that chords may cut off, before the fit gives it back

Vec3 unit(const Vec3& a) {
  const double l = norm(a);
  return l > 0 ? (1 / l) * a : Vec3{};
}

/// Unit normals of the vertices that are on no curve, averaged over three rings; zero on curves.
std::vector<Vec3> averaged_normals(const ComplexMesh& mesh, int threads) {
  const std::size_t n = mesh.points.size();
  std::vector<Vec3> normal(n), next(n);
  for_each_index(n, threads, [&](std::int32_t v) {
    Vec3 sum;
    if (mesh.curve[v].empty())
      for (std::int32_t t : mesh.star[v]) sum = sum + mesh.area_vector(mesh.triangles[t].v);
    normal[v] = unit(sum);
  });
  for (int pass = 0; pass < 3; ++pass) {
    for_each_index(n, threads, [&](std::int32_t v) {
      next[v] = normal[v];
      if (!mesh.curve[v].empty()) return;
      for (std::int32_t t : mesh.star[v])
        for (std::int32_t w : mesh.triangles[t].v)
          if (w != v && mesh.curve[w].empty()) next[v] = next[v] + 0.5 * normal[w];
    });
    std::swap(normal, next);
    for_each_index(n, threads, [&](std::int32_t v) { normal[v] = unit(normal[v]); });
  }
  return normal;
}

/// The mean curvature at every vertex that is on no curve, 1 / mm: above 0 where the label that the normals point away
/// from bulges. From normals averaged over a few rings.
std::vector<double> signed_bends(const ComplexMesh& mesh, int threads) {
  const std::vector<Vec3> normal = averaged_normals(mesh, threads);
  std::vector<double> out(mesh.points.size(), 0);
  for_each_index(out.size(), threads, [&](std::int32_t v) {
    if (!mesh.curve[v].empty()) return;
    double sum = 0, weight = 0;
    for (std::int32_t t : mesh.star[v])
      for (std::int32_t w : mesh.triangles[t].v) {
        if (w == v || !mesh.curve[w].empty()) continue;
        const Vec3 d = mesh.points[w] - mesh.points[v];
        sum += dot(normal[w] - normal[v], d);
        weight += dot(d, d);
      }
    if (weight > 0) out[v] = sum / weight;
  });
  return out;
}

class Sizing {
 public:
  Sizing(const ComplexMesh& mesh, const SizingOptions& options) : mesh_(mesh), o_(options) {}

  std::vector<double> run() {
    asked();
    curvature();
    thickness();
    grade_sizes(mesh_, o_.gradation, size_);
    return std::move(size_);
  }

 private:
  void asked() {
    size_.assign(mesh_.points.size(), 0);
    fixed_.assign(mesh_.points.size(), 0);
    std::vector<std::array<double, 2>> of_pair;  // the length requested, the largest by curvature
    for (std::size_t p = 0; p < mesh_.pair_count(); ++p) {
      const auto [below, above] = mesh_.labels_of(static_cast<std::int32_t>(2 * p));
      std::array<double, 2> x = {1e300, 1e300};
      for (Label l : {below, above}) {
        const auto it = o_.label_edge_mm.find(l);
        if (l != 0 && it != o_.label_edge_mm.end()) x[0] = std::min(x[0], it->second);
        const auto limit = o_.label_max_mm.find(l);
        if (l != 0 && limit != o_.label_max_mm.end()) x[1] = std::min(x[1], limit->second);
      }
      of_pair.push_back(x);
    }
    for_each_index(size_.size(), o_.threads, [&](std::int32_t v) {
      double s = 1e300, most = 1e300;
      for (std::int32_t t : mesh_.star[v]) {
        const auto& x = of_pair[mesh_.triangles[t].patch >> 1];
        s = std::min(s, x[0]);
        most = std::min(most, x[1]);
      }
      fixed_[v] = s < 1e300;
      size_[v] = s < 1e300 ? s : o_.edge_length_mm.value_or(most < 1e300 ? most : o_.edge_max_mm);
    });
  }

  void curvature() {
    bend_ = surface_bends(mesh_, o_.threads);
    for_each_index(o_.bend.size(), o_.threads, [&](std::size_t v) {
      if (o_.bend[v] >= 0) {
        bend_[v] = o_.bend[v];
        return;
      }
      double sum = 0, count = 0;  // a curve bends as the sheets beside it
      for (std::int32_t t : mesh_.star[v])
        for (std::int32_t w : mesh_.triangles[t].v)
          if (o_.bend[w] >= 0) {
            sum += o_.bend[w];
            ++count;
          }
      if (count > 0) bend_[v] = sum / count;
    });
    for_each_index(size_.size(), o_.threads, [&](std::int32_t v) {
      if (fixed_[v] || o_.edge_length_mm)
        size_[v] = std::clamp(kTurn / std::max(bend_[v], 1e-12), kShortest * size_[v], size_[v]);
    });
    if (o_.edge_length_mm) return;
    for_each_index(size_.size(), o_.threads, [&](std::int32_t v) {
      if (!fixed_[v])
        size_[v] = std::clamp(std::min(chord(1 / std::max(bend_[v], 1e-12), o_.deviation_mm),
                                       kTurnByCurvature / std::max(bend_[v], 1e-12)),
                              std::min(o_.edge_min_mm, size_[v]), size_[v]);
    });
  }

  /// Length of an edge whose middle is `deviation` off a surface with that radius of curvature.
  static double chord(double radius, double deviation) {
    const double r = std::min(radius, 1e12), d = std::min(deviation, r);
    return 2 * std::sqrt(d * (2 * r - d));
  }

  void thickness() {
    double mean = 0;
    std::size_t count = 0;
    for (std::size_t v = 0; v < size_.size(); ++v)
      if (!mesh_.star[v].empty()) {
        mean += size_[v];
        ++count;
      }
    if (count == 0) return;
    const double reach = std::min(mean / static_cast<double>(count), o_.wall_reach_mm);
    const std::vector<double>&thin = o_.wall_mm, &shell = o_.shell_mm;
    for_each_index(size_.size(), o_.threads, [&](std::int32_t v) {
      const double least = std::min(o_.thin_min_mm, size_[v]);
      if (thin[v] < reach) size_[v] = std::clamp(kAcrossWall * thin[v], least, size_[v]);
      size_[v] = std::min(size_[v], kOfShell * shell[v]);
    });
    keep_volumes(thin);
  }

  /// Chords cut off what bulges. Edges are no longer than those that would cut a share of a label's volume off, as its
  /// bend predicts, were all of its edges as long as that allows. So the bound does not depend on the length requested,
  /// and a longer one never makes shorter edges.
  void keep_volumes(const std::vector<double>& thin) {
    const std::size_t labels = mesh_.labels().size();
    const bool outside = !mesh_.labels().empty() && mesh_.labels()[0] == 0;  // number 0 is the outside
    const std::map<Label, double> volume = label_volumes(mesh_);
    // what bulges and dents in turn keeps the volume
    const std::vector<double> turns = signed_bends(mesh_, o_.threads);
    std::vector<double> area(mesh_.triangles.size(), 0), radius(size_.size());
    for_each_index(area.size(), o_.threads,
                   [&](std::size_t t) { area[t] = norm(mesh_.area_vector(mesh_.triangles[t].v)); });
    for_each_index(radius.size(), o_.threads,
                   [&](std::size_t v) { radius[v] = std::min(1 / std::max(std::abs(turns[v]), 1e-12), 1e12); });
    // Of the thickness that a chord may cut off: the largest part, by bisection for each label.
    std::vector<double> low(labels, 0.6 * 0.6 * 0.6 * 0.6 * 0.6 * 0.6), high(labels, 1), part(labels, 1);
    for (int pass = 0; pass < 8; ++pass) {
      std::vector<double> loss(labels, 0);
      for (std::size_t t = 0; t < area.size(); ++t) {
        if (mesh_.triangles[t].patch < 0) continue;
        for (const int side : {0, 1}) {
          const std::int32_t l = mesh_.sides(mesh_.triangles[t].patch)[side];
          if (l == 0 && outside) continue;
          for (std::int32_t v : mesh_.triangles[t].v) {
            const double r = radius[v], reach = std::min(thin[v], 2 * r), size = chord(r, part[l] * reach);
            const double cut = area[t] / 3 * std::min(size * size / (8 * r), 0.5 * reach);
            loss[l] += (turns[v] > 0) == (side == 0) ? cut : -cut;
          }
        }
      }
      for (std::size_t l = outside; l < labels; ++l) {
        const bool fits = loss[l] <= kLossShare * volume.at(mesh_.labels()[l]);
        (fits ? low : high)[l] = part[l];
        if (pass == 0 && fits) high[l] = 1;
        part[l] = std::sqrt(low[l] * high[l]);
      }
    }
    part = low;
    if (outside) part[0] = 1;
    for_each_index(size_.size(), o_.threads, [&](std::int32_t v) {
      double least = 1;
      for (std::int32_t t : mesh_.star[v])
        for (std::int32_t l : mesh_.sides(mesh_.triangles[t].patch)) least = std::min(least, part[l]);
      if (least < 1)
        size_[v] = std::clamp(chord(radius[v], least * std::min(thin[v], 2 * radius[v])),
                              std::min(o_.thin_min_mm, size_[v]), size_[v]);
    });
  }

  const ComplexMesh& mesh_;
  const SizingOptions& o_;
  std::vector<double> size_, bend_;
  std::vector<char> fixed_;
};

}  // namespace

std::vector<double> wall_thickness(const ComplexMesh& mesh, double reach_mm, int threads) {
  double sum = 0, count = 0;
  for (const MeshTriangle& t : mesh.triangles)
    if (t.patch >= 0) {
      sum += norm(mesh.points[t.v[0]] - mesh.points[t.v[1]]);
      ++count;
    }
  TriangleGrid grid;
  const double cell = std::max(0.1 * reach_mm, 1.5 * sum / std::max(count, 1.0));
  grid.build(mesh, mesh.points, cell);
  std::vector<double> thin(mesh.points.size(), std::numeric_limits<double>::infinity());
  for_each_index(thin.size(), threads, [&](std::int32_t v) {
    if (mesh.star[v].empty() || !mesh.curve[v].empty() || mesh.pinned[v]) return;
    Vec3 n;
    for (std::int32_t t : mesh.star[v]) n = n + mesh.area_vector(mesh.triangles[t].v);
    n = unit(n);
    const auto [below, above] = mesh.labels_of(mesh.triangles[mesh.star[v][0]].patch);
    for (int side = 0; side < 2; ++side) {
      if ((side == 0 ? below : above) == 0) continue;
      const Vec3 from = mesh.points[v], d = (side == 0 ? -1.0 : 1.0) * n;
      for (double near = 0; near < std::min(reach_mm, thin[v]); near += cell) {  // piece by piece: most rays end soon
        const Vec3 start = from + near * d, end = from + std::min(near + cell, reach_mm) * d;
        grid.query(TriangleGrid::box_of({start, end, end}, 0), [&](std::int32_t t) {
          const auto& w = mesh.triangles[t].v;
          if (w[0] == v || w[1] == v || w[2] == v) return true;
          const Vec3 a = mesh.points[w[0]], e = mesh.points[w[1]] - a, f = mesh.points[w[2]] - a;
          const Vec3 h = cross(d, f);
          const double det = dot(e, h);
          if (std::abs(det) < 1e-12 * norm(e) * norm(f)) return true;
          const Vec3 s = from - a, q = cross(s, e);
          const double u = dot(s, h) / det, x = dot(d, q) / det, l = dot(f, q) / det;
          if (u >= 0 && x >= 0 && u + x <= 1 && l > 0 && l <= reach_mm) thin[v] = std::min(thin[v], l);
          return true;
        });
      }
    }
  });
  return thin;
}

std::vector<double> shell_sizes(const ComplexMesh& mesh, std::map<Label, ShellCount>* shells) {
  // A side of a triangle belongs to a label; sides of one label that meet at an edge belong to one shell.
  DisjointSets sets(2 * mesh.triangles.size());
  const auto label = [&](std::int32_t i) { return mesh.labels()[mesh.sides(mesh.triangles[i / 2].patch)[i % 2]]; };
  std::vector<std::int32_t> around;
  const auto is_free = [&](std::int32_t v) { return mesh.curve[v].empty() && !mesh.pinned[v]; };
  for (std::int32_t a = 0; a < static_cast<std::int32_t>(mesh.points.size()); ++a) {
    if (mesh.star[a].empty()) continue;
    if (is_free(a)) {  // one fan of one patch
      for (std::int32_t t : mesh.star[a]) {
        sets.join(2 * t, 2 * mesh.star[a][0]);
        sets.join(2 * t + 1, 2 * mesh.star[a][0] + 1);
      }
      continue;
    }
    mesh.edges_from(a, [&](std::int32_t b) {
      if (is_free(b)) return;
      mesh.edge_triangles(a, b, around);
      for (std::size_t i = 0; i < 2 * around.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
          const std::int32_t s = 2 * around[i / 2] + static_cast<std::int32_t>(i % 2),
                             t = 2 * around[j / 2] + static_cast<std::int32_t>(j % 2);
          if (label(s) == label(t)) sets.join(s, t);
        }
    });
  }
  std::vector<double> volume(sets.size(), 0);
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(sets.size()); ++i) {
    if (!mesh.alive(i / 2) || label(i) == 0) continue;
    const std::int32_t r = sets.find(i);
    const auto& v = mesh.triangles[i / 2].v;
    const Vec3& o = mesh.points[mesh.triangles[r / 2].v[0]];
    const double part = dot(mesh.points[v[0]] - o, cross(mesh.points[v[1]] - o, mesh.points[v[2]] - o)) / 6;
    volume[r] += i % 2 ? -part : part;
  }
  std::vector<double> out(mesh.points.size(), std::numeric_limits<double>::infinity());
  std::map<Label, ShellCount> count;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(sets.size()); ++i) {
    if (!mesh.alive(i / 2) || label(i) == 0) continue;
    const std::int32_t r = sets.find(i);
    if (r == i) ++(volume[r] < 0 ? count[label(i)].inward : count[label(i)].outer);
    for (std::int32_t v : mesh.triangles[i / 2].v) out[v] = std::min(out[v], std::cbrt(std::abs(volume[r])));
  }
  if (shells) *shells = count;
  return out;
}

void grade_sizes(const ComplexMesh& mesh, double gradation, std::vector<double>& size) {
  const double slope = std::log(gradation);
  using Entry = std::pair<double, std::int32_t>;
  std::vector<Entry> heap;
  const auto spread = [&](std::int32_t v, auto found) {
    for (std::int32_t t : mesh.star[v])
      for (std::int32_t w : mesh.triangles[t].v) {
        if (w == v || size[w] <= size[v]) continue;
        const double limit = size[v] + slope * norm(mesh.points[w] - mesh.points[v]);
        if (size[w] > limit && !found(w, limit)) return;
      }
  };
  for (std::int32_t v = 0; v < static_cast<std::int32_t>(size.size()); ++v)
    spread(v, [&](std::int32_t, double) {
      heap.push_back({size[v], v});
      return false;
    });
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue({}, std::move(heap));
  while (!queue.empty()) {
    const auto [s, v] = queue.top();
    queue.pop();
    if (s > size[v]) continue;
    spread(v, [&](std::int32_t w, double limit) {
      size[w] = limit;
      queue.push({limit, w});
      return true;
    });
  }
}

std::vector<double> surface_bends(const ComplexMesh& mesh, int threads) {
  const std::size_t n = mesh.points.size();
  const std::vector<Vec3> normal = averaged_normals(mesh, threads);
  std::vector<double> bend(n, 0), smooth(n, 0);
  for_each_index(n, threads, [&](std::int32_t v) {
    if (!mesh.curve[v].empty()) {
      if (mesh.curve[v].size() != 2) return;
      const Vec3 a = mesh.points[mesh.curve[v][0]] - mesh.points[v], b = mesh.points[v] - mesh.points[mesh.curve[v][1]];
      const double l = 0.5 * (norm(a) + norm(b));
      if (l > 0) bend[v] = 0.5 * norm(unit(a) - unit(b)) / l;  // half: a curve keeps some of its steps
      return;
    }
    for (std::int32_t t : mesh.star[v])
      for (std::int32_t w : mesh.triangles[t].v) {
        if (w == v || !mesh.curve[w].empty()) continue;
        const Vec3 d = mesh.points[w] - mesh.points[v];
        const double l = dot(d, d);
        if (l > 0) bend[v] = std::max(bend[v], std::abs(dot(normal[w] - normal[v], d)) / l);
      }
  });
  for_each_index(n, threads, [&](std::int32_t v) {  // mean over the neighbours: one odd edge does not decide
    double sum = bend[v], count = 1;
    for (std::int32_t t : mesh.star[v])
      for (std::int32_t w : mesh.triangles[t].v)
        if (w != v) {
          sum += 0.5 * bend[w];
          count += 0.5;
        }
    smooth[v] = sum / count;
  });
  return smooth;
}

std::vector<double> edge_sizes(const ComplexMesh& mesh, const SizingOptions& options) {
  return Sizing(mesh, options).run();
}

double expected_triangles(const ComplexMesh& mesh, const std::vector<double>& size) {
  double sum = 0;
  for (const MeshTriangle& t : mesh.triangles) {
    if (t.patch < 0) continue;
    const double l = (size[t.v[0]] + size[t.v[1]] + size[t.v[2]]) / 3;
    sum += norm(mesh.area_vector(t.v)) / (kTriangleArea * l * l);
  }
  return sum;
}

}  // namespace stackmesh
