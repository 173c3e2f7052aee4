// The local operations of a ComplexMesh: whether an edge may be collapsed or flipped, and the change of connectivity
// itself.
#include <algorithm>
#include <utility>

#include "enhance/complex_mesh.h"
#include "enhance/triangle_corners.h"

namespace stackmesh {

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

void ComplexMesh::replace_disc(const std::vector<std::int32_t>& disc,
                               std::vector<std::array<std::int32_t, 3>> filling) {
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

}  // namespace stackmesh
