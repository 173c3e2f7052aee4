#include "enhance/complex_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "base/parallel.h"
#include "enhance/triangle_corners.h"

namespace stackmesh {
ComplexMesh::ComplexMesh(const InterfaceComplex& complex, double cap_area_mm2, int threads, bool inner_caps)
    : points(complex.points) {
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
  for_each_index(points.size(), threads,
                 [&](std::size_t v) { pinned[v] = !star[v].empty() && is_pinched(static_cast<std::int32_t>(v)); });
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
      for (std::size_t i = 0; i < fan.size(); ++i) touching += fan[i] == f && holds(triangles[star[v][i]].v, c);
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
