#include "enhance/complex_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "base/parallel.h"

namespace stackmesh {
namespace {

bool holds(const std::array<std::int32_t, 3>& v, std::int32_t x) {
  return v[0] == x || v[1] == x || v[2] == x;
}

std::int32_t third(const std::array<std::int32_t, 3>& v, std::int32_t a, std::int32_t b) {
  for (std::int32_t x : v)
    if (x != a && x != b) return x;
  return -1;
}

/// True when the triangle runs from a to b.
bool runs(const std::array<std::int32_t, 3>& v, std::int32_t a, std::int32_t b) {
  return (v[0] == a && v[1] == b) || (v[1] == a && v[2] == b) || (v[2] == a && v[0] == b);
}

void drop(ShortList& list, std::int32_t x) {
  const auto it = std::find(list.begin(), list.end(), x);
  if (it != list.end()) list.erase(it);
}

bool has(const ShortList& list, std::int32_t x) {
  return std::find(list.begin(), list.end(), x) != list.end();
}

}  // namespace

ComplexMesh::ComplexMesh(const InterfaceComplex& complex, double cap_area_mm2, int threads, bool inner_caps) : points(complex.points) {
  std::map<std::pair<Label, Label>, std::int32_t> numbers;
  std::pair<Label, Label> last = {0, 0};  // neighbours in the list mostly have the same pair
  for (const InterfaceTriangle& t : complex.triangles) {
    const std::pair<Label, Label> pair = std::minmax(t.below, t.above);
    if (pair != last || numbers.empty()) numbers[last = pair] = 0;
  }
  for (auto& [pair, n] : numbers) {
    n = static_cast<std::int32_t>(pairs_.size());
    pairs_.push_back(pair);
    labels_.push_back(pair.first);
    labels_.push_back(pair.second);
  }
  std::sort(labels_.begin(), labels_.end());
  labels_.erase(std::unique(labels_.begin(), labels_.end()), labels_.end());
  const auto number_of = [&](Label l) {
    return static_cast<std::int32_t>(std::lower_bound(labels_.begin(), labels_.end(), l) - labels_.begin());
  };
  for (const auto& [below, above] : pairs_) sides_.push_back({number_of(below), number_of(above)});
  star.resize(points.size());
  curve.resize(points.size());
  pinned.assign(points.size(), 0);
  flat.assign(points.size(), 0);
  triangles.reserve(complex.triangles.size());
  std::int32_t number = numbers.empty() ? 0 : numbers.at(last);
  for (const InterfaceTriangle& t : complex.triangles) {
    MeshTriangle m;
    m.v = t.v;
    if (t.below > t.above) std::swap(m.v[1], m.v[2]);
    const std::pair<Label, Label> pair = std::minmax(t.below, t.above);
    if (pair != last) number = numbers.at(last = pair);
    m.patch = 2 * number;
    for (std::int32_t v : m.v) star[v].push_back(static_cast<std::int32_t>(triangles.size()));
    triangles.push_back(m);
  }
  mark_caps(cap_area_mm2, inner_caps);
  find_curves(threads);
  find_pinned(threads);
}

void ComplexMesh::mark_caps(double cap_area_mm2, bool inner_caps) {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const Vec3& p : points) {
    lowest = std::min(lowest, p.z);
    highest = std::max(highest, p.z);
  }
  const auto horizontal = [&](std::int32_t t) {
    const auto& v = triangles[t].v;
    return points[v[0]].z == points[v[1]].z && points[v[0]].z == points[v[2]].z;
  };
  std::vector<char> seen(triangles.size(), 0);
  std::vector<std::int32_t> region, around;
  for (std::int32_t s = 0; s < static_cast<std::int32_t>(triangles.size()); ++s) {
    if (seen[s] || !horizontal(s)) continue;
    if (const double z = points[triangles[s].v[0]].z; !inner_caps && z != lowest && z != highest) continue;
    region.assign(1, s);
    seen[s] = 1;
    double area = 0;
    for (std::size_t i = 0; i < region.size(); ++i) {
      const auto v = triangles[region[i]].v;
      area += std::abs(area_vector(v).z);
      for (int k = 0; k < 3; ++k) {
        edge_triangles(v[k], v[(k + 1) % 3], around);
        for (std::int32_t t : around)
          if (!seen[t] && horizontal(t)) {
            seen[t] = 1;
            region.push_back(t);
          }
      }
    }
    if (area < cap_area_mm2) continue;
    for (std::int32_t t : region) {
      triangles[t].patch |= 1;
      for (std::int32_t v : triangles[t].v) flat[v] = 1;
    }
  }
}

void ComplexMesh::find_curves(int threads) {
  for_each_index(points.size(), threads, [&](std::size_t n) {
    const auto v = static_cast<std::int32_t>(n);
    std::vector<std::int32_t> near, around;
    neighbours(v, near);
    for (std::int32_t w : near) {
      edge_triangles(v, w, around);
      const bool regular = around.size() == 2 && triangles[around[0]].patch == triangles[around[1]].patch &&
                           runs(triangles[around[0]].v, v, w) != runs(triangles[around[1]].v, v, w);
      if (!regular) curve[v].push_back(w);
    }
  });
}

void ComplexMesh::find_pinned(int threads) {
  for_each_index(points.size(), threads, [&](std::size_t v) {
    pinned[v] = !star[v].empty() && is_pinched(static_cast<std::int32_t>(v));
  });
}

/// A free vertex has one closed fan; one on a curve has fans that all run from one curve edge to the other.
bool ComplexMesh::is_pinched(std::int32_t v) const {
  if (!curve[v].empty() && curve[v].size() != 2) return false;  // fixed anyway
  std::vector<std::int32_t> fan;
  fans(v, fan);
  const int count = 1 + *std::max_element(fan.begin(), fan.end());
  if (curve[v].empty()) return count != 1;
  for (int f = 0; f < count; ++f)
    for (std::int32_t c : curve[v]) {
      int touching = 0;
      for (std::size_t i = 0; i < fan.size(); ++i)
        touching += fan[i] == f && holds(triangles[star[v][i]].v, c);
      if (touching != 1) return true;
    }
  return false;
}

bool ComplexMesh::is_curve_edge(std::int32_t a, std::int32_t b) const {
  return has(curve[a], b);
}

bool ComplexMesh::has_edge(std::int32_t a, std::int32_t b) const {
  for (std::int32_t t : star[a])
    if (holds(triangles[t].v, b)) return true;
  return false;
}

void ComplexMesh::edge_triangles(std::int32_t a, std::int32_t b, std::vector<std::int32_t>& out) const {
  out.clear();
  for (std::int32_t t : star[a])
    if (holds(triangles[t].v, b)) out.push_back(t);
}

void ComplexMesh::neighbours(std::int32_t v, std::vector<std::int32_t>& out) const {
  out.clear();
  for (std::int32_t t : star[v])
    for (std::int32_t w : triangles[t].v)
      if (w != v) out.push_back(w);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

void ComplexMesh::fans(std::int32_t v, std::vector<std::int32_t>& out) const {
  const auto& s = star[v];
  out.assign(s.size(), -1);
  std::int32_t count = 0;
  std::vector<std::int32_t> stack;
  for (std::size_t first = 0; first < s.size(); ++first) {
    if (out[first] >= 0) continue;
    out[first] = count;
    stack.assign(1, static_cast<std::int32_t>(first));
    while (!stack.empty()) {
      const auto& t = triangles[s[stack.back()]].v;
      stack.pop_back();
      for (std::size_t j = 0; j < s.size(); ++j) {
        if (out[j] >= 0) continue;
        for (std::int32_t w : t)
          if (w != v && holds(triangles[s[j]].v, w) && !is_curve_edge(v, w)) {
            out[j] = count;
            stack.push_back(static_cast<std::int32_t>(j));
            break;
          }
      }
    }
    ++count;
  }
}

std::vector<std::array<std::int32_t, 2>> ComplexMesh::edges() const {
  std::vector<std::array<std::int32_t, 2>> out;
  out.reserve(triangles.size() * 3 / 2);
  for (std::int32_t a = 0; a < static_cast<std::int32_t>(points.size()); ++a)
    edges_from(a, [&](std::int32_t b) { out.push_back({a, b}); });
  return out;
}

bool ComplexMesh::can_collapse(std::int32_t gone, std::int32_t kept) const {
  if (is_fixed(gone)) return false;
  if (!curve[gone].empty()) {
    if (!is_curve_edge(gone, kept)) return false;
    for (std::int32_t c : curve[gone])
      if (c != kept && is_curve_edge(c, kept)) return false;  // a loop of three
  }
  // Common neighbours must be the apexes of the edge's triangles, and no triangle of `gone` may land on
  // another.
  std::int32_t apexes[16];
  int count = 0;
  for (std::int32_t t : star[gone])
    if (holds(triangles[t].v, kept)) {
      if (count == 16) return false;
      apexes[count++] = third(triangles[t].v, gone, kept);
    }
  if (count == 0) return false;
  const auto is_apex = [&](std::int32_t w) { return std::find(apexes, apexes + count, w) != apexes + count; };
  for (std::int32_t t : star[gone]) {
    const auto& v = triangles[t].v;
    if (holds(v, kept)) continue;
    int common = 0;
    for (std::int32_t w : v) {
      if (w == gone) continue;
      const bool shared = is_apex(w);
      if (!shared && has_edge(kept, w)) return false;
      common += shared;
    }
    if (common < 2) continue;
    for (std::int32_t s : star[kept]) {
      bool same = true;
      for (std::int32_t w : v) same = same && (w == gone || holds(triangles[s].v, w));
      if (same) return false;
    }
  }
  return true;
}

/// True when the boundary of a label (by its number) is one closed fan at v, or does not come there.
bool ComplexMesh::is_plain_for(std::int32_t v, std::int32_t side) const {
  std::int32_t list[64], count = 0;
  for (std::int32_t t : star[v]) {
    const auto& s = sides(triangles[t].patch);
    if (s[0] != side && s[1] != side) continue;
    if (count == 64) return false;
    list[count++] = t;
  }
  if (count == 0) return true;
  // Walk round: over each edge at v exactly one other triangle of the label.
  std::int32_t at = list[0];
  const std::int32_t first = triangles[at].v[0] == v ? triangles[at].v[1] : triangles[at].v[0];
  std::int32_t entry = first;
  for (std::int32_t seen = 1;; ++seen) {
    const std::int32_t edge = third(triangles[at].v, v, entry);
    std::int32_t next = -1;
    for (std::int32_t i = 0; i < count; ++i)
      if (list[i] != at && holds(triangles[list[i]].v, edge)) {
        if (next >= 0) return false;
        next = list[i];
      }
    if (next < 0) return false;
    if (next == list[0]) return edge == first && seen == count;
    if (seen > count) return false;
    at = next;
    entry = edge;
  }
}

bool ComplexMesh::can_merge(std::int32_t gone, std::int32_t kept) const {
  if (pinned[gone] || pinned[kept] || !has_edge(gone, kept)) return false;
  ShortList labels;
  for (std::int32_t t : star[gone])
    for (std::int32_t l : sides(triangles[t].patch))
      if (!has(labels, l)) labels.push_back(l);
  const auto belongs = [&](std::int32_t t, std::int32_t l) {
    const auto& s = sides(triangles[t].patch);
    return s[0] == l || s[1] == l;
  };
  for (std::int32_t l : labels) {
    bool there = false;
    for (std::int32_t t : star[kept]) there = there || belongs(t, l);
    if (!is_plain_for(gone, l)) return false;
    if (!there) continue;
    if (!is_plain_for(kept, l)) return false;
    ShortList apexes, near;
    for (std::int32_t t : star[gone]) {
      if (!belongs(t, l)) continue;
      const auto& v = triangles[t].v;
      if (holds(v, kept)) apexes.push_back(third(v, gone, kept));
      for (std::int32_t w : v)
        if (w != gone && w != kept && !has(near, w)) near.push_back(w);
    }
    if (apexes.size() != 2 || apexes[0] == apexes[1]) return false;
    for (std::int32_t t : star[kept])
      if (belongs(t, l))
        for (std::int32_t w : triangles[t].v)
          if (has(near, w) && !has(apexes, w)) return false;
  }
  for (std::int32_t t : star[gone]) {
    if (holds(triangles[t].v, kept)) continue;
    for (std::int32_t s : star[kept]) {
      bool same = true;
      for (std::int32_t w : triangles[t].v) same = same && (w == gone || holds(triangles[s].v, w));
      if (same) return false;
    }
  }
  return true;
}

std::vector<std::int32_t> ComplexMesh::collapse(std::int32_t gone, std::int32_t kept) {
  std::vector<std::int32_t> died;
  for (std::int32_t t : star[gone]) {
    MeshTriangle& m = triangles[t];
    if (holds(m.v, kept)) {
      died.push_back(t);
      continue;
    }
    for (std::int32_t& x : m.v)
      if (x == gone) x = kept;
    star[kept].push_back(t);
  }
  for (std::int32_t t : died) {
    for (std::int32_t x : triangles[t].v)
      if (x != gone) drop(star[x], t);
    triangles[t].patch = -1;
  }
  star[gone].clear();
  if (curve[gone].empty()) return died;
  const bool both = !curve[kept].empty();
  for (std::int32_t c : curve[gone]) {
    drop(curve[c], gone);
    if (c == kept || has(curve[kept], c)) continue;
    curve[c].push_back(kept);
    curve[kept].push_back(c);
  }
  curve[gone].clear();
  if (both && curve[kept].size() == 2) pinned[kept] = is_pinched(kept);
  return died;
}

bool ComplexMesh::can_flip(std::int32_t a, std::int32_t b, std::array<std::int32_t, 2>& t,
                           std::array<std::int32_t, 2>& apex) const {
  if (is_curve_edge(a, b)) return false;
  int count = 0;
  for (std::int32_t s : star[a])
    if (holds(triangles[s].v, b)) {
      if (count == 2) return false;
      t[count++] = s;
    }
  if (count != 2) return false;
  if (!runs(triangles[t[0]].v, a, b)) std::swap(t[0], t[1]);
  apex = {third(triangles[t[0]].v, a, b), third(triangles[t[1]].v, a, b)};
  return apex[0] != apex[1] && !has_edge(apex[0], apex[1]);
}

void ComplexMesh::flip(std::int32_t a, std::int32_t b, std::array<std::int32_t, 2> t,
                       std::array<std::int32_t, 2> apex) {
  const auto [c, d] = apex;
  triangles[t[0]].v = {a, d, c};
  triangles[t[1]].v = {d, b, c};
  drop(star[b], t[0]);
  drop(star[a], t[1]);
  star[d].push_back(t[0]);
  star[c].push_back(t[1]);
}

std::int32_t ComplexMesh::split(std::int32_t a, std::int32_t b, const Vec3& p) {
  const std::int32_t n = static_cast<std::int32_t>(points.size());
  std::vector<std::int32_t> around;
  edge_triangles(a, b, around);
  bool cap = false;
  points.push_back(p);
  star.emplace_back();
  curve.emplace_back();
  pinned.push_back(0);
  if (!held.empty()) held.push_back(0);
  for (std::int32_t t : around) {
    MeshTriangle copy = triangles[t];
    cap = cap || is_cap(copy.patch);
    const std::int32_t c = third(copy.v, a, b), added = static_cast<std::int32_t>(triangles.size());
    for (std::int32_t& x : triangles[t].v)
      if (x == b) x = n;
    for (std::int32_t& x : copy.v)
      if (x == a) x = n;
    drop(star[b], t);
    star[b].push_back(added);
    star[c].push_back(added);
    star[n].push_back(t);
    star[n].push_back(added);
    triangles.push_back(copy);
    if (!frozen.empty()) frozen.push_back(0);
  }
  flat.push_back(cap);
  if (is_curve_edge(a, b)) {
    std::replace(curve[a].begin(), curve[a].end(), b, n);
    std::replace(curve[b].begin(), curve[b].end(), a, n);
    curve[n] = {a, b};
  }
  return n;
}

void ComplexMesh::absorb(std::int32_t a, std::int32_t b, std::int32_t t) {
  const std::int32_t c = third(triangles[t].v, a, b);
  std::vector<std::int32_t> around;
  edge_triangles(a, b, around);
  for (std::int32_t v : triangles[t].v) drop(star[v], t);
  for (std::int32_t u : around) {
    if (u == t) continue;
    MeshTriangle copy = triangles[u];
    const std::int32_t d = third(copy.v, a, b), added = static_cast<std::int32_t>(triangles.size());
    std::replace(triangles[u].v.begin(), triangles[u].v.end(), b, c);
    std::replace(copy.v.begin(), copy.v.end(), a, c);
    drop(star[b], u);
    star[b].push_back(added);
    star[d].push_back(added);
    star[c].push_back(u);
    star[c].push_back(added);
    if (is_cap(copy.patch)) flat[c] = 1;
    triangles.push_back(copy);
    if (!frozen.empty()) frozen.push_back(0);
  }
  triangles[t].patch = -1;
  std::replace(curve[a].begin(), curve[a].end(), b, c);
  std::replace(curve[b].begin(), curve[b].end(), a, c);
  curve[c] = {a, b};
}

std::vector<std::int32_t> ComplexMesh::disc_behind(const std::array<std::int32_t, 3>& loop, std::int32_t start,
                                                   std::size_t most) const {
  std::vector<std::int32_t> disc = {start}, inside, around;
  int at_loop = 0;
  for (std::size_t i = 0; i < disc.size(); ++i) {
    const auto& v = triangles[disc[i]].v;
    if (is_frozen(disc[i]) || triangles[disc[i]].patch != triangles[start].patch || disc.size() > most) return {};
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = v[k], b = v[(k + 1) % 3];
      const bool corner = holds(loop, a);
      if (corner && holds(loop, b)) {
        ++at_loop;
        continue;
      }
      if (!corner) {
        if (pinned[a] || is_held(a) || !curve[a].empty()) return {};
        inside.push_back(a);
      }
      edge_triangles(a, b, around);
      if (around.size() != 2) return {};
      const std::int32_t next = around[around[0] == disc[i]];
      if (std::find(disc.begin(), disc.end(), next) == disc.end()) disc.push_back(next);
    }
  }
  std::sort(inside.begin(), inside.end());
  inside.erase(std::unique(inside.begin(), inside.end()), inside.end());
  if (at_loop != 3 || inside.empty() || disc.size() != 2 * inside.size() + 1) return {};
  return disc;
}

void ComplexMesh::replace_disc(const std::vector<std::int32_t>& disc, std::vector<std::array<std::int32_t, 3>> filling) {
  // All of the filling runs one way round: a side that it shares with the disc tells which.
  const auto shared = [&](const std::array<std::int32_t, 3>& f, int k, bool back) {
    return std::any_of(disc.begin(), disc.end(), [&](std::int32_t t) {
      return back ? runs(triangles[t].v, f[(k + 1) % 3], f[k]) : runs(triangles[t].v, f[k], f[(k + 1) % 3]);
    });
  };
  bool turned = false;
  for (const auto& f : filling)
    for (int k = 0; k < 3; ++k) turned = turned || (shared(f, k, true) && !shared(f, k, false));
  const std::int32_t patch = triangles[disc[0]].patch;
  for (std::int32_t t : disc) {
    for (std::int32_t x : triangles[t].v) drop(star[x], t);
    triangles[t].patch = -1;
  }
  for (std::size_t i = 0; i < filling.size(); ++i) {
    auto& f = filling[i];
    if (turned) std::swap(f[0], f[1]);
    triangles[disc[i]] = {f, patch};
    for (std::int32_t x : f) star[x].push_back(disc[i]);
  }
}

void ComplexMesh::add_ridge(std::int32_t a, std::int32_t b) {
  if (is_curve_edge(a, b)) return;
  curve[a].push_back(b);
  curve[b].push_back(a);
}

bool ComplexMesh::owned(std::int32_t v) const {
  for (std::int32_t t : star[v])
    if (!frozen[t]) return true;
  return star[v].empty();
}

ComplexMesh ComplexMesh::part(const std::vector<std::int32_t>& numbers, std::size_t free,
                              std::vector<std::int32_t>& vertices) const {
  ComplexMesh out;
  out.pairs_ = pairs_;
  out.labels_ = labels_;
  out.sides_ = sides_;
  vertices.clear();
  std::vector<std::int32_t> place(points.size(), -1);
  for (std::int32_t t : numbers)
    for (std::int32_t v : triangles[t].v)
      if (place[v] < 0) {
        place[v] = 0;
        vertices.push_back(v);
      }
  std::sort(vertices.begin(), vertices.end());
  for (std::size_t i = 0; i < vertices.size(); ++i) place[vertices[i]] = static_cast<std::int32_t>(i);
  const auto local = [&](std::int32_t v) { return place[v]; };
  const std::size_t n = vertices.size();
  out.star.resize(n);
  out.curve.resize(n);
  out.held.assign(n, 0);
  for (std::int32_t v : vertices) {
    out.points.push_back(points[v]);
    out.pinned.push_back(pinned[v]);
    out.flat.push_back(flat[v]);
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::int32_t c : curve[vertices[i]])
      if (const std::int32_t l = local(c); l >= 0) out.curve[i].push_back(l);
  out.triangles.reserve(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    MeshTriangle m = triangles[numbers[i]];
    for (std::int32_t& v : m.v) {
      v = local(v);
      out.star[v].push_back(static_cast<std::int32_t>(i));
      if (i >= free) out.held[v] = 1;
    }
    out.triangles.push_back(m);
    out.frozen.push_back(i >= free);
  }
  return out;
}

void ComplexMesh::compact(std::vector<double>& size, std::vector<std::int32_t>& hints) {
  std::vector<std::int32_t> number(points.size(), -1);
  std::size_t kept = 0;
  for (const MeshTriangle& t : triangles)
    if (t.patch >= 0) triangles[kept++] = t;
  triangles.resize(kept);
  for (const MeshTriangle& t : triangles)
    for (std::int32_t v : t.v) number[v] = 0;
  std::int32_t count = 0;
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (number[v] < 0) continue;
    points[count] = points[v];
    pinned[count] = pinned[v];
    flat[count] = flat[v];
    size[count] = size[v];
    hints[count] = hints[v];
    if (static_cast<std::size_t>(count) != v) curve[count] = std::move(curve[v]);
    number[v] = count++;
  }
  points.resize(count);
  pinned.resize(count);
  flat.resize(count);
  size.resize(count);
  hints.resize(count);
  curve.resize(count);
  star.resize(count);
  for (auto& list : curve)
    for (std::int32_t& c : list) c = number[c];
  for (auto& list : star) list.clear();
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::int32_t& v : triangles[t].v) {
      v = number[v];
      star[v].push_back(static_cast<std::int32_t>(t));
    }
}

InterfaceComplex ComplexMesh::to_complex() const {
  InterfaceComplex out;
  std::vector<std::int32_t> number(points.size(), -1);
  for (std::size_t v = 0; v < points.size(); ++v)
    if (!star[v].empty()) {
      number[v] = static_cast<std::int32_t>(out.points.size());
      out.points.push_back(points[v]);
    }
  for (const MeshTriangle& t : triangles) {
    if (t.patch < 0) continue;
    InterfaceTriangle i;
    i.v = {number[t.v[0]], number[t.v[1]], number[t.v[2]]};
    std::tie(i.below, i.above) = labels_of(t.patch);
    out.triangles.push_back(i);
  }
  return out;
}

}  // namespace stackmesh
