#include "validate/triangle_contact.h"

#include <algorithm>
#include <utility>

#include "validate/exact.h"

namespace stackmesh {
namespace {

struct Corners {
  Vec3 a, b, c;
};

double max_abs(const Vec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

// ---- In a plane: the coordinate is dropped in which the triangle keeps an area.

struct Flat {
  double x, y;
};

Flat drop(const Vec3& p, int axis) {
  return axis == 0 ? Flat{p.y, p.z} : axis == 1 ? Flat{p.z, p.x} : Flat{p.x, p.y};
}
int turn(Flat a, Flat b, Flat c) {
  return exact_orientation_2d(a.x, a.y, b.x, b.y, c.x, c.y);
}

int drop_axis(const Corners& t) {
  const Vec3 n = cross(t.b - t.a, t.c - t.a);
  const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  const int best = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
  for (int k = 0; k < 3; ++k) {
    const int axis = (best + k) % 3;
    if (turn(drop(t.a, axis), drop(t.b, axis), drop(t.c, axis)) != 0) return axis;
  }
  return best;
}

bool on_box(Flat p, Flat a, Flat b) {
  return p.x >= std::min(a.x, b.x) && p.x <= std::max(a.x, b.x) && p.y >= std::min(a.y, b.y) &&
         p.y <= std::max(a.y, b.y);
}

bool segments_meet(Flat p, Flat q, Flat a, Flat b) {
  const int pa = turn(a, b, p), qa = turn(a, b, q), ap = turn(p, q, a), bp = turn(p, q, b);
  if (pa * qa < 0 && ap * bp < 0) return true;
  return (pa == 0 && on_box(p, a, b)) || (qa == 0 && on_box(q, a, b)) || (ap == 0 && on_box(a, p, q)) ||
         (bp == 0 && on_box(b, p, q));
}

bool inside(Flat p, Flat a, Flat b, Flat c) {
  const int x = turn(a, b, p), y = turn(b, c, p), z = turn(c, a, p);
  return (x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0);
}

bool coplanar_segment_meets(const Vec3& p3, const Vec3& q3, const Corners& t) {
  const int axis = drop_axis(t);
  const Flat p = drop(p3, axis), q = drop(q3, axis), a = drop(t.a, axis), b = drop(t.b, axis), c = drop(t.c, axis);
  return inside(p, a, b, c) || inside(q, a, b, c) || segments_meet(p, q, a, b) || segments_meet(p, q, b, c) ||
         segments_meet(p, q, c, a);
}

// ---- In space.

int side(const Corners& t, const Vec3& p) {
  return exact_orientation(t.a, t.b, t.c, p);
}

/// `sp`, `sq`: the sides of the plane of t on which p and q lie.
bool segment_meets(const Vec3& p, const Vec3& q, int sp, int sq, const Corners& t) {
  if (sp * sq > 0) return false;
  if (sp == 0 && sq == 0) return coplanar_segment_meets(p, q, t);
  const int x = exact_orientation(p, q, t.a, t.b), y = exact_orientation(p, q, t.b, t.c);
  if (x * y < 0) return false;
  const int z = exact_orientation(p, q, t.c, t.a);
  return (x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0);
}

/// True only when the plane with normal u certainly keeps the triangles apart; `s`, `t` relative to a common
/// point, `extent` the largest coordinate among them.
bool separated(const Vec3& u, const Vec3 (&s)[3], const Vec3 (&t)[3], double extent) {
  const double margin = 1e-14 * (std::abs(u.x) + std::abs(u.y) + std::abs(u.z)) * extent;
  const double s0 = dot(u, s[0]), s1 = dot(u, s[1]), s2 = dot(u, s[2]);
  const double t0 = dot(u, t[0]), t1 = dot(u, t[1]), t2 = dot(u, t[2]);
  return std::max({s0, s1, s2}) + margin < std::min({t0, t1, t2}) ||
         std::max({t0, t1, t2}) + margin < std::min({s0, s1, s2});
}

bool quickly_separated(const Corners& one, const Corners& two) {
  const Vec3 s[3] = {{0, 0, 0}, one.b - one.a, one.c - one.a};
  const Vec3 t[3] = {two.a - one.a, two.b - one.a, two.c - one.a};
  const double extent = std::max({max_abs(s[1]), max_abs(s[2]), max_abs(t[0]), max_abs(t[1]), max_abs(t[2])});
  const Vec3 n = cross(s[1], s[2]);
  if (separated(n, s, t, extent)) return true;
  const Vec3 m = cross(t[1] - t[0], t[2] - t[0]);
  if (separated(m, s, t, extent)) return true;
  for (int i = 0; i < 3; ++i) {
    if (separated(cross(n, s[(i + 1) % 3] - s[i]), s, t, extent)) return true;
    if (separated(cross(m, t[(i + 1) % 3] - t[i]), s, t, extent)) return true;
  }
  return false;
}

bool apart_collide(const Corners& s, const Corners& t) {
  if (quickly_separated(s, t)) return false;
  const int ta = side(s, t.a), tb = side(s, t.b), tc = side(s, t.c);
  if ((ta > 0 && tb > 0 && tc > 0) || (ta < 0 && tb < 0 && tc < 0)) return false;
  const int sa = side(t, s.a), sb = side(t, s.b), sc = side(t, s.c);
  if ((sa > 0 && sb > 0 && sc > 0) || (sa < 0 && sb < 0 && sc < 0)) return false;
  return segment_meets(t.a, t.b, ta, tb, s) || segment_meets(t.b, t.c, tb, tc, s) ||
         segment_meets(t.c, t.a, tc, ta, s) || segment_meets(s.a, s.b, sa, sb, t) ||
         segment_meets(s.b, s.c, sb, sc, t) || segment_meets(s.c, s.a, sc, sa, t);
}

/// The triangles share their corner a. What they have in common is convex and holds a, so it is more than a
/// exactly when the far edge of one meets the other.
bool corner_collide(const Corners& s, const Corners& t) {
  const Vec3 b = s.b - s.a, c = s.c - s.a, d = t.b - s.a, e = t.c - s.a;
  const double lb = norm(b), lc = norm(c), ld = norm(d), le = norm(e);
  if (lb > 0 && lc > 0 && ld > 0 && le > 0) {
    // A plane through a that leaves one triangle on either side, found from the bisectors.
    Vec3 m = (1 / lb) * b + (1 / lc) * c, n = (1 / ld) * d + (1 / le) * e;
    const double lm = norm(m), ln = norm(n);
    if (lm > 0 && ln > 0) {
      const Vec3 u = (1 / lm) * m - (1 / ln) * n;
      const double eps = 1e-14 * (std::abs(u.x) + std::abs(u.y) + std::abs(u.z));
      if (dot(u, b) > eps * lb && dot(u, c) > eps * lc && dot(u, d) < -eps * ld && dot(u, e) < -eps * le) return false;
    }
  }
  const int sd = side(s, t.b), se = side(s, t.c);
  if (sd * se > 0) return false;
  const int sb = side(t, s.b), sc = side(t, s.c);
  if (sb * sc > 0) return false;
  return segment_meets(t.b, t.c, sd, se, s) || segment_meets(s.b, s.c, sb, sc, t);
}

/// The triangles share the edge a b and no more: they overlap when coplanar and on one side of it.
bool edge_collide(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 e = b - a, f = c - a, g = d - a;
  const double le = max_abs(e);
  if (dot(cross(e, f), cross(e, g)) < -1e-13 * le * le * max_abs(f) * max_abs(g)) return false;
  if (exact_orientation(a, b, c, d) != 0) return false;
  const int axis = drop_axis({a, b, c});
  return turn(drop(a, axis), drop(b, axis), drop(c, axis)) == turn(drop(a, axis), drop(b, axis), drop(d, axis));
}

}  // namespace

bool triangles_collide(const std::vector<Vec3>& points, const std::array<std::int32_t, 3>& s,
                       const std::array<std::int32_t, 3>& t) {
  int shared = 0, in_s[3] = {0, 0, 0}, in_t[3] = {0, 0, 0};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (s[i] == t[j]) {
        in_s[shared] = i;
        in_t[shared++] = j;
        break;
      }
  const auto corners = [&](const std::array<std::int32_t, 3>& v, int first) {
    return Corners{points[v[first]], points[v[(first + 1) % 3]], points[v[(first + 2) % 3]]};
  };
  switch (shared) {
    case 0:
      return apart_collide(corners(s, 0), corners(t, 0));
    case 1:
      return corner_collide(corners(s, in_s[0]), corners(t, in_t[0]));
    case 2:
      return edge_collide(points[s[in_s[0]]], points[s[in_s[1]]], points[s[3 - in_s[0] - in_s[1]]],
                          points[t[3 - in_t[0] - in_t[1]]]);
    default:
      return true;
  }
}

}  // namespace stackmesh
