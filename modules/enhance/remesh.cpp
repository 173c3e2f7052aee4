#include "enhance/remesh.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "enhance/blocks.h"
#include "enhance/local_operations.h"
#include "enhance/sizing.h"
#include "enhance/smoothing.h"

namespace stackmesh {
namespace {

constexpr double kDegree = M_PI / 180;
const double kFolded = std::cos(155 * kDegree);  // two triangles whose normals are further apart
const double kSqrt2 = std::sqrt(2.0);
constexpr double kSameGrid = 1.25;  // ratio of mean edge lengths for which one grid serves
constexpr double kMuchTooLong = 2;  // normalised length of an edge that blocks should have split

/// Works on a mesh, or on a block of one.
class Remesher {
 public:
  Remesher(ComplexMesh& mesh, std::vector<double>& size, std::vector<std::int32_t>& hints, const Reference& reference,
           const RemeshOptions& options)
      : mesh_(mesh), size_(size), reference_(reference), o_(options), ops_(mesh, size, hints, reference, options) {}

  void round(int number) {
    regrid();
    split_long();
    collapse_short(std::vector<double>(number == 0 ? 8 : 3, 1 / kSqrt2), (number == 0 ? 8 : 15) * kDegree);
    flip_all(2 * kDegree, number + 1 < o_.rounds, 2);
    for (int pass = 0; pass < (number + 2 < o_.rounds ? 1 : 2); ++pass) move(relocated());
  }

  /// Edges that blocks could not work on, in the whole: turned where that helps (rows of points lie along them), else
  /// split.
  void split_rest() {
    regrid();
    for (int pass = 0; pass < 20; ++pass) {
      auto list = ranked([](double r) { return r > kMuchTooLong; });
      std::size_t done = 0;
      for (auto it = list.rbegin(); it != list.rend(); ++it) {
        const auto [a, b] = it->second;
        if (mesh_.has_edge(a, b)) done += ops_.flip(a, b, 0.5 * kDegree, false) || ops_.split(a, b);
      }
      if (done == 0) break;
    }
  }

  void coarsen() {
    regrid();
    flip_all(2 * kDegree, false, 2);
    collapse_short({0.25, 0.4, 0.55, 1 / kSqrt2, 1 / kSqrt2}, 8 * kDegree);
  }

  void fit(int passes) {
    last_.assign(mesh_.triangles.size(), {-1, -1, -1});
    std::vector<Vec3> to = mesh_.points;  // the guard judges what all steps come to
    for (int pass = 0; pass < passes; ++pass) mesh_.points = fitted();
    std::swap(to, mesh_.points);
    move(to);
  }

  void finish(int sweeps) {
    regrid();
    flip_all(1 * kDegree, false, 3);
    for (int sweep = 0; sweep < sweeps; ++sweep)
      if (improve_worst(o_.good_angle_deg) == 0) break;
  }

  /// The last bad triangles, by stronger means.
  void mend(int sweeps) {
    regrid();
    ops_.lenient = true;
    for (const bool last_resort : {false, true, false}) {
      ops_.set_last_resort(last_resort);
      for (int sweep = 0; sweep < sweeps; ++sweep) {
        const std::size_t better = improve_worst(last_resort ? 0.5 * o_.mend_angle_deg : o_.mend_angle_deg);
        if (better == 0 || sweep % 2 == 1)
          if (smooth_bad() + better == 0) break;
      }
    }
    ops_.lenient = false;
  }

  RemeshCounts counts() const {
    RemeshCounts c = ops_.counts;
    c.refused_contact = ops_.guard.refused_contact;
    c.refused_angle = ops_.guard.refused_angle;
    c.refused_clearance = ops_.guard.refused_clearance;
    return c;
  }

 private:
  using Edge = std::array<std::int32_t, 2>;

  /// The guard's grid follows the size of the triangles: made anew where their mean edge is far from what it was made
  /// for.
  void regrid() {
    double sum = 0;
    std::size_t count = 0;
    for (const MeshTriangle& t : mesh_.triangles) {
      if (t.patch < 0) continue;
      for (int k = 0; k < 3; ++k) sum += ops_.length(t.v[k], t.v[(k + 1) % 3]);
      count += 3;
    }
    if (count == 0) return;
    const double mean = sum / static_cast<double>(count);
    if (mean < kSameGrid * grid_edge_ && grid_edge_ < kSameGrid * mean) return;
    ops_.guard.rebuild(1.3 * mean);
    grid_edge_ = mean;
  }

  double ratio(const Edge& e) const { return ops_.length(e[0], e[1]) / ops_.asked(e[0], e[1]); }

  /// Edges with their normalised length, sorted by it, those that pass only.
  template <class Pass>
  std::vector<std::pair<double, Edge>> ranked(Pass pass) const {
    std::vector<std::pair<double, Edge>> out;
    for (const Edge& e : mesh_.edges()) {
      const double r = ratio(e);
      if (pass(r)) out.push_back({r, e});
    }
    std::sort(out.begin(), out.end());
    return out;
  }

  void split_long() {
    for (int pass = 0; pass < 12; ++pass) {
      regrid();
      auto list = ranked([](double r) { return r > kSqrt2; });
      std::size_t done = 0;
      for (auto it = list.rbegin(); it != list.rend(); ++it)
        if (mesh_.has_edge(it->second[0], it->second[1])) done += ops_.split(it->second[0], it->second[1]);
      if (done == 0) break;
    }
  }

  /// Collapses edges below 1 / sqrt 2 in stages, the shortest first; what was tried in vain is tried again only where
  /// the surface has changed since.
  void collapse_short(const std::vector<double>& stages, double floor_rad) {
    std::vector<int> changed(mesh_.points.size(), 0);
    std::vector<std::int32_t> around;
    double tried = 0;
    int pass = 0;
    for (const double below : stages) {
      ++pass;
      regrid();
      std::size_t done = 0;
      for (const auto& [r, e] : ranked([&](double x) { return x < below; })) {
        const auto [a, b] = e;
        if (r < tried && std::max(changed[a], changed[b]) + 1 < pass) continue;
        if (mesh_.star[a].empty() || mesh_.star[b].empty() || !mesh_.has_edge(a, b) || ratio(e) >= below) continue;
        // The one with fewer triangles goes first: it changes less.
        const bool a_first = mesh_.star[a].size() <= mesh_.star[b].size();
        const std::int32_t one = a_first ? a : b, two = a_first ? b : a;
        std::int32_t kept = -1;
        if (ops_.collapse(one, two, floor_rad)) kept = two;
        else if (ops_.collapse(two, one, floor_rad)) kept = one;
        if (kept < 0) continue;
        ++done;
        mesh_.neighbours(kept, around);
        changed[kept] = pass;
        for (std::int32_t v : around) changed[v] = pass;
      }
      if (below == tried && done * 500 < mesh_.points.size()) break;
      tried = below;
    }
  }

  void flip_all(double gain, bool valence, int passes) {
    for (int pass = 0; pass < passes; ++pass) {
      regrid();
      std::size_t done = 0;
      for (const Edge& e : mesh_.edges())
        if (mesh_.has_edge(e[0], e[1])) done += ops_.flip(e[0], e[1], gain, valence && pass == 0);
      if (done == 0) break;
    }
  }

  /// Places of all vertices: `target` of a vertex that may move.
  template <class Target>
  std::vector<Vec3> places(Target target) const {
    std::vector<Vec3> to = mesh_.points;
    for_each_index(to.size(), o_.threads, [&](std::size_t n) {
      const auto v = static_cast<std::int32_t>(n);
      if (mesh_.star[v].empty() || mesh_.is_held(v) || mesh_.is_fixed(v)) return;
      const Vec3 p = target(v);
      if (mesh_.contains(p)) to[v] = p;
    });
    return to;
  }

  void move(const std::vector<Vec3>& to) {
    ops_.counts.relocations += move_guarded(mesh_, to, limits(), o_.threads).moved;
  }

  MoveLimits limits() const {
    MoveLimits keep;
    keep.size_mm = &size_;
    keep.clearance_rel = o_.clearance_rel;
    keep.sheet_angle_deg = o_.sheet_angle_deg;
    keep.corner_angle_deg = 25;
    keep.turn_deg = 60;
    return keep;
  }

  /// To the centroid of the star (curves: between the neighbours), on the reference.
  std::vector<Vec3> relocated() const {
    return places([&](std::int32_t v) {
      const Vec3 here = mesh_.points[v];
      Vec3 sum;
      double weight = 0;
      if (!mesh_.curve[v].empty()) {
        for (std::int32_t c : mesh_.curve[v]) {
          const double w = norm(mesh_.points[c] - here) / (size_[c] + size_[v]);
          sum = sum + w * mesh_.points[c];
          weight += w;
        }
      } else {
        for (std::int32_t t : mesh_.star[v]) {
          const auto& c = mesh_.triangles[t].v;
          const double s = size_[c[0]] + size_[c[1]] + size_[c[2]];
          const double w = norm(mesh_.area_vector(c)) / (s * s);
          sum = sum + (w / 3) * (mesh_.points[c[0]] + mesh_.points[c[1]] + mesh_.points[c[2]]);
          weight += w;
        }
      }
      if (!(weight > 0)) return here;
      const Vec3 p = (1 / weight) * sum;
      if (norm(p - here) < 0.02 * size_[v]) return here;
      return ops_.drawn_to_reference(v, mesh_.curve[v].empty() ? p : here + 0.5 * (p - here));
    });
  }

  /// Places after a step of a fit to the reference: vertices move by the mean distance, along the triangles' normals,
  /// of samples on their triangles, weighted by the vertex's share in the sample; over-relaxed, as neighbours move
  /// alike.
  std::vector<Vec3> fitted() {
    static constexpr double kAt[3][3] = {{2 / 3., 1 / 6., 1 / 6.}, {1 / 6., 2 / 3., 1 / 6.}, {1 / 6., 1 / 6., 2 / 3.}};
    constexpr double kOverRelaxed = 2, kTrust = 0.3;
    std::vector<std::array<double, 3>> off(mesh_.triangles.size(), {0, 0, 0});  // per corner: mean distance
    for_each_index(off.size(), o_.threads, [&](std::size_t t) {
      const MeshTriangle& m = mesh_.triangles[t];
      if (m.patch < 0 || mesh_.is_cap(m.patch)) return;
      const Vec3 a = mesh_.area_vector(m.v);
      const double l = norm(a), reach = size_[m.v[0]];
      if (!(l > 0)) return;
      for (int i = 0; i < 3; ++i) {
        const auto& w = kAt[i];
        Vec3 p;
        for (int k = 0; k < 3; ++k) p = p + w[k] * mesh_.points[m.v[k]];
        const std::int32_t hint = last_[t][i] >= 0 ? last_[t][i] : ops_.hints[m.v[i]];
        const auto foot = reference_.nearest(p, m.patch, reach, hint, kTrust * reach);
        if (!foot) continue;
        last_[t][i] = foot->face;
        const double d = dot(foot->point - p, (1 / l) * a);
        for (int k = 0; k < 3; ++k) off[t][k] += w[k] * d;  // the shares of a corner add up to one
      }
    });
    return places([&](std::int32_t v) {
      Vec3 sum;
      double weight = 0;
      for (std::int32_t t : mesh_.star[v]) {
        const auto& c = mesh_.triangles[t].v;
        const Vec3 a = mesh_.area_vector(c);
        const int k = c[0] == v ? 0 : c[1] == v ? 1 : 2;
        sum = sum + off[t][k] * a;
        weight += norm(a);
      }
      Vec3 step = weight > 0 ? (kOverRelaxed / weight) * sum : Vec3{};
      if (mesh_.flat[v]) step.z = 0;
      const double l = norm(step), most = 0.2 * size_[v];
      return mesh_.points[v] + (l > most ? most / l : 1.0) * step;
    });
  }

  /// Triangles that pass, ascending.
  template <class Pass>
  std::vector<std::int32_t> triangles_that(Pass pass) const {
    std::vector<char> passes(mesh_.triangles.size());
    for_each_index(passes.size(), o_.threads, [&](std::size_t t) {
      passes[t] = mesh_.alive(static_cast<std::int32_t>(t)) && pass(static_cast<std::int32_t>(t));
    });
    std::vector<std::int32_t> out;
    for (std::size_t t = 0; t < passes.size(); ++t)
      if (passes[t]) out.push_back(static_cast<std::int32_t>(t));
    return out;
  }

  std::size_t improve_worst(double below_deg) {
    const double limit = below_deg * kDegree;
    std::vector<std::pair<double, std::int32_t>> worst;
    for (std::int32_t t : triangles_that([&](std::int32_t x) { return ops_.angle(mesh_.triangles[x].v) < limit; }))
      worst.push_back({ops_.angle(mesh_.triangles[t].v), t});
    std::sort(worst.begin(), worst.end());
    std::size_t done = 0;
    for (const auto& [before, t] : worst) {
      if (!mesh_.alive(t)) continue;
      const double a = ops_.angle(mesh_.triangles[t].v);
      if (a < limit) done += improve(t, a);
    }
    return done;
  }

  /// Moves the vertices of bad triangles, and those next to them, to where the surface is even; pleats that stay are
  /// cut out.
  std::size_t smooth_bad() {
    std::vector<std::int32_t> all, around;
    const double limit = 0.5 * o_.mend_angle_deg * kDegree;
    const std::vector<std::int32_t> bad =
        triangles_that([&](std::int32_t x) { return ops_.angle(mesh_.triangles[x].v) < limit || is_folded(x); });
    for (std::int32_t t : bad)
      for (std::int32_t v : mesh_.triangles[t].v) {
        all.push_back(v);
        mesh_.neighbours(v, around);
        all.insert(all.end(), around.begin(), around.end());
      }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    std::size_t done = 0;
    for (int pass = 0; pass < 2; ++pass)
      for (std::int32_t v : all) done += ops_.smooth_over(v);
    for (std::int32_t t : bad)
      if (mesh_.alive(t) && (ops_.angle(mesh_.triangles[t].v) < limit || is_folded(t))) done += ops_.unfold(t);
    return done;
  }

  /// True where the surface turns back onto itself over an edge of the triangle within its patch.
  bool is_folded(std::int32_t t) const {
    const auto& v = mesh_.triangles[t].v;
    const Vec3 n = mesh_.area_vector(v);
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = v[k], b = v[(k + 1) % 3];
      for (std::int32_t u : mesh_.star[a]) {
        if (u <= t || mesh_.triangles[u].patch != mesh_.triangles[t].patch) continue;
        const auto& w = mesh_.triangles[u].v;
        if (w[0] != b && w[1] != b && w[2] != b) continue;
        const Vec3 m = mesh_.area_vector(w);
        if (dot(n, m) < kFolded * norm(n) * norm(m)) return true;
      }
    }
    return false;
  }

  bool improve(std::int32_t t, double angle) {
    const auto v = mesh_.triangles[t].v;
    const auto side = [&](int k) { return ops_.length(v[k], v[(k + 1) % 3]); };
    std::array<int, 3> by_length = {0, 1, 2};
    std::sort(by_length.begin(), by_length.end(), [&](int i, int j) { return side(i) < side(j); });
    for (int k : {by_length[2], by_length[0], by_length[1]})
      if (ops_.flip(v[k], v[(k + 1) % 3], 0.5 * kDegree, false)) return true;
    const double floor = std::min(angle + 2 * kDegree, 28 * kDegree);
    for (int i = 0; i < (ops_.lenient ? 3 : 1); ++i) {
      const int k = by_length[i];
      const std::int32_t a = v[k], b = v[(k + 1) % 3];
      if (side(k) < 0.8 * ops_.asked(a, b) && (ops_.collapse(a, b, floor) || ops_.collapse(b, a, floor))) return true;
      if (ops_.lenient && ops_.cut_tip(a, b)) return true;
    }
    bool moved = false;
    for (std::int32_t w : v) moved = ops_.relocate(w) || moved;
    return moved;
  }

  ComplexMesh& mesh_;
  std::vector<double>& size_;
  const Reference& reference_;
  const RemeshOptions& o_;
  LocalOperations ops_;
  double grid_edge_ = 0;  ///< mean edge length that the guard's grid was made for
  /// the face of the reference where each sample of a triangle last was
  std::vector<std::array<std::int32_t, 3>> last_;
};

/// Sizes shrink where centres of the reference's triangles are further from the mesh than allowed.
void shorten_where_off(const ComplexMesh& mesh, std::vector<double>& size, const Reference& reference,
                       const RemeshOptions& o) {
  double longest = 0, sum = 0;
  for (double s : size) {
    longest = std::max(longest, s);
    sum += s;
  }
  const Reference now(mesh, 0.5 * sum / static_cast<double>(size.size()), o.threads);
  std::vector<float> factor(mesh.triangles.size(), 1);
  std::vector<std::pair<std::int32_t, float>> off(reference.face_count(), {-1, 1.0f});
  constexpr std::size_t kChunk = 512;
  // enough of them
  const std::size_t step = off.size() > 4 * mesh.triangles.size() ? 4 : off.size() > 2 * mesh.triangles.size() ? 2 : 1;
  parallel_for((off.size() + kChunk - 1) / kChunk, o.threads, [&](std::size_t chunk) {
    std::int32_t hint = -1;
    for (std::size_t f = chunk * kChunk; f < std::min(off.size(), (chunk + 1) * kChunk); f += step) {
      const auto foot = now.nearest(reference.centre(f), reference.patch(f), longest, hint, o.deviation_mm);
      if (foot) hint = foot->face;
      if (foot && foot->distance_mm > o.deviation_mm)
        off[f] = {foot->triangle, static_cast<float>(std::max(0.5, std::sqrt(o.deviation_mm / foot->distance_mm)))};
    }
  });
  for (const auto& [t, x] : off)
    if (t >= 0) factor[t] = std::min(factor[t], x);
  std::vector<double> shorter = size;
  for (std::size_t t = 0; t < factor.size(); ++t)
    if (factor[t] < 1)
      for (std::int32_t v : mesh.triangles[t].v)
        shorter[v] = std::min(shorter[v], std::max(std::min(size[v], o.shortest_mm), 0.9 * factor[t] * size[v]));
  size = shorter;
  grade_sizes(mesh, o.gradation, size);
  if (o.most_triangles > 0) {
    const double longer = std::sqrt(expected_triangles(mesh, size) / o.most_triangles);
    if (longer > 1)
      for (double& x : size) x *= longer;
  }
}

/// Edges that should have been split, and were not: their triangles fit into no block.
bool has_long_edges(const ComplexMesh& mesh, const std::vector<double>& size) {
  for (const MeshTriangle& t : mesh.triangles)
    if (t.patch >= 0)
      for (int k = 0; k < 3; ++k) {
        const std::int32_t a = t.v[k], b = t.v[(k + 1) % 3];
        if (norm(mesh.points[a] - mesh.points[b]) > kMuchTooLong * 0.5 * (size[a] + size[b])) return true;
      }
  return false;
}

constexpr std::size_t kWhole = 3000;  // vertices: less is not cut into blocks
constexpr std::size_t kBlock = 8000;  // vertices of a block, at most

void add(RemeshCounts& sum, const RemeshCounts& c) {
  sum.splits += c.splits;
  sum.collapses += c.collapses;
  sum.flips += c.flips;
  sum.relocations += c.relocations;
  sum.refused_contact += c.refused_contact;
  sum.refused_angle += c.refused_angle;
  sum.refused_clearance += c.refused_clearance;
}

}  // namespace

RemeshCounts remesh(ComplexMesh& mesh, std::vector<double>& size, const Reference& reference,
                    const RemeshOptions& options, Monitor& progress) {
  RemeshCounts counts;
  // The mesh still is the reference, whose faces are numbered as the triangles that are alive.
  std::vector<std::int32_t> hints(mesh.points.size(), -1);
  mesh.compact(size, hints);
  if (reference.is_the_mesh())
    for (std::size_t v = 0; v < hints.size(); ++v) hints[v] = mesh.star[v].front();
  // Blocks are worked on at the same time; each phase has their sides elsewhere, so that what was frozen has its turn.
  int phase = 0;
  const auto in_blocks = [&](bool whole, auto work) {
    static constexpr double kCuts[] = {0.5, 0.4, 0.6, 0.45, 0.55};
    const double cut = kCuts[phase++ % 5];
    if (whole || mesh.points.size() <= kWhole) {
      Remesher r(mesh, size, hints, reference, options);
      work(r);
      add(counts, r.counts());
      mesh.compact(size, hints);
      return;
    }
    RemeshOptions one = options;
    one.threads = 1;
    const double margin = 1.01 * options.clearance_rel * *std::max_element(size.begin(), size.end());
    std::vector<MeshBlock> blocks =
        cut_into_blocks(mesh, size, hints, std::min(kBlock, mesh.points.size() / 4), cut, margin, options.threads);
    std::vector<RemeshCounts> each(blocks.size());
    parallel_for(blocks.size(), options.threads, [&](std::size_t i) {
      MeshBlock& b = blocks[i];
      Remesher r(b.mesh, b.size, b.hints, reference, one);
      work(r);
      each[i] = r.counts();
    });
    for (const RemeshCounts& c : each) add(counts, c);
    join_blocks(mesh, size, hints, blocks);
  };
  for (int i = 0; i < 2; ++i) in_blocks(false, [&](Remesher& r) { r.coarsen(); });
  if (options.when_coarse) options.when_coarse();
  for (int round = 0; round < options.rounds; ++round) {
    in_blocks(false, [&](Remesher& r) { r.round(round); });
    if (round + 1 < options.rounds && has_long_edges(mesh, size)) in_blocks(true, [](Remesher& r) { r.split_rest(); });
    if (options.deviation_mm > 0 && round < 2) shorten_where_off(mesh, size, reference, options);
    progress.advance(0.3 + 0.4 * (round + 1) / options.rounds);
  }
  in_blocks(false, [&](Remesher& r) { r.fit(options.fit_passes / 2); });
  in_blocks(false, [&](Remesher& r) {
    r.fit(options.fit_passes - options.fit_passes / 2);
    r.finish(options.finish_sweeps);
  });
  in_blocks(false, [&](Remesher& r) { r.finish(options.finish_sweeps / 2); });
  in_blocks(true, [&](Remesher& r) { r.mend(options.mend_sweeps); });
  progress.advance(0.9);
  return counts;
}

}  // namespace stackmesh
