#include "validate/check_wedges.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "validate/exact.h"

namespace stackmesh {
namespace {

/// A place in a wedge: u and v are the coordinates of corners 1 and 2 in the triangle, w runs from -1 (corners 0 1 2)
/// to 1.
struct Place {
  double u, v, w, weight;
};

/// Derivatives of the position by u, v, w, from the shape functions of 6 or 15 nodes (CalculiX's C3D6 and C3D15).
std::array<Vec3, 3> derivatives(const std::vector<Vec3>& node, const Place& p) {
  const double l[3] = {1 - p.u - p.v, p.u, p.v};
  static constexpr double du[3] = {-1, 1, 0}, dv[3] = {-1, 0, 1};
  std::array<Vec3, 3> d = {};
  const auto add = [&](int n, double by_u, double by_v, double by_w) {
    d[0] = d[0] + by_u * node[n];
    d[1] = d[1] + by_v * node[n];
    d[2] = d[2] + by_w * node[n];
  };
  const bool quadratic = node.size() == 15;
  for (int k = 0; k < 3; ++k)
    for (const int top : {0, 1}) {
      const double s = top ? 1 : -1, z = 1 + s * p.w;
      if (!quadratic) {
        add(k + 3 * top, 0.5 * du[k] * z, 0.5 * dv[k] * z, 0.5 * s * l[k]);
        continue;
      }
      // N = l (2 l - 1) z / 2 - l (1 - w^2) / 2
      const double by_l = 0.5 * (4 * l[k] - 1) * z - 0.5 * (1 - p.w * p.w);
      add(k + 3 * top, by_l * du[k], by_l * dv[k], 0.5 * s * l[k] * (2 * l[k] - 1) + l[k] * p.w);
    }
  if (!quadratic) return d;
  for (int k = 0; k < 3; ++k) {
    const int m = (k + 1) % 3;
    for (const int top : {0, 1}) {  // N = 2 l m z
      const double s = top ? 1 : -1, z = 1 + s * p.w;
      add(6 + k + 3 * top, 2 * z * (du[k] * l[m] + l[k] * du[m]), 2 * z * (dv[k] * l[m] + l[k] * dv[m]),
          2 * s * l[k] * l[m]);
    }
    const double bubble = 1 - p.w * p.w;  // N = l (1 - w^2)
    add(12 + k, bubble * du[k], bubble * dv[k], -2 * p.w * l[k]);
  }
  return d;
}

double determinant(const std::vector<Vec3>& node, const Place& p) {
  const auto d = derivatives(node, p);
  return dot(d[0], cross(d[1], d[2]));
}

/// A product rule that is exact for the determinant of 15 nodes.
const std::vector<Place>& volume_rule() {
  static const std::vector<Place> rule = [] {
    const double x[4] = {0.8611363115940526, 0.3399810435848563, -0.3399810435848563, -0.8611363115940526};
    const double weight[4] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461, 0.3478548451374538};
    std::vector<Place> out;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        for (int k = 0; k < 4; ++k) {
          const double u = 0.5 * (1 + x[i]), v = 0.5 * (1 + x[j]) * (1 - u);
          out.push_back({u, v, x[k], 0.25 * weight[i] * weight[j] * (1 - u) * weight[k]});
        }
    return out;
  }();
  return rule;
}

/// Where solvers integrate: two points of a C3D6, nine of a C3D15.
const std::vector<Place>& integration_points(bool quadratic) {
  static const std::vector<Place> rules[2] = {
      {{1.0 / 3, 1.0 / 3, -0.5773502691896257, 0}, {1.0 / 3, 1.0 / 3, 0.5773502691896257, 0}}, [] {
        std::vector<Place> out;
        for (const double w : {-0.7745966692414834, 0.0, 0.7745966692414834})
          for (const auto& [u, v] :
               {std::pair(1.0 / 6, 1.0 / 6), std::pair(2.0 / 3, 1.0 / 6), std::pair(1.0 / 6, 2.0 / 3)})
            out.push_back({u, v, w, 0});
        return out;
      }()};
  return rules[quadratic ? 1 : 0];
}

/// The nodes of an element; the corner 2 of a pyramid, where its determinant is 0, is left out.
std::vector<Place> node_places(bool pyramid) {
  std::vector<Place> out;
  static constexpr double corner[3][2] = {{0, 0}, {1, 0}, {0, 1}};
  for (const double w : {-1.0, 0.0, 1.0})
    for (int k = 0; k < (pyramid ? 2 : 3); ++k) out.push_back({corner[k][0], corner[k][1], w, 0});
  for (const double w : {-1.0, 1.0})
    for (int k = 0; k < 3; ++k)
      out.push_back(
          {0.5 * (corner[k][0] + corner[(k + 1) % 3][0]), 0.5 * (corner[k][1] + corner[(k + 1) % 3][1]), w, 0});
  return out;
}

struct Quad {
  std::array<std::int32_t, 4> key;  // ascending
  bool forward;                     // as seen from outside, from the smallest towards the smaller of its neighbours
  Label label;
  bool operator<(const Quad& o) const { return key != o.key ? key < o.key : forward < o.forward; }
};

Quad quad_of(std::array<std::int32_t, 4> v, Label label) {
  std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
  Quad q{v, v[1] < v[3], label};
  std::sort(q.key.begin(), q.key.end());
  return q;
}

}  // namespace

WedgeShape wedge_shape(const TetMesh& mesh, std::size_t wedge) {
  const auto& w = mesh.wedges[wedge];
  const bool pyramid = is_pyramid(w), quadratic = !mesh.wedge_mid.empty();
  WedgeShape out;
  out.scaled_jacobian = std::numeric_limits<double>::infinity();
  // A corner, the next two of its triangle, and the one over or under it.
  static constexpr int kCorner[6][4] = {{0, 1, 2, 3}, {1, 2, 0, 4}, {2, 0, 1, 5},
                                        {3, 5, 4, 0}, {4, 3, 5, 1}, {5, 4, 3, 2}};
  const double regular = pyramid ? std::sqrt(2.0) : 2 / std::sqrt(3.0);
  for (const auto& c : kCorner) {
    if (pyramid && (c[0] == 2 || c[0] == 5)) continue;
    const Vec3 &a = mesh.points[w[c[0]]], &b = mesh.points[w[c[1]]], &d = mesh.points[w[c[2]]],
               &e = mesh.points[w[c[3]]];
    out.inverted = out.inverted || exact_orientation(a, b, d, e) <= 0;
    const double product = norm(b - a) * norm(d - a) * norm(e - a);
    out.scaled_jacobian =
        std::min(out.scaled_jacobian, product > 0 ? regular * dot(b - a, cross(d - a, e - a)) / product : 0);
  }
  std::vector<Vec3> node, straight;
  for (const std::int32_t v : w) node.push_back(mesh.points[v]);
  straight = node;
  if (quadratic)
    for (const std::int32_t v : mesh.wedge_mid[wedge]) node.push_back(mesh.points[v]);
  for (const Place& p : volume_rule()) out.volume_mm3 += p.weight * determinant(node, p);
  std::vector<Place> places = integration_points(quadratic);
  if (quadratic) {
    const std::vector<Place> nodes = node_places(pyramid);
    places.insert(places.end(), nodes.begin(), nodes.end());
  }
  double least_rel = 1;
  for (const Place& p : places) {
    const double here = determinant(node, p);
    out.inverted = out.inverted || !(here > 0);
    if (quadratic) least_rel = std::min(least_rel, here / determinant(straight, p));
  }
  if (out.scaled_jacobian > 0) out.scaled_jacobian *= least_rel;
  return out;
}

std::vector<std::array<std::int32_t, 4>> unshared_sides(const TetMesh& mesh) {
  std::vector<Quad> quads;
  quads.reserve(3 * mesh.wedges.size());
  for (std::size_t i = 0; i < mesh.wedges.size(); ++i) {
    const auto& w = mesh.wedges[i];
    const Label label = mesh.labels[mesh.tets.size() + i];
    quads.push_back(quad_of({w[0], w[1], w[4], w[3]}, label));
    if (is_pyramid(w)) continue;
    quads.push_back(quad_of({w[1], w[2], w[5], w[4]}, label));
    quads.push_back(quad_of({w[2], w[0], w[3], w[5]}, label));
  }
  std::sort(quads.begin(), quads.end());
  std::vector<std::array<std::int32_t, 4>> bad;
  for (std::size_t i = 0, j; i < quads.size(); i = j) {
    for (j = i; j < quads.size() && quads[j].key == quads[i].key; ++j) {
    }
    const bool shared = j - i == 2 && quads[i].forward != quads[i + 1].forward && quads[i].label == quads[i + 1].label;
    if (!shared) bad.push_back(quads[i].key);
  }
  return bad;
}

}  // namespace stackmesh
