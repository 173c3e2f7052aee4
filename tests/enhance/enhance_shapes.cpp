#include "enhance_shapes.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace stackmesh::testing_support {
namespace {

/// Six faces of grids over [low, high], points shared.
void add_box(InterfaceComplex& c, Vec3 low, Vec3 high, int n, Label label) {
  std::map<std::array<int, 3>, std::int32_t> numbers;
  const auto point = [&](std::array<int, 3> g) {
    const auto [it, fresh] = numbers.insert({g, static_cast<std::int32_t>(c.points.size())});
    if (fresh)
      c.points.push_back({low.x + (high.x - low.x) * g[0] / n, low.y + (high.y - low.y) * g[1] / n,
                          low.z + (high.z - low.z) * g[2] / n});
    return it->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          std::int32_t q[4];
          for (int k = 0; k < 4; ++k) {
            std::array<int, 3> g;
            g[axis] = side * n;
            g[(axis + 1) % 3] = i + (k == 1 || k == 2);
            g[(axis + 2) % 3] = j + (k >= 2);
            q[k] = point(g);
          }
          if (side == 0) std::swap(q[1], q[3]);
          for (const auto& v : {std::array<std::int32_t, 3>{q[0], q[1], q[2]}, {q[0], q[2], q[3]}})
            c.triangles.push_back({v, label, 0});
        }
}

}  // namespace

InterfaceComplex cube(double side, int n) {
  InterfaceComplex c;
  add_box(c, {0, 0, 0}, {side, side, side}, n, 1);
  return c;
}

InterfaceComplex two_plates(double side, double thickness, double gap) {
  InterfaceComplex c;
  add_box(c, {0, 0, 0}, {side, side, thickness}, 12, 1);
  add_box(c, {0, 0, thickness + gap}, {side, side, 2 * thickness + gap}, 13, 2);
  return c;
}

InterfaceComplex ball(double radius, int levels) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  InterfaceComplex c;
  c.points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
              {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<std::array<std::int32_t, 3>> faces = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middle;
    std::vector<std::array<std::int32_t, 3>> next;
    const auto mid = [&](std::int32_t a, std::int32_t b) {
      const auto [it, fresh] = middle.insert({std::minmax(a, b), static_cast<std::int32_t>(c.points.size())});
      if (fresh) c.points.push_back(0.5 * (c.points[a] + c.points[b]));
      return it->second;
    };
    for (const auto& f : faces) {
      const std::int32_t x = mid(f[0], f[1]), y = mid(f[1], f[2]), z = mid(f[2], f[0]);
      next.insert(next.end(), {{f[0], x, z}, {f[1], y, x}, {f[2], z, y}, {x, y, z}});
    }
    faces = next;
    for (Vec3& p : c.points) p = (1 / norm(p)) * p;
  }
  for (Vec3& p : c.points) p = (radius / norm(p)) * p;
  for (const auto& f : faces) c.triangles.push_back({f, 1, 0});
  return c;
}

std::vector<double> bends_deg(const InterfaceComplex& c) {
  std::map<std::pair<int, int>, Vec3> first;
  std::vector<double> bends;
  for (const InterfaceTriangle& t : c.triangles) {
    const Vec3 n = cross(c.points[t.v[1]] - c.points[t.v[0]], c.points[t.v[2]] - c.points[t.v[0]]);
    for (int k = 0; k < 3; ++k) {
      const auto [it, fresh] = first.insert({std::minmax(int(t.v[k]), int(t.v[(k + 1) % 3])), n});
      if (!fresh)
        bends.push_back(std::acos(std::clamp(dot(n, it->second) / (norm(n) * norm(it->second)), -1.0, 1.0)) * 180 /
                        M_PI);
    }
  }
  return bends;
}

double interface_area(const InterfaceComplex& c, Label a, Label b) {
  double sum = 0;
  for (const InterfaceTriangle& t : c.triangles)
    if (std::minmax(t.below, t.above) == std::minmax(a, b)) {
      const Vec3 &p = c.points[t.v[0]], &q = c.points[t.v[1]], &r = c.points[t.v[2]];
      sum += 0.5 * norm(cross(q - p, r - p));
    }
  return sum;
}

}  // namespace stackmesh::testing_support
