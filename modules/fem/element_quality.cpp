#include "fem/element_quality.h"

#include <algorithm>
#include <cmath>

#include "fem/tet_shape.h"
#include "model/wedge_shape.h"

namespace stackmesh {

namespace {

/// Smallest corner: the determinant over the product of the three edges there, 1 for the regular one.
void add_wedge(const TetMesh& mesh, std::size_t wedge, ElementQuality& q) {
  static constexpr int kCorner[6][4] = {{0, 1, 2, 3}, {1, 2, 0, 4}, {2, 0, 1, 5},
                                        {3, 5, 4, 0}, {4, 3, 5, 1}, {5, 4, 3, 2}};
  static const std::vector<WedgePlace> places[2] = {wedge_check_places(false), wedge_check_places(true)};
  const auto& v = mesh.wedges[wedge];
  const bool pyramid = is_pyramid(v);
  double scaled = 1e300, least = 1e300;
  for (const auto& c : kCorner) {
    if (pyramid && (c[0] == 2 || c[0] == 5)) continue;
    const Vec3 o = mesh.points[v[c[0]]], a = mesh.points[v[c[1]]] - o, b = mesh.points[v[c[2]]] - o,
               up = mesh.points[v[c[3]]] - o;
    const double product = norm(a) * norm(b) * norm(up);
    scaled = std::min(
        scaled, product > 0 ? (pyramid ? std::sqrt(2.0) : 2 / std::sqrt(3.0)) * dot(a, cross(b, up)) / product : 0);
  }
  const WedgeNodes nodes = wedge_nodes(mesh, wedge);
  for (const WedgePlace& p : places[pyramid]) least = std::min(least, wedge_point(nodes, p).determinant);
  if (!(least > 0) || !(scaled > 0)) q.non_positive.push_back(static_cast<std::int32_t>(mesh.tets.size() + wedge));
  q.scaled_jacobian.push_back(scaled);
}

}  // namespace

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
    for (std::size_t k = 1; k < places.size() && !mesh.mid.empty(); ++k)
      least = std::min(least, tet_point(mesh, t, places[k]).determinant);
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
  for (std::size_t w = 0; w < mesh.wedges.size(); ++w) add_wedge(mesh, w, q);
  return q;
}

}  // namespace stackmesh
