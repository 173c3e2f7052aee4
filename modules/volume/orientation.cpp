#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <cmath>

#include "volume/label_tets.h"

namespace stackmesh::volume {

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 p = b - a, q = c - a, r = d - a;
  const double det = dot(cross(p, q), r);
  const double permanent = (std::abs(p.y * q.z) + std::abs(p.z * q.y)) * std::abs(r.x) +
                           (std::abs(p.z * q.x) + std::abs(p.x * q.z)) * std::abs(r.y) +
                           (std::abs(p.x * q.y) + std::abs(p.y * q.x)) * std::abs(r.z);
  const double bound = 1e-15 * permanent + 1e-300;  // Shewchuk's is 7.8e-16
  if (det > bound) return 1;
  if (det < -bound) return -1;
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  const auto cgal = [](const Vec3& v) { return Kernel::Point_3(v.x, v.y, v.z); };
  return static_cast<int>(CGAL::orientation(cgal(a), cgal(b), cgal(c), cgal(d)));
}

}  // namespace stackmesh::volume
