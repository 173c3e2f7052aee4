#pragma once
#include <algorithm>
#include <cmath>

#include "model/geometry.h"

namespace stackmesh::volume {

/// How much less an obtuse dihedral's sine counts: 160 degrees is as bad as 12.
constexpr double kObtuse = 0.6;

/// The smallest sine of a tet's six dihedral angles, obtuse ones times kObtuse (klingner2007's biased minimum sine);
/// -1 for a tet that is flat or inverted. 0.94 for a regular one.
inline double tet_quality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a, e = c - b, f = d - b, g = d - c;
  const Vec3 n1 = cross(w, v), n2 = cross(u, w), n3 = cross(v, u);  // outward, of the faces opposite b, c, d
  const double det = -dot(n1, u);
  if (!(det > 0)) return -1;
  const Vec3 n0 = {-n1.x - n2.x - n3.x, -n1.y - n2.y - n3.y, -n1.z - n2.z - n3.z};
  const double l0 = dot(n0, n0), l1 = dot(n1, n1), l2 = dot(n2, n2), l3 = dot(n3, n3);
  double least = 1e300;
  // the faces' normals, their areas' squares / edge^2
  const auto edge = [&](const Vec3& m, const Vec3& n, double square) {
    const double s = dot(m, n) > 0 ? kObtuse * kObtuse / square : 1 / square;
    least = std::min(least, s);
  };
  edge(n0, n1, l0 * l1 / dot(g, g));
  edge(n0, n2, l0 * l2 / dot(f, f));
  edge(n0, n3, l0 * l3 / dot(e, e));
  edge(n1, n2, l1 * l2 / dot(w, w));
  edge(n1, n3, l1 * l3 / dot(v, v));
  edge(n2, n3, l2 * l3 / dot(u, u));
  return det * std::sqrt(least);
}

}  // namespace stackmesh::volume
