#include "fem/element_quality.h"

#include <algorithm>
#include <cmath>

#include "fem/tet_shape.h"

namespace stackmesh {

ElementQuality element_quality(const TetMesh& mesh) {
  std::vector<std::array<double, 4>> places;
  for (int k = 0; k < 4; ++k) {
    std::array<double, 4> corner{};
    corner[k] = 1;
    places.push_back(corner);
  }
  if (!mesh.mid.empty()) {
    for (const auto& e : kTetEdges) {
      std::array<double, 4> middle{};
      middle[e[0]] = middle[e[1]] = 0.5;
      places.push_back(middle);
    }
    constexpr double a = 0.58541019662496852, b = 0.1381966011250105;  // the four points of second-order integration
    for (int k = 0; k < 4; ++k) {
      std::array<double, 4> p = {b, b, b, b};
      p[k] = a;
      places.push_back(p);
    }
  }
  ElementQuality q;
  q.scaled_jacobian.reserve(mesh.tets.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    double least = tet_point(mesh, t, places[0]).determinant;
    for (std::size_t k = 1; k < places.size() && !mesh.mid.empty(); ++k) least = std::min(least, tet_point(mesh, t, places[k]).determinant);
    if (!(least > 0)) q.non_positive.push_back(static_cast<std::int32_t>(t));
    const auto& v = mesh.tets[t];
    double longest = 0;
    for (int k = 0; k < 4; ++k) {
      double product = 1;
      for (int m = 0; m < 4; ++m)
        if (m != k) product *= norm(mesh.points[v[m]] - mesh.points[v[k]]);
      longest = std::max(longest, product);
    }
    const Vec3 o = mesh.points[v[0]];
    const double volume6 = dot(cross(mesh.points[v[1]] - o, mesh.points[v[2]] - o), mesh.points[v[3]] - o);
    q.scaled_jacobian.push_back(longest > 0 ? std::sqrt(2.0) * volume6 / longest : 0);
  }
  return q;
}

}  // namespace stackmesh
