#include "validate/exact.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

namespace stackmesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_3 cgal(const Vec3& p) {
  return {p.x, p.y, p.z};
}

/// Below this a product may have underflowed, and a relative error bound says nothing.
constexpr double kTiny = 1e-250;

}  // namespace

int exact_orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  if ((u.x == 0 && v.x == 0 && w.x == 0) || (u.y == 0 && v.y == 0 && w.y == 0) || (u.z == 0 && v.z == 0 && w.z == 0))
    return 0;  // a common axis-parallel plane: by far the most frequent zero
  const double vw_yz = v.y * w.z, vw_zy = v.z * w.y, vw_zx = v.z * w.x, vw_xz = v.x * w.z, vw_xy = v.x * w.y,
               vw_yx = v.y * w.x;
  const double det = u.x * (vw_yz - vw_zy) + u.y * (vw_zx - vw_xz) + u.z * (vw_xy - vw_yx);
  const double size = std::abs(u.x) * (std::abs(vw_yz) + std::abs(vw_zy)) +
                      std::abs(u.y) * (std::abs(vw_zx) + std::abs(vw_xz)) +
                      std::abs(u.z) * (std::abs(vw_xy) + std::abs(vw_yx));
  if (size > kTiny && size < 1e300 && std::abs(det) > 1e-15 * size) return det > 0 ? 1 : -1;
  return static_cast<int>(CGAL::orientation(cgal(a), cgal(b), cgal(c), cgal(d)));
}

int exact_orientation_2d(double ax, double ay, double bx, double by, double cx, double cy) {
  const double left = (bx - ax) * (cy - ay), right = (by - ay) * (cx - ax), size = std::abs(left) + std::abs(right);
  const double det = left - right;
  if (size > kTiny && size < 1e300 && std::abs(det) > 1e-15 * size) return det > 0 ? 1 : -1;
  return static_cast<int>(CGAL::orientation(Kernel::Point_2(ax, ay), Kernel::Point_2(bx, by), Kernel::Point_2(cx, cy)));
}

bool exact_collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
  return exact_orientation_2d(a.x, a.y, b.x, b.y, c.x, c.y) == 0 &&
         exact_orientation_2d(a.y, a.z, b.y, b.z, c.y, c.z) == 0 &&
         exact_orientation_2d(a.z, a.x, b.z, b.x, c.z, c.x) == 0;
}

}  // namespace stackmesh
