#include "enhance/reference.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <numeric>
#include <unordered_set>

#include "base/parallel.h"
#include "model/triangle_contact.h"

namespace stackmesh {

std::size_t Reference::Cells::bucket(std::int32_t i, std::int32_t j, std::int32_t k) const {
  return (static_cast<std::uint32_t>(i) * 73856093u ^ static_cast<std::uint32_t>(j) * 19349663u ^
          static_cast<std::uint32_t>(k) * 83492791u) &
         mask;
}

template <class Corners>
void Reference::Cells::build(std::size_t count, double cell_mm, int threads, Corners corners) {
  const auto extent = [&](std::size_t n) {
    Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    for (const Vec3& p : corners(n)) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    return std::pair{low, high};
  };
  // Needles much longer than a cell (outlines drawn with tens of thousands of points) would be listed in thousands of
  // cells each.
  constexpr double kMostCells = 200;  // of a face, on average
  for (double most = kMostCells * static_cast<double>(count);; cell_mm *= 2) {
    double sum = 0;
    for (std::size_t n = 0; n < count && sum <= most; ++n) {
      const auto [low, high] = extent(n);
      sum += (1 + (high.x - low.x) / cell_mm) * (1 + (high.y - low.y) / cell_mm) * (1 + (high.z - low.z) / cell_mm);
    }
    if (sum <= most) break;
  }
  inverse = 1 / cell_mm;
  std::size_t size = 256;
  while (size < count) size *= 2;
  mask = size - 1;
  first.assign(size + 1, 0);
  const auto each_cell = [&](std::size_t n, auto body) {
    const auto [low, high] = extent(n);
    for (std::int32_t i = cell(low.x); i <= cell(high.x); ++i)
      for (std::int32_t j = cell(low.y); j <= cell(high.y); ++j)
        for (std::int32_t k = cell(low.z); k <= cell(high.z); ++k) body(bucket(i, j, k));
  };
  // The order within a bucket is not defined, and does not count: of two that are as near, the lower number is taken.
  std::vector<std::atomic<std::uint32_t>> next(size);
  for_each_index(count, threads, [&](std::size_t n) {
    each_cell(n, [&](std::size_t b) { next[b].fetch_add(1, std::memory_order_relaxed); });
  });
  for (std::size_t b = 0; b < size; ++b) {
    first[b + 1] = first[b] + next[b];
    next[b] = first[b];
  }
  items.resize(first[size]);
  for_each_index(count, threads, [&](std::size_t n) {
    each_cell(n, [&](std::size_t b) {
      items[next[b].fetch_add(1, std::memory_order_relaxed)] = static_cast<std::int32_t>(n);
    });
  });
}

template <class Visit>
void Reference::Cells::around(const Vec3& p, double r, Visit visit) const {
  for (std::int32_t i = cell(p.x - r); i <= cell(p.x + r); ++i)
    for (std::int32_t j = cell(p.y - r); j <= cell(p.y + r); ++j)
      for (std::int32_t k = cell(p.z - r); k <= cell(p.z + r); ++k) {
        const std::size_t b = bucket(i, j, k);
        for (std::uint32_t n = first[b]; n < first[b + 1]; ++n) visit(items[n]);
      }
}

std::uint64_t Reference::curve_key(const ComplexMesh& mesh, std::int32_t a, std::int32_t b,
                                   const std::vector<std::int32_t>* patch_of) {
  std::vector<std::int32_t> around;
  mesh.edge_triangles(a, b, around);
  for (std::int32_t& t : around) {
    t = mesh.triangles[t].patch;
    if (patch_of != nullptr) t = (*patch_of)[t];
  }
  std::sort(around.begin(), around.end());
  std::uint64_t key = 1469598103934665603ull;
  for (std::int32_t patch : around) key = (key ^ static_cast<std::uint64_t>(patch + 1)) * 1099511628211ull;
  return key;
}

namespace {

/// Of a vertex on a curve or ridge: the triangles about it that are reached from `start` without passing one; empty for
/// any other vertex. A normal averaged over a ridge would round off what it parts.
std::vector<std::int32_t> on_this_side(const ComplexMesh& mesh, std::int32_t v, std::int32_t start) {
  std::vector<std::int32_t> reached;
  if (mesh.curve[v].empty()) return reached;
  reached.push_back(start);
  for (std::size_t i = 0; i < reached.size(); ++i)
    for (const std::int32_t w : mesh.triangles[reached[i]].v) {
      if (w == v || std::find(mesh.curve[v].begin(), mesh.curve[v].end(), w) != mesh.curve[v].end()) continue;
      for (const std::int32_t o : mesh.star[v]) {
        const auto& c = mesh.triangles[o].v;
        if ((c[0] == w || c[1] == w || c[2] == w) && std::find(reached.begin(), reached.end(), o) == reached.end())
          reached.push_back(o);
      }
    }
  return reached;
}

}  // namespace

void Reference::add_faces(const ComplexMesh& mesh, const std::vector<std::int32_t>& patch_of, int threads) {
  const std::size_t before = faces_.size();
  std::vector<std::int32_t> number(mesh.triangles.size(), -1);
  for (std::size_t t = 0; t < number.size(); ++t)
    if (mesh.triangles[t].patch >= 0 && patch_of[mesh.triangles[t].patch] >= 0) {
      number[t] = static_cast<std::int32_t>(faces_.size());
      Face f;
      f.triangle = static_cast<std::int32_t>(t);
      faces_.push_back(f);
    }
  normals_.resize(faces_.size());
  balls_.resize(faces_.size());
  for_each_index(faces_.size() - before, threads, [&](std::size_t i) {
    const std::size_t n = before + i;
    Face& f = faces_[n];
    const MeshTriangle& t = mesh.triangles[f.triangle];
    f.patch = patch_of[t.patch];
    const Vec3 area = mesh.area_vector(t.v);
    const double size = norm(area);
    for (int k = 0; k < 3; ++k) {
      f.p[k] = mesh.points[t.v[k]];
      f.next[k] = -1;
      Vec3 sum;
      int beyond = 0;
      const std::vector<std::int32_t> side = on_this_side(mesh, t.v[k], f.triangle);
      for (std::int32_t o : mesh.star[t.v[k]]) {
        const MeshTriangle& other = mesh.triangles[o];
        if (other.patch != t.patch) continue;
        const Vec3 a = mesh.area_vector(other.v);
        if (dot(a, area) > 0.5 * size * norm(a) &&
            (side.empty() || std::find(side.begin(), side.end(), o) != side.end()))
          sum = sum + a;
        const std::int32_t w = t.v[(k + 1) % 3];
        if (o != f.triangle && (other.v[0] == w || other.v[1] == w || other.v[2] == w))
          f.next[k] = beyond++ == 0 ? number[o] : -1;
      }
      const double l = norm(sum), scale = l > 0 ? 1 / l : 0;
      normals_[n][k] = {static_cast<float>(scale * sum.x), static_cast<float>(scale * sum.y),
                        static_cast<float>(scale * sum.z)};
    }
    const Vec3 c = (1 / 3.0) * (f.p[0] + f.p[1] + f.p[2]);
    const double r = std::max({norm(f.p[0] - c), norm(f.p[1] - c), norm(f.p[2] - c)});
    balls_[n] = {static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z),
                 static_cast<float>(1.001 * r + 1e-6 * (std::abs(c.x) + std::abs(c.y) + std::abs(c.z))), f.patch};
  });
}

Reference::Reference(const ComplexMesh& mesh, double cell_mm, int threads, const ComplexMesh* faired)
    : cell_mm_(cell_mm), is_the_mesh_(faired == nullptr) {
  std::vector<std::int32_t> own(2 * mesh.pair_count());  // patches of the mesh that it stands for itself
  std::iota(own.begin(), own.end(), 0);
  std::unordered_set<std::uint64_t> known;
  if (faired != nullptr) {
    std::vector<std::int32_t> as_in_mesh(2 * faired->pair_count(), -1);
    for (std::size_t patch = 0; patch < as_in_mesh.size(); ++patch)
      for (std::size_t k = 0; k < mesh.pair_count(); ++k)
        if (mesh.labels_of(static_cast<std::int32_t>(2 * k)) == faired->labels_of(static_cast<std::int32_t>(patch))) {
          as_in_mesh[patch] = static_cast<std::int32_t>(2 * k);
          own[2 * k] = -1;
        }
    add_faces(*faired, as_in_mesh, threads);
    faired_faces_ = faces_.size();
    std::vector<std::int32_t> around;
    for (std::int32_t a = 0; a < static_cast<std::int32_t>(faired->points.size()); ++a)
      for (std::int32_t b : faired->curve[a]) {
        if (a > b) continue;
        faired->edge_triangles(a, b, around);
        if (around.size() < 3) continue;  // where the image ends
        segments_.push_back({faired->points[a], faired->points[b], curve_key(*faired, a, b, &as_in_mesh)});
        known.insert(segments_.back().key);
      }
  }
  add_faces(mesh, own, threads);
  for (std::int32_t a = 0; a < static_cast<std::int32_t>(mesh.points.size()); ++a)
    for (std::int32_t b : mesh.curve[a])
      if (a < b)
        if (const std::uint64_t key = curve_key(mesh, a, b); known.count(key) == 0)
          segments_.push_back({mesh.points[a], mesh.points[b], key});
  face_cells_.build(faces_.size(), cell_mm, threads, [&](std::size_t n) { return faces_[n].p; });
  segment_cells_.build(segments_.size(), cell_mm, threads, [&](std::size_t n) {
    return std::array<Vec3, 2>{segments_[n].a, segments_[n].b};
  });
}

/// From face to face as long as one beyond a side is no further; so all round a corner that is nearest.
void Reference::walk(const Vec3& p, std::int32_t hint, Candidate& best) const {
  constexpr int kMost = 96;
  std::array<std::int32_t, kMost> seen;
  std::array<double, kMost> squared;
  int count = 0;
  const auto test = [&](std::int32_t n) {
    const Face& f = faces_[n];
    const Vec3 q = nearest_on_triangle(p, f.p[0], f.p[1], f.p[2]), d = p - q;
    const double l = dot(d, d);
    seen[count] = n;
    squared[count++] = l;
    if (l < best.squared || (l == best.squared && n < best.face)) best = {l, n, q};
  };
  test(hint);
  for (int i = 0; i < count; ++i) {
    if (squared[i] > best.squared * (1 + 1e-12)) continue;
    for (std::int32_t n : faces_[seen[i]].next)
      if (n >= 0 && count < kMost && std::find(seen.begin(), seen.begin() + count, n) == seen.begin() + count) test(n);
  }
}

Reference::Foot Reference::foot_at(const Candidate& c) const {
  const Face& face = faces_[c.face];
  const double distance = std::sqrt(c.squared);
  const Vec3 n = cross(face.p[1] - face.p[0], face.p[2] - face.p[0]);
  const double size = dot(n, n);
  if (!(size > 0)) return Foot{c.point, {}, c.face, face.triangle, distance};
  Vec3 bulged, normal;
  for (int k = 0; k < 3; ++k) {
    const double w = dot(n, cross(face.p[(k + 1) % 3] - c.point, face.p[(k + 2) % 3] - c.point)) / size;
    const auto& m = normals_[c.face][k];
    const Vec3 at{m[0], m[1], m[2]};
    bulged = bulged + w * (c.point - dot(c.point - face.p[k], at) * at);
    normal = normal + w * at;
  }
  const double l = norm(normal);
  return Foot{c.point + 0.6 * (bulged - c.point), l > 0 ? (1 / l) * normal : (1 / std::sqrt(size)) * n, c.face,
              face.triangle, distance};
}

std::optional<Reference::Foot> Reference::nearest(const Vec3& p, std::int32_t patch, double reach_mm, std::int32_t hint,
                                                  double trust_mm) const {
  Candidate best;
  if (hint >= 0 && faces_[hint].patch == patch) {
    walk(p, hint, best);
    if (best.squared <= trust_mm * trust_mm) return foot_at(best);
  }
  double near = std::min(reach_mm, std::sqrt(best.squared));
  std::array<std::int32_t, 8> tested;  // a long triangle lies in many cells
  tested.fill(-1);
  unsigned turn = 0;
  for (double r = std::min(0.5 * cell_mm_, reach_mm);; r = std::min(2 * r, reach_mm)) {
    r = std::min(r, near);
    face_cells_.around(p, r, [&](std::int32_t n) {
      const Ball& b = balls_[n];
      if (b.patch != patch) return;
      const double dx = b.x - p.x, dy = b.y - p.y, dz = b.z - p.z, far = near + b.r;
      if (dx * dx + dy * dy + dz * dz > far * far) return;
      for (std::int32_t t : tested)
        if (t == n) return;
      tested[turn++ % tested.size()] = n;
      const Face& f = faces_[n];
      const Vec3 q = nearest_on_triangle(p, f.p[0], f.p[1], f.p[2]), d = p - q;
      const double l = dot(d, d);
      if (l > best.squared || (l == best.squared && n >= best.face)) return;
      best = {l, n, q};
      near = std::min(near, std::sqrt(l));
    });
    if (best.squared <= r * r * (1 + 1e-12)) break;
    if (r >= reach_mm) return std::nullopt;
  }
  return foot_at(best);
}

std::optional<Vec3> Reference::nearest_on_curve(const Vec3& p, std::uint64_t key, double reach_mm) const {
  double best = std::numeric_limits<double>::infinity();
  Vec3 foot;
  for (double r = std::min(0.5 * cell_mm_, reach_mm);; r = std::min(2 * r, reach_mm)) {
    segment_cells_.around(p, r, [&](std::int32_t n) {
      const Segment& s = segments_[n];
      if (s.key != key) return;
      const Vec3 q = nearest_on_segment(p, s.a, s.b), d = p - q;
      if (dot(d, d) < best) {
        best = dot(d, d);
        foot = q;
      }
    });
    if (best <= r * r) return foot;
    if (r >= reach_mm) return std::nullopt;
  }
}

}  // namespace stackmesh
