#pragma once
#include <algorithm>
#include <cmath>

#include "model/geometry.h"

namespace stackmesh::volume {

/// How much less an obtuse dihedral's sine counts: 160 degrees is as bad as 12.
constexpr double kObtuse = 0.6;

/// The smallest sine of a tet's six dihedral angles, obtuse ones times kObtuse (klingner2007's biased minimum sine);
/// -1 for a tet that is flat or inverted. 0.94 for a regular one.
/// @param gradient if not null: where the quality is above 0, its change as a moves; else 0
inline double tet_quality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, Vec3* gradient = nullptr) {
  if (gradient != nullptr) *gradient = {};
  const Vec3 u = b - a, v = c - a, w = d - a, e = c - b, f = d - b, g = d - c;
  const Vec3 n1 = cross(w, v), n2 = cross(u, w), n3 = cross(v, u);  // outward, of the faces opposite b, c, d
  const double det = -dot(n1, u);
  if (!(det > 0)) return -1;
  const Vec3 n0 = {-n1.x - n2.x - n3.x, -n1.y - n2.y - n3.y, -n1.z - n2.z - n3.z};
  // A sine is det * edge / (2 * area * 2 * area) of the faces on both sides: its square over det's, for six edges.
  const double r0 = 1 / dot(n0, n0), r1 = 1 / dot(n1, n1), r2 = 1 / dot(n2, n2), r3 = 1 / dot(n3, n3);
  double least = 1e300;
  int narrowest = 0;
  const auto edge = [&](int number, const Vec3& m, const Vec3& n, double square) {
    const double s = dot(m, n) > 0 ? kObtuse * kObtuse * square : square;
    if (s < least) least = s, narrowest = number;
  };
  edge(0, n0, n1, dot(g, g) * (r0 * r1));
  edge(1, n0, n2, dot(f, f) * (r0 * r2));
  edge(2, n0, n3, dot(e, e) * (r0 * r3));
  edge(3, n1, n2, dot(w, w) * (r1 * r2));
  edge(4, n1, n3, dot(v, v) * (r1 * r3));
  edge(5, n2, n3, dot(u, u) * (r2 * r3));
  const double quality = det * std::sqrt(least);
  if (gradient == nullptr) return quality;
  // Of the logarithm: a moves the volume along n0, the areas of the faces that hold it, and the edge that does.
  Vec3 sum = (-1 / det) * n0;
  const auto face = [&](const Vec3& opposite, const Vec3& n, double r) { sum = sum - r * cross(opposite, n); };
  const auto own_edge = [&](const Vec3& x) { sum = sum - (1 / dot(x, x)) * x; };
  if (narrowest == 0 || narrowest == 3 || narrowest == 4) face(g, n1, r1);
  if (narrowest == 1 || narrowest == 3 || narrowest == 5) face(-1.0 * f, n2, r2);
  if (narrowest == 2 || narrowest == 4 || narrowest == 5) face(e, n3, r3);
  if (narrowest == 3) own_edge(w);
  if (narrowest == 4) own_edge(v);
  if (narrowest == 5) own_edge(u);
  *gradient = quality * sum;
  return quality;
}

}  // namespace stackmesh::volume
