#include "model/triangle_contact.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cmath>

namespace stackmesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

int sign(double x) {
  return x > 0 ? 1 : x < 0 ? -1 : 0;
}

int orient(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  // Differences of equal numbers are exactly 0: the four lie in a plane across an axis.
  if ((u.x == 0 && v.x == 0 && w.x == 0) || (u.y == 0 && v.y == 0 && w.y == 0) || (u.z == 0 && v.z == 0 && w.z == 0))
    return 0;
  const Vec3 n = cross(u, v);
  const double det = dot(n, w);
  const double size = (std::abs(u.y * v.z) + std::abs(u.z * v.y)) * std::abs(w.x) +
                      (std::abs(u.z * v.x) + std::abs(u.x * v.z)) * std::abs(w.y) +
                      (std::abs(u.x * v.y) + std::abs(u.y * v.x)) * std::abs(w.z);
  if (size > 1e-200 && std::abs(det) > 2e-15 * size) return sign(det);
  using P = Kernel::Point_3;
  return static_cast<int>(CGAL::orientation(P(a.x, a.y, a.z), P(b.x, b.y, b.z), P(c.x, c.y, c.z), P(d.x, d.y, d.z)));
}

struct Flat2 {
  double x, y;
};

int turn(const Flat2& a, const Flat2& b, const Flat2& c) {
  const double l = (b.x - a.x) * (c.y - a.y), r = (b.y - a.y) * (c.x - a.x), size = std::abs(l) + std::abs(r);
  if (size > 1e-200 && std::abs(l - r) > 2e-15 * size) return sign(l - r);
  using P = Kernel::Point_2;
  return static_cast<int>(CGAL::orientation(P(a.x, a.y), P(b.x, b.y), P(c.x, c.y)));
}

/// The axis along which a plane triangle is looked at: one that does not make it a line.
int view_axis(const Corners3& t) {
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

Flat2 look(const Vec3& p, int axis) {
  return axis == 0 ? Flat2{p.y, p.z} : axis == 1 ? Flat2{p.z, p.x} : Flat2{p.x, p.y};
}

bool on_line_between(const Flat2& p, const Flat2& a, const Flat2& b) {
  return std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
         p.y <= std::max(a.y, b.y);
}

bool flat_segments_meet(const Flat2& p, const Flat2& q, const Flat2& a, const Flat2& b) {
  const int s1 = turn(p, q, a), s2 = turn(p, q, b), s3 = turn(a, b, p), s4 = turn(a, b, q);
  if (s1 * s2 < 0 && s3 * s4 < 0) return true;
  return (s1 == 0 && on_line_between(a, p, q)) || (s2 == 0 && on_line_between(b, p, q)) ||
         (s3 == 0 && on_line_between(p, a, b)) || (s4 == 0 && on_line_between(q, a, b));
}

bool flat_inside(const Flat2& p, const Flat2& a, const Flat2& b, const Flat2& c) {
  const int x = turn(a, b, p), y = turn(b, c, p), z = turn(c, a, p);
  return (x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0);
}

bool segment_meets(const Vec3& p, const Vec3& q, int side_p, int side_q, const Corners3& t) {
  if (side_p * side_q > 0) return false;
  if (side_p == 0 && side_q == 0) {
    const int axis = view_axis(t);
    const Flat2 a = look(t[0], axis), b = look(t[1], axis), c = look(t[2], axis), u = look(p, axis), v = look(q, axis);
    return flat_inside(u, a, b, c) || flat_inside(v, a, b, c) || flat_segments_meet(u, v, a, b) ||
           flat_segments_meet(u, v, b, c) || flat_segments_meet(u, v, c, a);
  }
  const int x = orient(p, q, t[0], t[1]), y = orient(p, q, t[1], t[2]);
  if (x * y < 0) return false;
  const int z = orient(p, q, t[2], t[0]);
  return (x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0);
}

bool separates(const Vec3& u, const Corners3& s, const Corners3& t, double gap) {
  const double squared = dot(u, u);
  if (!(squared > 0)) return false;
  const double s0 = dot(u, s[0] - s[0]), s1 = dot(u, s[1] - s[0]), s2 = dot(u, s[2] - s[0]);
  const double t0 = dot(u, t[0] - s[0]), t1 = dot(u, t[1] - s[0]), t2 = dot(u, t[2] - s[0]);
  const double between =
      std::max(std::min({t0, t1, t2}) - std::max({s0, s1, s2}), std::min({s0, s1, s2}) - std::max({t0, t1, t2}));
  return between > 0 && between * between >= gap * gap * squared;
}

bool apart_meet(const Corners3& s, const Corners3& t) {
  int on_s[3], on_t[3];
  for (int k = 0; k < 3; ++k) on_s[k] = orient(s[0], s[1], s[2], t[k]);
  if (on_s[0] == on_s[1] && on_s[1] == on_s[2] && on_s[0] != 0) return false;
  for (int k = 0; k < 3; ++k) on_t[k] = orient(t[0], t[1], t[2], s[k]);
  if (on_t[0] == on_t[1] && on_t[1] == on_t[2] && on_t[0] != 0) return false;
  for (int k = 0; k < 3; ++k) {
    const int n = (k + 1) % 3;
    if (segment_meets(t[k], t[n], on_s[k], on_s[n], s) || segment_meets(s[k], s[n], on_t[k], on_t[n], t)) return true;
  }
  return false;
}

/// True when a plane through the shared corner, square to the difference of their middle directions, keeps both
/// strictly on its sides.
bool fan_apart(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) {
  const Vec3 p = b - a, q = c - a, r = d - a, s = e - a;
  const auto length = [](const Vec3& x) { return std::abs(x.x) + std::abs(x.y) + std::abs(x.z); };
  const double lp = length(p), lq = length(q), lr = length(r), ls = length(s);
  if (!(lp > 0 && lq > 0 && lr > 0 && ls > 0)) return false;
  const Vec3 u = (1 / lp) * p + (1 / lq) * q - ((1 / lr) * r + (1 / ls) * s);
  const double small = 1e-9 * length(u);
  return dot(u, p) > small * lp && dot(u, q) > small * lq && dot(u, r) < -small * lr && dot(u, s) < -small * ls;
}

/// What the two have in common is convex and holds the corner: it is more exactly when a far edge meets the
/// other.
bool corner_meet(const Corners3& s, int i, const Corners3& t, int j) {
  const Vec3 &sb = s[(i + 1) % 3], &sc = s[(i + 2) % 3], &tb = t[(j + 1) % 3], &tc = t[(j + 2) % 3];
  if (fan_apart(s[i], sb, sc, tb, tc)) return false;
  const int b = orient(s[0], s[1], s[2], tb), c = orient(s[0], s[1], s[2], tc);
  if (b * c > 0) return false;
  const int d = orient(t[0], t[1], t[2], sb), e = orient(t[0], t[1], t[2], sc);
  if (d * e > 0) return false;
  return segment_meets(tb, tc, b, c, s) || segment_meets(sb, sc, d, e, t);
}

bool edge_meet(const Corners3& s, const Corners3& t, const SharedCorners& h) {
  const Vec3 &a = s[h.in_s[0]], &b = s[h.in_s[1]], &c = s[3 - h.in_s[0] - h.in_s[1]], &d = t[3 - h.in_t[0] - h.in_t[1]];
  if (orient(a, b, c, d) != 0) return false;
  const int axis = view_axis(s);
  const Flat2 p = look(a, axis), q = look(b, axis);
  return turn(p, q, look(c, axis)) * turn(p, q, look(d, axis)) >= 0;
}

NearestPoints nearest_on_segments(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  const Vec3 d1 = q - p, d2 = s - r, w = p - r;
  const double a = dot(d1, d1), e = dot(d2, d2), f = dot(d2, w), c = dot(d1, w), b = dot(d1, d2);
  const double den = a * e - b * b;
  double u = den > 0 ? std::clamp((b * f - c * e) / den, 0.0, 1.0) : 0;
  double v = e > 0 ? (b * u + f) / e : 0;
  if (v < 0) {
    v = 0;
    u = a > 0 ? std::clamp(-c / a, 0.0, 1.0) : 0;
  } else if (v > 1) {
    v = 1;
    u = a > 0 ? std::clamp((b - c) / a, 0.0, 1.0) : 0;
  }
  const Vec3 x = p + u * d1, y = r + v * d2;
  return {x, y, dot(x - y, x - y)};
}

}  // namespace

SharedCorners shared_corners(const std::array<std::int32_t, 3>& s, const std::array<std::int32_t, 3>& t) {
  SharedCorners h;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (s[i] == t[j]) {
        h.in_s[h.count] = i;
        h.in_t[h.count++] = j;
      }
  return h;
}

bool certainly_apart(const Corners3& s, const Corners3& t, double gap) {
  if (separates(s[0] + s[1] + s[2] - (t[0] + t[1] + t[2]), s, t, gap)) return true;
  const Vec3 es[3] = {s[1] - s[0], s[2] - s[1], s[0] - s[2]}, et[3] = {t[1] - t[0], t[2] - t[1], t[0] - t[2]};
  const Vec3 n = cross(es[0], es[1]), m = cross(et[0], et[1]);
  if (separates(n, s, t, gap) || separates(m, s, t, gap)) return true;
  for (int i = 0; i < 3; ++i)
    if (separates(cross(n, es[i]), s, t, gap) || separates(cross(m, et[i]), s, t, gap)) return true;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (separates(cross(es[i], et[j]), s, t, gap)) return true;
  return false;
}

bool triangles_meet(const Corners3& s, const Corners3& t, const SharedCorners& shared) {
  switch (shared.count) {
    case 0:
      return apart_meet(s, t);
    case 1:
      return corner_meet(s, shared.in_s[0], t, shared.in_t[0]);
    case 2:
      return edge_meet(s, t, shared);
    default:
      return true;
  }
}

double smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, bc = c - b, ca = a - c;
  const double l0 = dot(ab, ab), l1 = dot(bc, bc), l2 = dot(ca, ca);
  const double twice = norm(cross(ab, ca));
  double d;  // the smallest angle lies opposite the shortest side
  if (l0 <= l1 && l0 <= l2) d = -dot(bc, ca);
  else if (l1 <= l2) d = -dot(ca, ab);
  else d = -dot(ab, bc);
  return std::atan2(twice, d);
}

Vec3 nearest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  const double l = dot(d, d);
  return l > 0 ? a + std::clamp(dot(p - a, d) / l, 0.0, 1.0) * d : a;
}

Vec3 nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3 bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + (d1 / (d1 - d3)) * ab;
  const Vec3 cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + (d2 / (d2 - d6)) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b);
  const double sum = va + vb + vc;
  return a + (vb / sum) * ab + (vc / sum) * ac;
}

NearestPoints nearest_points(const Corners3& s, const Corners3& t) {
  NearestPoints best;
  const auto offer = [&](const NearestPoints& n) {
    if (n.squared < best.squared) best = n;
  };
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) offer(nearest_on_segments(s[i], s[(i + 1) % 3], t[j], t[(j + 1) % 3]));
    const Vec3 q = nearest_on_triangle(s[i], t[0], t[1], t[2]), p = nearest_on_triangle(t[i], s[0], s[1], s[2]);
    offer({s[i], q, dot(s[i] - q, s[i] - q)});
    offer({p, t[i], dot(p - t[i], p - t[i])});
  }
  return best;
}

double sheet_cosine(const Corners3& s, const Corners3& t, const SharedCorners& h) {
  const Vec3 &a = s[h.in_s[0]], &b = s[h.in_s[1]], &c = s[3 - h.in_s[0] - h.in_s[1]], &d = t[3 - h.in_t[0] - h.in_t[1]];
  const Vec3 m = cross(b - a, c - a), n = cross(b - a, d - a);
  const double size = std::sqrt(dot(m, m) * dot(n, n));
  return size > 0 ? dot(m, n) / size : 1;
}

}  // namespace stackmesh
