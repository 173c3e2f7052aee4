#include "enhance/local_operations.h"

#include <algorithm>
#include <cmath>

namespace stackmesh {
namespace {

constexpr double kFlipBend = 0.82;  // cosine: two triangles whose edge may be flipped
constexpr double kNeedle = 0.01;    // radians: a triangle with so small an angle is to go whatever takes its place
constexpr double kMergeRel = 0.5;   // of the edge length: junctions that near may become one
const double kSqrt2 = std::sqrt(2.0);

Vec3 unit(const Vec3& a) {
  const double l = norm(a);
  return l > 0 ? (1 / l) * a : Vec3{};
}

}  // namespace

void LocalOperations::fan_normals(std::int32_t v) {
  const auto& star = mesh_.star[v];
  mesh_.fans(v, fan_);
  normals_.assign(star.size(), Vec3{});
  std::vector<Vec3> sum(star.size());
  for (std::size_t i = 0; i < star.size(); ++i)
    sum[fan_[i]] = sum[fan_[i]] + mesh_.area_vector(mesh_.triangles[star[i]].v);
  for (std::size_t i = 0; i < star.size(); ++i) normals_[i] = unit(sum[fan_[i]]);
}

Vec3 LocalOperations::neighbours_mean(std::int32_t v) const {
  Vec3 sum;
  for (std::int32_t t : mesh_.star[v])
    for (std::int32_t x : mesh_.triangles[t].v)
      if (x != v) sum = sum + mesh_.points[x];
  return (0.5 / static_cast<double>(mesh_.star[v].size())) * sum;
}

bool LocalOperations::move(std::int32_t v, const Vec3& to) {
  if (!mesh_.contains(to)) return false;
  removed_.assign(mesh_.star[v].begin(), mesh_.star[v].end());
  added_.clear();
  for (std::int32_t t : removed_) added_.push_back(mesh_.triangles[t].v);
  Change c;
  c.removed = &removed_;
  c.added = &added_;
  c.moved = v;
  c.to = to;
  c.clearance_mm = clearance_rel() * size_[v];
  if (!guard.allows(c)) return false;
  mesh_.points[v] = to;
  guard.update(removed_);
  ++counts.relocations;
  return true;
}

bool LocalOperations::split(std::int32_t a, std::int32_t b) {
  Vec3 p = 0.5 * (mesh_.points[a] + mesh_.points[b]);
  if (mesh_.flat[a] && mesh_.flat[b] && mesh_.points[a].z == mesh_.points[b].z) p.z = mesh_.points[a].z;
  mesh_.edge_triangles(a, b, removed_);
  // A triangle whose third corner is near the middle is for a flip, and so is a needle.
  const double least = 0.05 * length(a, b);
  bool needle = false;
  for (std::int32_t t : removed_) {
    if (mesh_.is_frozen(t)) return false;
    for (std::int32_t w : mesh_.triangles[t].v)
      needle = needle || (w != a && w != b && norm(mesh_.points[w] - p) < least);
    needle = needle || angle(mesh_.triangles[t].v) < kNeedle;
  }
  if (needle) return mesh_.is_curve_edge(a, b) && absorb(a, b);
  const auto n = static_cast<std::int32_t>(mesh_.points.size());
  added_.clear();
  for (std::int32_t t : removed_) {
    auto v = mesh_.triangles[t].v, w = v;
    std::replace(v.begin(), v.end(), b, n);
    std::replace(w.begin(), w.end(), a, n);
    added_.push_back(v);
    added_.push_back(w);
  }
  Change c;
  c.removed = &removed_;
  c.added = &added_;
  c.moved = n;
  c.to = p;
  c.clearance_mm = 1e-6 * length(a, b);
  if (!guard.allows(c)) return false;
  const auto first = static_cast<std::int32_t>(mesh_.triangles.size());
  mesh_.split(a, b, p);
  size_.push_back(asked(a, b));
  hints.push_back(hints[a]);
  touched_ = removed_;
  for (std::int32_t t = first; t < static_cast<std::int32_t>(mesh_.triangles.size()); ++t) touched_.push_back(t);
  guard.update(touched_);
  ++counts.splits;
  return true;
}

bool LocalOperations::collapse(std::int32_t gone, std::int32_t kept, double floor_rad) {
  if (mesh_.is_held(gone) || mesh_.pinned[gone]) return false;
  if (!mesh_.can_collapse(gone, kept)) {
    if (!lenient || mesh_.curve[gone].empty() || length(gone, kept) > kMergeRel * asked(gone, kept)) return false;
    if (mesh_.flat[gone] && !(mesh_.flat[kept] && mesh_.points[gone].z == mesh_.points[kept].z)) return false;
    if (!mesh_.can_merge(gone, kept)) return false;
  }
  const Vec3 target = mesh_.points[kept], old = mesh_.points[gone];
  const double asked_length = asked(gone, kept), reach = reach_rel() * asked_length;
  if (!mesh_.curve[gone].empty()) {
    for (std::int32_t c : mesh_.curve[gone])
      if (c != kept) {
        const Vec3 d = old - nearest_on_segment(old, target, mesh_.points[c]);
        if (dot(d, d) > 2.5 * reach * reach) return false;
      }
  }
  const auto& star = mesh_.star[gone];
  double longest_old = 0;
  added_.clear();
  for (std::int32_t t : star) {
    auto v = mesh_.triangles[t].v;
    for (std::int32_t w : v)
      if (w != gone) longest_old = std::max(longest_old, length(gone, w));
    if (v[0] == kept || v[1] == kept || v[2] == kept) continue;
    std::replace(v.begin(), v.end(), gone, kept);
    added_.push_back(v);
  }
  for (const auto& v : added_)
    for (std::int32_t w : v)
      if (w != kept && length(kept, w) > std::max((lenient ? 2 : kSqrt2) * asked(kept, w), longest_old)) return false;
  double worst = 10, worst_old = -1;
  for (const auto& v : added_) {
    worst = std::min(worst, angle(v));
    if (worst >= floor_rad) continue;
    if (worst_old < 0) {
      worst_old = 10;
      for (std::int32_t t : star) worst_old = std::min(worst_old, angle(mesh_.triangles[t].v));
    }
    if (worst < worst_old) return false;
  }
  fan_normals(gone);
  std::size_t next = 0;
  double off = 1e300;
  for (std::size_t i = 0; i < star.size(); ++i) {
    const auto& v = mesh_.triangles[star[i]].v;
    if (v[0] == kept || v[1] == kept || v[2] == kept) continue;
    const auto& w = added_[next++];
    const Vec3 n = unit(mesh_.area_vector(w));
    const double along = dot(n, normals_[i]);
    if (along < fold() && along < dot(unit(mesh_.area_vector(v)), normals_[i]) + 1e-9) return false;
    const Vec3 d = old - nearest_on_triangle(old, mesh_.points[w[0]], mesh_.points[w[1]], mesh_.points[w[2]]);
    off = std::min(off, dot(d, d));
  }
  if (mesh_.curve[gone].empty() && off > reach * reach) return false;
  removed_.assign(star.begin(), star.end());
  Change c;
  c.removed = &removed_;
  c.added = &added_;
  c.clearance_mm = clearance_rel() * std::min(asked_length, longest_old);
  if (!guard.allows(c)) return false;
  mesh_.collapse(gone, kept);
  guard.update(removed_);
  ++counts.collapses;
  return true;
}

int LocalOperations::ideal_valence_error(std::int32_t v, int change) const {
  const int count = static_cast<int>(mesh_.star[v].size()) + change;
  if (!mesh_.curve[v].empty()) return 0;
  return (count - 6) * (count - 6);
}

bool LocalOperations::flip(std::int32_t a, std::int32_t b, double gain_rad, bool valence) {
  std::array<std::int32_t, 2> t, apex;
  if (mesh_.is_curve_edge(a, b)) return absorb(a, b);
  if (!mesh_.can_flip(a, b, t, apex)) return false;
  if (mesh_.is_frozen(t[0]) || mesh_.is_frozen(t[1])) return false;
  const auto [c, d] = apex;
  const std::array<std::int32_t, 3> one = {a, d, c}, two = {d, b, c};
  const double before = std::min(angle(mesh_.triangles[t[0]].v), angle(mesh_.triangles[t[1]].v));
  const double after = std::min(angle(one), angle(two));
  // Needles along a long edge lie back to back: it is turned for a shorter one, whatever the angles, and so on.
  const double needle = lenient ? 5 * kNeedle : kNeedle;
  bool better =
      after > before + gain_rad || (before < needle && (after > 2 * before || length(c, d) < 0.9 * length(a, b)));
  if (!better && valence && after > std::max(0.45, 0.8 * before)) {
    const int was =
        ideal_valence_error(a, 0) + ideal_valence_error(b, 0) + ideal_valence_error(c, 0) + ideal_valence_error(d, 0);
    const int is =
        ideal_valence_error(a, -1) + ideal_valence_error(b, -1) + ideal_valence_error(c, 1) + ideal_valence_error(d, 1);
    better = is < was;
  }
  if (!better) return false;
  const Vec3 n0 = mesh_.area_vector(mesh_.triangles[t[0]].v), n1 = mesh_.area_vector(mesh_.triangles[t[1]].v);
  const Vec3 sum = unit(n0 + n1), m0 = unit(mesh_.area_vector(one)), m1 = unit(mesh_.area_vector(two));
  // The normal of a needle says nothing.
  if ((dot(m0, sum) < kFlipBend && angle(one) > needle) || (dot(m1, sum) < kFlipBend && angle(two) > needle))
    return false;
  // Where the four corners are far from a plane, the flip changes the surface.
  const double out = std::abs(dot(sum, mesh_.points[a] + mesh_.points[b] - mesh_.points[c] - mesh_.points[d])) / 2;
  if (out > reach_rel() * asked(a, b)) return false;
  removed_ = {t[0], t[1]};
  added_ = {one, two};
  Change change;
  change.removed = &removed_;
  change.added = &added_;
  change.clearance_mm = before < needle ? 1e-6 * length(a, b) : clearance_rel() * asked(a, b);
  if (!guard.allows(change)) return false;
  mesh_.flip(a, b, t, apex);
  guard.update(removed_);
  ++counts.flips;
  return true;
}

bool LocalOperations::absorb(std::int32_t a, std::int32_t b) {
  const Vec3 from = mesh_.points[a], to = mesh_.points[b];
  std::vector<std::int32_t> around;
  mesh_.edge_triangles(a, b, around);
  std::int32_t needle = -1, c = -1;
  double height = std::min(0.05 * length(a, b), reach_rel() * asked(a, b));
  for (std::int32_t t : around) {
    if (mesh_.is_frozen(t)) return false;
    for (std::int32_t w : mesh_.triangles[t].v) {
      if (w == a || w == b || mesh_.is_held(w) || mesh_.pinned[w] || !mesh_.curve[w].empty()) continue;
      const double h = norm(mesh_.points[w] - nearest_on_segment(mesh_.points[w], from, to));
      if (h >= height) continue;
      height = h;
      needle = t;
      c = w;
    }
  }
  if (needle < 0) return false;
  Change change;
  change.moved = c;
  change.to = nearest_on_segment(mesh_.points[c], from, to);
  if (from.z == to.z) change.to.z = from.z;
  if (!(norm(change.to - from) > 0 && norm(change.to - to) > 0)) return false;
  if (mesh_.flat[c] && change.to.z != mesh_.points[c].z) return false;
  removed_.assign(mesh_.star[c].begin(), mesh_.star[c].end());
  added_.clear();
  for (std::int32_t t : removed_)
    if (t != needle) added_.push_back(mesh_.triangles[t].v);
  const double before = angle(mesh_.triangles[needle].v);
  for (const auto& v : added_) {
    Vec3 p[3];
    for (int k = 0; k < 3; ++k) p[k] = v[k] == c ? change.to : mesh_.points[v[k]];
    const Vec3 n = cross(p[1] - p[0], p[2] - p[0]), m = mesh_.area_vector(v);
    if (smallest_angle(p[0], p[1], p[2]) < before || dot(n, m) < fold() * norm(n) * norm(m)) return false;
  }
  for (std::int32_t t : around) {
    if (t == needle) continue;
    auto v = mesh_.triangles[t].v, w = v;
    for (std::int32_t d : v)
      if (d != a && d != b && (d == c || mesh_.has_edge(c, d))) return false;
    std::replace(v.begin(), v.end(), b, c);
    std::replace(w.begin(), w.end(), a, c);
    added_.push_back(v);
    added_.push_back(w);
    removed_.push_back(t);
  }
  change.removed = &removed_;
  change.added = &added_;
  change.clearance_mm = 1e-6 * length(a, b);
  if (!guard.allows(change)) return false;
  const auto first = static_cast<std::int32_t>(mesh_.triangles.size());
  mesh_.points[c] = change.to;
  mesh_.absorb(a, b, needle);
  for (std::int32_t t = first; t < static_cast<std::int32_t>(mesh_.triangles.size()); ++t) removed_.push_back(t);
  guard.update(removed_);
  ++counts.flips;
  return true;
}

bool LocalOperations::cut_tip(std::int32_t a, std::int32_t b) {
  constexpr std::size_t kMost = 80;  // triangles of a tip
  std::vector<std::int32_t> edge, of_a, of_b;
  mesh_.edge_triangles(a, b, edge);
  if (edge.size() != 2) return false;
  mesh_.neighbours(a, of_a);
  mesh_.neighbours(b, of_b);
  for (std::int32_t c : of_a) {
    if (!std::binary_search(of_b.begin(), of_b.end(), c)) continue;
    for (std::int32_t start : edge) {
      removed_ = mesh_.disc_behind({a, b, c}, start, kMost);
      if (removed_.empty()) continue;
      const Vec3 &p = mesh_.points[a], &q = mesh_.points[b], &r = mesh_.points[c];
      double far = 0;
      for (std::int32_t t : removed_)
        for (std::int32_t v : mesh_.triangles[t].v)
          far = std::max(far, norm(mesh_.points[v] - nearest_on_triangle(mesh_.points[v], p, q, r)));
      if (far > asked(a, b)) continue;
      added_ = {{a, b, c}};
      double worst = 10;
      for (std::int32_t t : removed_) worst = std::min(worst, angle(mesh_.triangles[t].v));
      if (angle(added_[0]) < worst) continue;
      Change change;
      change.removed = &removed_;
      change.added = &added_;
      change.clearance_mm = clearance_rel() * asked(a, b);
      if (!guard.allows(change)) continue;
      mesh_.replace_disc(removed_, added_);
      guard.update(removed_);
      ++counts.collapses;
      return true;
    }
  }
  return false;
}

bool LocalOperations::is_speck(std::int32_t v) const {
  constexpr std::size_t kFew = 24;
  std::vector<std::int32_t> sheet(mesh_.star[v].begin(), mesh_.star[v].end()), around;
  for (std::size_t i = 0; i < sheet.size() && sheet.size() <= kFew; ++i) {
    const auto& t = mesh_.triangles[sheet[i]].v;
    for (int k = 0; k < 3; ++k) {
      if (mesh_.is_curve_edge(t[k], t[(k + 1) % 3])) continue;
      mesh_.edge_triangles(t[k], t[(k + 1) % 3], around);
      for (std::int32_t u : around)
        if (std::find(sheet.begin(), sheet.end(), u) == sheet.end()) sheet.push_back(u);
    }
  }
  return sheet.size() <= kFew;
}

bool LocalOperations::crowds(std::int32_t v, const Vec3& to) const {
  for (std::int32_t t : mesh_.star[v])
    for (std::int32_t x : mesh_.triangles[t].v) {
      const double apart = norm(to - mesh_.points[x]);
      if (x != v && apart < 0.3 * size_[v] && apart < length(v, x)) return true;
    }
  return false;
}

bool LocalOperations::smooth_over(std::int32_t v) {
  if (mesh_.is_held(v) || mesh_.is_fixed(v) || mesh_.star[v].empty() || is_speck(v)) return false;
  const Vec3 here = mesh_.points[v];
  Vec3 mean;
  if (mesh_.curve[v].empty()) mean = neighbours_mean(v);
  else
    for (std::int32_t c : mesh_.curve[v]) mean = mean + 0.5 * mesh_.points[c];
  Vec3 step = 0.7 * (mean - here);
  if (mesh_.flat[v]) step.z = 0;
  const double l = norm(step), most = 0.5 * size_[v];
  if (!(l > 1e-3 * size_[v])) return false;
  if (l > most) step = (most / l) * step;
  const std::int32_t patch = mesh_.triangles[mesh_.star[v][0]].patch;
  for (double share : {1.0, 0.5, 0.25}) {
    const Vec3 to = here + share * step;
    if (!crowds(v, to) && reference_.nearest(to, patch, reach_rel() * size_[v], -1, 0) && move(v, to)) return true;
  }
  return false;
}

Vec3 LocalOperations::drawn_to_reference(std::int32_t v, const Vec3& p) const {
  const Vec3& here = mesh_.points[v];
  if (mesh_.is_fixed(v)) return here;
  const double reach = size_[v] + norm(p - here);
  Vec3 to = here;
  if (!mesh_.curve[v].empty()) {
    const auto foot = reference_.nearest_on_curve(p, Reference::curve_key(mesh_, v, mesh_.curve[v][0]), reach);
    if (foot) to = *foot;
  } else if (mesh_.flat[v]) {
    to = p;
  } else {
    const auto foot = reference_.nearest(p, mesh_.triangles[mesh_.star[v][0]].patch, reach, hints[v], 0.5 * reach);
    if (foot) {
      to = foot->point;
      hints[v] = foot->face;
    }
  }
  if (mesh_.flat[v]) to.z = here.z;
  return to;
}

double LocalOperations::smallest_round(std::int32_t v, const Vec3& at, const std::vector<Vec3>& fan_normals) const {
  double worst = 10;
  const auto& star = mesh_.star[v];
  for (std::size_t i = 0; i < star.size(); ++i) {
    const auto& t = mesh_.triangles[star[i]].v;
    Vec3 p[3];
    for (int k = 0; k < 3; ++k) p[k] = t[k] == v ? at : mesh_.points[t[k]];
    if (dot(unit(cross(p[1] - p[0], p[2] - p[0])), fan_normals[i]) < fold()) return -1;
    worst = std::min(worst, smallest_angle(p[0], p[1], p[2]));
  }
  return worst;
}

bool LocalOperations::relocate(std::int32_t v) {
  if (mesh_.is_held(v)) return false;
  fan_normals(v);
  const Vec3 here = mesh_.points[v];
  double now = 10;
  for (std::int32_t t : mesh_.star[v]) now = std::min(now, angle(mesh_.triangles[t].v));
  std::vector<std::pair<double, Vec3>> places;
  const auto offer = [&](const Vec3& p) {
    const Vec3 q = drawn_to_reference(v, p);
    const double a = smallest_round(v, q, normals_);
    if (a > now + 0.005) places.push_back({a, q});
  };
  // Curves and fixed points may leave their place a little for a very narrow triangle.
  if (now < 0.3 && (mesh_.is_fixed(v) || !mesh_.curve[v].empty())) {
    std::size_t worst = 0;
    double least = 10;
    for (std::size_t i = 0; i < mesh_.star[v].size(); ++i) {
      const double a = angle(mesh_.triangles[mesh_.star[v][i]].v);
      if (a < least) {
        least = a;
        worst = i;
      }
    }
    const auto& t = mesh_.triangles[mesh_.star[v][worst]].v;
    const int k = t[0] == v ? 0 : t[1] == v ? 1 : 2;
    const Vec3 &p = mesh_.points[t[(k + 1) % 3]], &q = mesh_.points[t[(k + 2) % 3]];
    const Vec3 e = unit(q - p), out = here - p - dot(here - p, e) * e, mean = 0.5 * (p + q);
    for (const Vec3& d :
         {unit(out), unit(here - mean), unit(here - p), unit(here - q), unit(cross(e, normals_[worst]))})
      for (double r : {-0.12, -0.06, 0.03, 0.06, 0.12}) {
        Vec3 to = here + (r * size_[v]) * d;
        if (mesh_.flat[v]) to.z = here.z;
        const double a = smallest_round(v, to, normals_);
        if (a > now + 0.005) places.push_back({a, to});
      }
  }
  if (mesh_.is_fixed(v)) {
  } else if (!mesh_.curve[v].empty()) {
    for (std::int32_t c : mesh_.curve[v])
      for (double s : {0.1, 0.2, 0.35, 0.5}) offer(here + s * (mesh_.points[c] - here));
  } else {
    const Vec3 n = normals_[0];
    const Vec3 u = unit(cross(n, std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})), w = cross(n, u);
    double l = 1e300;
    for (std::int32_t t : mesh_.star[v])
      for (std::int32_t x : mesh_.triangles[t].v)
        if (x != v) l = std::min(l, length(v, x));
    l = std::max(l, 0.25 * size_[v]);
    offer(neighbours_mean(v));
    for (double r : {0.5, 0.25, 0.1})
      for (int k = 0; k < 8; ++k) {
        const double phi = k * M_PI / 4;
        offer(here + (r * l * std::cos(phi)) * u + (r * l * std::sin(phi)) * w);
      }
  }
  std::stable_sort(places.begin(), places.end(), [](const auto& x, const auto& y) { return x.first > y.first; });
  if (places.size() > 4) places.resize(4);
  for (const auto& [a, q] : places)
    if (move(v, q)) return true;
  return false;
}

}  // namespace stackmesh
