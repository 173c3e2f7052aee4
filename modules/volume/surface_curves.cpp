#include "volume/surface_curves.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace stackmesh::volume {
namespace {

Vec3 unit(Vec3 v) {
  const double length = norm(v);
  return length > 0 ? (1 / length) * v : Vec3{};
}

int corner(const InterfaceTriangle& t, std::int32_t v) {
  return t.v[0] == v ? 0 : t.v[1] == v ? 1 : 2;
}

}  // namespace

ElementEdges::ElementEdges(const TetMesh& mesh) : begin(mesh.points.size() + 1, 0) {
  const auto each = [&](auto visit) {
    for (const auto& t : mesh.tets)
      for (const auto& e : kTetEdges) visit(std::min(t[e[0]], t[e[1]]), std::max(t[e[0]], t[e[1]]));
    for (const auto& w : mesh.wedges)
      for (const auto& e : kWedgeEdges)
        if (w[e[0]] != w[e[1]]) visit(std::min(w[e[0]], w[e[1]]), std::max(w[e[0]], w[e[1]]));
  };
  each([&](std::int32_t low, std::int32_t) { ++begin[low + 1]; });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::int32_t> all(static_cast<std::size_t>(begin.back()));
  std::vector<std::int64_t> next(begin.begin(), begin.end() - 1);
  each([&](std::int32_t low, std::int32_t high) { all[next[low]++] = high; });
  larger.reserve(2 * mesh.tets.size());
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    const auto from = all.begin() + begin[p], to = all.begin() + begin[p + 1];
    std::sort(from, to);
    begin[p] = static_cast<std::int64_t>(larger.size());
    larger.insert(larger.end(), from, std::unique(from, to));
  }
  begin.back() = static_cast<std::int64_t>(larger.size());
}

std::int64_t ElementEdges::find(std::int32_t a, std::int32_t b) const {
  if (a > b) std::swap(a, b);
  const auto from = larger.begin() + begin[a], to = larger.begin() + begin[a + 1];
  const auto at = std::lower_bound(from, to, b);
  return at == to || *at != b ? -1 : at - larger.begin();
}

SurfaceCurves::SurfaceCurves(const TetMesh& mesh, const ElementEdges& edges, double ridge_deg)
    : mesh_(mesh), ridge_cosine_(std::cos(ridge_deg * 3.14159265358979323846 / 180)) {
  measure_triangles();
  collect_edges(edges);
  classify();
  collect_normals();
  collect_tangents();
}

std::vector<Vec3> SurfaceCurves::stand_off() const {
  std::vector<Vec3> sum(mesh_.points.size());
  std::vector<int> count(mesh_.points.size(), 0);
  std::vector<char> on_curve(mesh_.points.size(), 0);
  for (const SurfaceEdge& e : edges_)
    if (e.kind == Kind::curve) on_curve[e.p] = on_curve[e.q] = 1;
  for (const SurfaceEdge& e : edges_) {
    const Vec3 offset = offset_of(e);
    for (const std::int32_t v : {e.p, e.q}) {
      if (on_curve[v] != (e.kind == Kind::curve)) continue;
      sum[v] = sum[v] + offset;
      ++count[v];
    }
  }
  for (std::size_t v = 0; v < sum.size(); ++v) {
    const bool corner = on_curve[v] && dot(tangents_[v], tangents_[v]) == 0;
    sum[v] = corner || count[v] == 0 ? Vec3{} : (on_curve[v] ? 2.0 / 3 : 1.0) / count[v] * sum[v];
  }
  return sum;
}

void SurfaceCurves::measure_triangles() {
  normals_.resize(mesh_.faces.size());
  planes_.resize(mesh_.faces.size());
  for (std::size_t i = 0; i < normals_.size(); ++i) {
    const InterfaceTriangle& f = mesh_.faces[i];
    const Vec3 &a = mesh_.points[f.v[0]], &b = mesh_.points[f.v[1]], &c = mesh_.points[f.v[2]];
    normals_[i] = unit(f.below < f.above ? cross(b - a, c - a) : cross(c - a, b - a));
    planes_[i] = a.x == b.x && b.x == c.x ? 1 : a.y == b.y && b.y == c.y ? 2 : a.z == b.z && b.z == c.z ? 3 : 0;
  }
}

void SurfaceCurves::collect_edges(const ElementEdges& edges) {
  struct Side {
    std::int64_t edge;
    std::int32_t triangle;
  };
  std::vector<Side> sides;
  sides.reserve(3 * mesh_.faces.size());
  for (std::size_t i = 0; i < mesh_.faces.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const std::int64_t edge = edges.find(mesh_.faces[i].v[k], mesh_.faces[i].v[(k + 1) % 3]);
      if (edge >= 0) sides.push_back({edge, static_cast<std::int32_t>(i)});
    }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return a.edge != b.edge ? a.edge < b.edge : a.triangle < b.triangle; });
  for (const Side& s : sides) {
    if (edges_.empty() || edges_.back().edge != s.edge) {
      SurfaceEdge e;
      e.edge = s.edge;
      const auto low = std::upper_bound(edges.begin.begin(), edges.begin.end(), s.edge) - edges.begin.begin() - 1;
      e.p = static_cast<std::int32_t>(low), e.q = edges.larger[s.edge];
      edges_.push_back(e);
    }
    SurfaceEdge& e = edges_.back();
    if (e.count < 2) e.side[e.count] = s.triangle;
    ++e.count;
  }
}

void SurfaceCurves::classify() {
  for (SurfaceEdge& e : edges_) {
    e.kind = Kind::curve;
    if (e.count != 2) continue;
    const InterfaceTriangle &s = mesh_.faces[e.side[0]], &t = mesh_.faces[e.side[1]];
    const bool same = std::min(s.below, s.above) == std::min(t.below, t.above) &&
                      std::max(s.below, s.above) == std::max(t.below, t.above);
    const double cosine = dot(normals_[e.side[0]], normals_[e.side[1]]);
    if (same && planes_[e.side[0]] != 0 && planes_[e.side[0]] == planes_[e.side[1]]) e.kind = Kind::straight;
    else if (same && planes_[e.side[0]] == 0 && planes_[e.side[1]] == 0 && cosine >= ridge_cosine_)
      e.kind = Kind::smooth;
  }
}

Vec3 SurfaceCurves::offset_of(const SurfaceEdge& e) const {
  const Vec3 d = mesh_.points[e.q] - mesh_.points[e.p];
  return e.kind == Kind::straight ? Vec3{} : e.kind == Kind::smooth ? across(e, d) : along(e, d);
}

std::int32_t SurfaceCurves::root(std::int32_t c) {
  while (parent_[c] != c) c = parent_[c] = parent_[parent_[c]];
  return c;
}

/// A normal for each point and each smooth sheet through it: the corners of triangles that meet in edges which
/// are not sharp share it.
void SurfaceCurves::collect_normals() {
  parent_.resize(3 * mesh_.faces.size());
  std::iota(parent_.begin(), parent_.end(), 0);
  for (const SurfaceEdge& e : edges_)
    if (e.kind != Kind::curve)
      for (const std::int32_t v : {e.p, e.q}) {
        const auto a = root(3 * e.side[0] + corner(mesh_.faces[e.side[0]], v));
        const auto b = root(3 * e.side[1] + corner(mesh_.faces[e.side[1]], v));
        parent_[std::max(a, b)] = std::min(a, b);
      }
  sheet_normals_.assign(parent_.size(), Vec3{});
  for (std::size_t i = 0; i < mesh_.faces.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const auto& v = mesh_.faces[i].v;
      const Vec3 a = unit(mesh_.points[v[(k + 1) % 3]] - mesh_.points[v[k]]);
      const Vec3 b = unit(mesh_.points[v[(k + 2) % 3]] - mesh_.points[v[k]]);
      const double angle = std::acos(std::clamp(dot(a, b), -1.0, 1.0));
      Vec3& n = sheet_normals_[root(static_cast<std::int32_t>(3 * i) + k)];
      n = n + angle * normals_[i];
    }
  for (Vec3& n : sheet_normals_) n = unit(n);
  for (std::size_t c = 0; c < parent_.size(); ++c) parent_[c] = root(static_cast<std::int32_t>(c));
}

/// The direction of a sharp edge or junction at each point that two of them share without a corner.
void SurfaceCurves::collect_tangents() {
  struct Ends {
    std::int32_t other[2] = {-1, -1};
    int count = 0;
  };
  std::vector<Ends> ends(mesh_.points.size());
  for (const SurfaceEdge& e : edges_)
    if (e.kind == Kind::curve)
      for (const auto& [v, w] : {std::pair(e.p, e.q), std::pair(e.q, e.p)}) {
        if (ends[v].count < 2) ends[v].other[ends[v].count] = w;
        ++ends[v].count;
      }
  tangents_.assign(mesh_.points.size(), Vec3{});
  for (std::size_t v = 0; v < ends.size(); ++v) {
    if (ends[v].count != 2) continue;
    const Vec3 back = mesh_.points[v] - mesh_.points[ends[v].other[0]],
               on = mesh_.points[ends[v].other[1]] - mesh_.points[v];
    if (dot(unit(back), unit(on)) < ridge_cosine_) continue;
    const double a = norm(back), b = norm(on);  // the circle's tangent: the nearer neighbour counts more
    tangents_[v] = unit(b * unit(back) + a * unit(on));
  }
}

/// Both ways are exact on a circle: the height of an arc over its chord.
Vec3 SurfaceCurves::across(const SurfaceEdge& e, Vec3 d) const {
  const InterfaceTriangle& t = mesh_.faces[e.side[0]];
  const Vec3 n = sheet_normals_[parent_[3 * e.side[0] + corner(t, e.p)]];
  const Vec3 m = sheet_normals_[parent_[3 * e.side[0] + corner(t, e.q)]];
  const double length = norm(d);
  const auto half_tangent = [&](Vec3 normal) {
    return std::tan(std::asin(std::clamp(dot(d, normal) / length, -0.9, 0.9)) / 2);
  };
  return (length / 4 * (half_tangent(m) - half_tangent(n))) * unit(n + m);
}

Vec3 SurfaceCurves::along(const SurfaceEdge& e, Vec3 d) const {
  const auto tangent = [&](std::int32_t v) {
    const Vec3 t = tangents_[v];
    return dot(t, t) == 0 ? unit(d) : dot(t, d) < 0 ? -1.0 * t : t;
  };
  const Vec3 s = tangent(e.p), t = tangent(e.q);
  const double cosine = std::max(0.0, dot(s + t, unit(d)) / 2);
  return (norm(d) / (4 * (1 + cosine))) * (s - t);
}

}  // namespace stackmesh::volume
