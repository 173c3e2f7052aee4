#pragma once
#include "model/geometry.h"

namespace stackmesh {

/// Sign of det(b - a, c - a, d - a), exact: positive when d lies on the side that the normal of (a, b, c)
/// points to.
int exact_orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Sign of twice the area of the plane triangle (a, b, c), exact: positive when counter-clockwise.
int exact_orientation_2d(double ax, double ay, double bx, double by, double cx, double cy);

/// True when a, b and c lie on one line (equal points do), exact.
bool exact_collinear(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace stackmesh
