#pragma once
#include <cstring>
#include <vector>

#include "model/complex.h"

namespace stackmesh::testing_support {

/// A box of side `side` from the origin, each face a grid of n x n squares; label 1.
InterfaceComplex cube(double side, int n);

/// A ball round the origin: an icosahedron subdivided `levels` times; label 1.
InterfaceComplex ball(double radius, int levels);

/// Two square plates of labels 1 and 2, `thickness` high, with a gap between them.
InterfaceComplex two_plates(double side, double thickness, double gap);

/// Angles between the normals of the triangles of each edge.
std::vector<double> bends_deg(const InterfaceComplex& c);

double interface_area(const InterfaceComplex& c, Label a, Label b);

inline bool same_bytes(const InterfaceComplex& a, const InterfaceComplex& b) {
  if (a.points.size() != b.points.size() || a.triangles.size() != b.triangles.size()) return false;
  for (std::size_t i = 0; i < a.triangles.size(); ++i)
    if (a.triangles[i].v != b.triangles[i].v || a.triangles[i].below != b.triangles[i].below ||
        a.triangles[i].above != b.triangles[i].above)
      return false;
  return std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof(Vec3)) == 0;
}

}  // namespace stackmesh::testing_support
