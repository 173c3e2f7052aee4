#pragma once
// Shape functions of wedges with 6 or 15 nodes, and of pyramids as wedges with two corners at one point.
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "model/tet_mesh.h"

namespace stackmesh {

/// A place in a wedge: u and v are the coordinates of corners 1 and 2 within the triangle, w runs from -1 (corners 0 1
/// 2) to 1.
struct WedgePlace {
  double u = 0;       ///< from 0
  double v = 0;       ///< from 0; u + v at most 1
  double w = 0;       ///< -1 to 1
  double weight = 0;  ///< in a rule of integration
};

/// The position, and its determinant (the volume is its integral over the place: half the mean times 2).
struct WedgePoint {
  Vec3 position;           ///< mm
  double determinant = 0;  ///< of its derivatives by the place, mm3; above 0 in a valid wedge
};

/// The nodes of a wedge: 6 corners, of second order and 9 mid-side nodes.
struct WedgeNodes {
  std::array<Vec3, 15> at;  ///< mm, corners first
  bool quadratic = false;   ///< the mid-side nodes count
};
inline WedgeNodes wedge_nodes(const TetMesh& mesh, std::size_t wedge) {
  WedgeNodes n;
  for (int k = 0; k < 6; ++k) n.at[k] = mesh.points[mesh.wedges[wedge][k]];
  n.quadratic = !mesh.wedge_mid.empty();
  for (int k = 0; k < 9 && n.quadratic; ++k) n.at[6 + k] = mesh.points[mesh.wedge_mid[wedge][k]];
  return n;
}

inline WedgePoint wedge_point(const WedgeNodes& node, const WedgePlace& p) {
  const double l[3] = {1 - p.u - p.v, p.u, p.v};
  static constexpr double du[3] = {-1, 1, 0}, dv[3] = {-1, 0, 1};
  Vec3 x, xu, xv, xw;
  const auto add = [&](int n, double value, double by_u, double by_v, double by_w) {
    x = x + value * node.at[n], xu = xu + by_u * node.at[n], xv = xv + by_v * node.at[n], xw = xw + by_w * node.at[n];
  };
  const double bubble = 1 - p.w * p.w;
  for (int k = 0; k < 3; ++k)
    for (const int top : {0, 1}) {
      const double s = top ? 1 : -1, z = 1 + s * p.w;
      if (!node.quadratic) {
        add(k + 3 * top, 0.5 * l[k] * z, 0.5 * du[k] * z, 0.5 * dv[k] * z, 0.5 * s * l[k]);
        continue;
      }
      const double by_l = 0.5 * (4 * l[k] - 1) * z - 0.5 * bubble, q = l[k] * (2 * l[k] - 1);
      add(k + 3 * top, 0.5 * q * z - 0.5 * l[k] * bubble, by_l * du[k], by_l * dv[k], 0.5 * s * q + l[k] * p.w);
      const int m = (k + 1) % 3;
      add(6 + k + 3 * top, 2 * l[k] * l[m] * z, 2 * z * (du[k] * l[m] + l[k] * du[m]),
          2 * z * (dv[k] * l[m] + l[k] * dv[m]), 2 * s * l[k] * l[m]);
    }
  for (int k = 0; k < 3 && node.quadratic; ++k)
    add(12 + k, l[k] * bubble, bubble * du[k], bubble * dv[k], -2 * p.w * l[k]);
  return {x, dot(xu, cross(xv, xw))};
}

/// n * n * n places whose weights sum to 1, the volume of the place's prism.
inline std::vector<WedgePlace> wedge_rule(const std::vector<std::pair<double, double>>& line) {
  std::vector<WedgePlace> out;
  for (const auto& [a, wa] : line)  // a rule on [0, 1]
    for (const auto& [b, wb] : line)
      for (const auto& [c, wc] : line) out.push_back({a, b * (1 - a), 2 * c - 1, 2 * wa * wb * wc * (1 - a)});
  return out;
}
/// Exact for the determinant of a wedge of 15 nodes.
inline const std::vector<WedgePlace>& wedge_volume_rule() {
  static const std::vector<WedgePlace> rule = wedge_rule({{0.0694318442029737, 0.1739274225687269},
                                                          {0.3300094782075719, 0.3260725774312731},
                                                          {0.6699905217924281, 0.3260725774312731},
                                                          {0.9305681557970263, 0.1739274225687269}});
  return rule;
}

inline double wedge_volume(const WedgeNodes& nodes) {
  double sum = 0;
  for (const WedgePlace& p : wedge_volume_rule()) sum += p.weight * wedge_point(nodes, p).determinant;
  return sum;
}

/// The places of nodes (but corner 2 of a pyramid, where the determinant vanishes) and of the integration points of 6
/// and 15 nodes.
inline std::vector<WedgePlace> wedge_check_places(bool pyramid) {
  static constexpr double corner[3][2] = {{0, 0}, {1, 0}, {0, 1}};
  std::vector<WedgePlace> out;
  for (const double w : {-1.0, 0.0, 1.0}) {
    for (int k = 0; k < (pyramid ? 2 : 3); ++k) out.push_back({corner[k][0], corner[k][1], w, 0});
    for (int k = 0; k < 3; ++k)
      out.push_back(
          {0.5 * (corner[k][0] + corner[(k + 1) % 3][0]), 0.5 * (corner[k][1] + corner[(k + 1) % 3][1]), w, 0});
  }
  for (const double w : {-0.7745966692414834, -0.5773502691896257, 0.0, 0.5773502691896257, 0.7745966692414834})
    for (const auto& [u, v] : {std::pair(1.0 / 6, 1.0 / 6), std::pair(2.0 / 3, 1.0 / 6), std::pair(1.0 / 6, 2.0 / 3),
                               std::pair(1.0 / 3, 1.0 / 3)})
      out.push_back({u, v, w, 0});
  return out;
}

}  // namespace stackmesh
