#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "model/geometry.h"

namespace stackmesh {

inline double angle_deg(const Vec3& u, const Vec3& v) {
  return 57.295779513082320877 * std::atan2(norm(cross(u, v)), dot(u, v));
}

/// The angles of a triangle at a, b, c, degrees.
inline std::array<double, 3> triangle_angles_deg(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {angle_deg(b - a, c - a), angle_deg(c - b, a - b), angle_deg(a - c, b - c)};
}

/// The cosines of the six dihedral angles of a tet; all 1 when a face has no area.
inline std::array<double, 6> dihedral_cosines(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a, e = c - b, f = d - b;
  Vec3 n[4] = {cross(e, f), cross(w, v), cross(u, w), cross(v, u)};
  for (Vec3& m : n) {
    const double length = norm(m);
    if (length == 0) return {1, 1, 1, 1, 1, 1};
    m = (1 / length) * m;
  }
  return {-dot(n[0], n[1]), -dot(n[0], n[2]), -dot(n[0], n[3]), -dot(n[1], n[2]), -dot(n[1], n[3]), -dot(n[2], n[3])};
}

}  // namespace stackmesh
