#include "enhance/separate.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace stackmesh {
namespace {

constexpr int kPasses = 4;
constexpr double kCornerAngle = 18;  // degrees: a triangle may become that narrow for it
constexpr double kAcross = 0.7;      // cosine: the way apart leads off at least one of the two sheets

/// Two triangles that are too near.
struct NearPair {
  std::int32_t i, j;
  bool operator<(const NearPair& o) const { return i != o.i ? i < o.i : j < o.j; }
  bool operator==(const NearPair& o) const { return i == o.i && j == o.j; }
};

class Separation {
 public:
  Separation(const ComplexMesh& mesh, const std::vector<float>& gaps, const std::vector<Vec3>& origin,
             double sheet_angle_deg)
      : mesh_(mesh), gaps_(gaps), origin_(origin), angle_(sheet_angle_deg * M_PI / 180), step_(mesh.points.size()) {}

  Corners3 corners(std::int32_t t) const {
    const auto& v = mesh_.triangles[t].v;
    return {mesh_.points[v[0]], mesh_.points[v[1]], mesh_.points[v[2]]};
  }
  double gap(const NearPair& p) const { return 0.5 * (gaps_[p.i] + gaps_[p.j]); }

  bool too_near(const NearPair& p) const {
    const Corners3 s = corners(p.i), t = corners(p.j);
    const SharedCorners h = shared_corners(mesh_.triangles[p.i].v, mesh_.triangles[p.j].v);
    if (h.count == 2) return sheet_cosine(s, t, h) > std::cos(angle_);
    if (h.count == 1) {
      bool near = false;
      each_off_corner(s, t, h, gap(p), [&](const NearestPoints&, double) { near = true; });
      return near;
    }
    if (h.count != 0 || certainly_apart(s, t, gap(p))) return false;
    const NearestPoints n = nearest_points(s, t);
    return n.squared < gap(p) * gap(p) && n.squared > 0 && leads_off(s, t, n.on_s - n.on_t);
  }

  /// Asks the corners of both for what the pair lacks; the longest request of a vertex counts.
  void part(const NearPair& p) {
    const Corners3 s = corners(p.i), t = corners(p.j);
    const SharedCorners h = shared_corners(mesh_.triangles[p.i].v, mesh_.triangles[p.j].v);
    if (h.count == 2) {
      open_edge(p.i, s, h.in_s, t, p.j, h.in_t);
      return;
    }
    const auto apart = [&](const NearestPoints& n, double gap_mm) {
      const double d = std::sqrt(n.squared);
      if (!(d > 0) || d >= gap_mm) return;
      const Vec3 move = (0.5 * (gap_mm - d) / d) * (n.on_s - n.on_t);
      push(p.i, s, n.on_s, move);
      push(p.j, t, n.on_t, -1.0 * move);
    };
    if (h.count == 1) each_off_corner(s, t, h, gap(p), apart);
    else apart(nearest_points(s, t), gap(p));
  }

  std::vector<Vec3> places() const {
    std::vector<Vec3> to = mesh_.points;
    for (std::size_t v = 0; v < to.size(); ++v) {
      if (!(dot(step_[v], step_[v]) > 0)) continue;
      Vec3 from_origin = to[v] + step_[v] - origin_[v];
      double most = 0;
      for (std::int32_t t : mesh_.star[v]) most = std::max<double>(most, gaps_[t]);
      const double l = norm(from_origin);
      if (l > most) from_origin = (most / l) * from_origin;
      to[v] = origin_[v] + from_origin;
    }
    return to;
  }

 private:
  /// Of triangles with a common corner: calls visit(points, gap) for each other corner that is nearer to the other
  /// triangle than the gap and the angle, seen from the common corner, allow.
  template <class Visit>
  void each_off_corner(const Corners3& s, const Corners3& t, const SharedCorners& h, double gap_mm, Visit visit) const {
    const Vec3& common = s[h.in_s[0]];
    const auto offer = [&](const Vec3& corner, NearestPoints n) {
      n.squared = dot(n.on_s - n.on_t, n.on_s - n.on_t);
      const double wanted = std::min(gap_mm, angle_ * norm(corner - common));
      if (n.squared < wanted * wanted && n.squared > 0 && leads_off(s, t, n.on_s - n.on_t)) visit(n, wanted);
    };
    for (int k = 1; k < 3; ++k) {
      const Vec3 &p = s[(h.in_s[0] + k) % 3], &q = t[(h.in_t[0] + k) % 3];
      offer(p, {p, nearest_on_triangle(p, t[0], t[1], t[2]), 0});
      offer(q, {nearest_on_triangle(q, s[0], s[1], s[2]), q, 0});
    }
  }

  static bool leads_off(const Corners3& s, const Corners3& t, const Vec3& way) {
    const Vec3 n = cross(s[1] - s[0], s[2] - s[0]), m = cross(t[1] - t[0], t[2] - t[0]);
    const double l = kAcross * norm(way);
    return std::abs(dot(way, n)) > l * norm(n) || std::abs(dot(way, m)) > l * norm(m);
  }

  void request(std::int32_t v, Vec3 step) {
    if (mesh_.pinned[v]) return;
    if (mesh_.flat[v]) step.z = 0;
    if (dot(step, step) > dot(step_[v], step_[v])) step_[v] = step;
  }

  /// Moves the corners so that the point of the triangle moves as asked.
  void push(std::int32_t t, const Corners3& c, const Vec3& at, const Vec3& move) {
    const Vec3 n = cross(c[1] - c[0], c[2] - c[0]);
    const double whole = dot(n, n);
    if (!(whole > 0)) return;
    double w[3], sum = 0;
    for (int k = 0; k < 3; ++k) {
      w[k] = std::clamp(dot(n, cross(c[(k + 1) % 3] - at, c[(k + 2) % 3] - at)) / whole, 0.0, 1.0);
      sum += w[k] * w[k];
    }
    for (int k = 0; k < 3; ++k) request(mesh_.triangles[t].v[k], (w[k] / sum) * move);
  }

  /// Turns two triangles about their edge, each by half of what the angle lacks.
  void open_edge(std::int32_t i, const Corners3& s, const std::array<int, 3>& in_s, const Corners3& t, std::int32_t j,
                 const std::array<int, 3>& in_t) {
    const int c = 3 - in_s[0] - in_s[1], d = 3 - in_t[0] - in_t[1];
    const Vec3 a = s[in_s[0]], along = s[in_s[1]] - a;
    const double l = dot(along, along);
    if (!(l > 0)) return;
    const auto off = [&](const Vec3& p) { return p - a - (dot(p - a, along) / l) * along; };
    const Vec3 x = off(s[c]), y = off(t[d]);
    const double lx = norm(x), ly = norm(y);
    if (!(lx > 0) || !(ly > 0)) return;
    const Vec3 u = (1 / lx) * x, w = (1 / ly) * y, apart = u - w;
    const double now = std::acos(std::clamp(dot(u, w), -1.0, 1.0)), size = norm(apart);
    if (now >= angle_ || !(size > 0)) return;
    const Vec3 way = (0.5 * (angle_ - now) / size) * apart;
    request(mesh_.triangles[i].v[c], lx * way);
    request(mesh_.triangles[j].v[d], -ly * way);
  }

  const ComplexMesh& mesh_;
  const std::vector<float>& gaps_;
  const std::vector<Vec3>& origin_;
  const double angle_;
  std::vector<Vec3> step_;
};

}  // namespace

SmoothingResult separate_sheets(ComplexMesh& mesh, const std::vector<double>& size, double gap_rel,
                                const MoveLimits& keep, int threads) {
  MoveLimits wide = keep;
  wide.size_mm = &size;
  wide.clearance_rel = gap_rel;
  const std::vector<float> gaps = clearances(mesh, wide);
  MoveLimits limits = keep;
  limits.corner_angle_deg = std::min(keep.corner_angle_deg, kCornerAngle);
  limits.turn_deg = 90;  // no speck is to be turned inside out
  const std::vector<Vec3> origin = mesh.points;
  double sum = 0;
  for (double s : size) sum += s;
  TriangleGrid grid;
  grid.build(mesh, mesh.points, 1.5 * sum / static_cast<double>(std::max<std::size_t>(1, size.size())), gaps);
  constexpr std::size_t kRun = 1024;
  std::vector<std::vector<NearPair>> found((grid.bucket_count() + kRun - 1) / kRun);
  {
    const Separation all(mesh, gaps, origin, keep.sheet_angle_deg);
    parallel_for(found.size(), threads, [&](std::size_t run) {
      std::vector<std::int32_t> buffer;
      grid.pairs(run * kRun, std::min(grid.bucket_count(), (run + 1) * kRun), buffer,
                 [&](std::int32_t i, std::int32_t j) {
                   if (all.too_near({i, j})) found[run].push_back({i, j});
                 });
    });
  }
  std::vector<NearPair> pairs;
  for (const auto& f : found) pairs.insert(pairs.end(), f.begin(), f.end());
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  SmoothingResult result;
  for (int pass = 0; pass < kPasses && !pairs.empty(); ++pass) {
    Separation apart(mesh, gaps, origin, keep.sheet_angle_deg);
    for (const NearPair& p : pairs) apart.part(p);
    const SmoothingResult r = move_guarded(mesh, apart.places(), limits, threads);
    result.moved = std::max(result.moved, r.moved);
    result.held_back = r.held_back;
    result.rounds += r.rounds;
  }
  return result;
}

}  // namespace stackmesh
