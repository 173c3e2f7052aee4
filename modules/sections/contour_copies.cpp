#include "sections/contour_copies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sections/point_in_polygon.h"

namespace stackmesh {
namespace {

constexpr double kSame_rel = 0.01, kSame_mm = 0.15;  // apart, of the extent and at most
constexpr double kCrossing_rel = 0.02;               // apart, of the extent, of copies that cross
constexpr double kCrossingShare = 0.1;               // of the points on either side of the other contour

using Point = std::array<double, 2>;
using Points = std::vector<Point>;

struct Extent {
  double x0, y0, x1, y1;
  double size() const { return std::max(x1 - x0, y1 - y0); }
};

Extent extent_of(const Points& points) {
  Extent e = {points[0][0], points[0][1], points[0][0], points[0][1]};
  for (const Point& p : points) {
    e.x0 = std::min(e.x0, p[0]);
    e.x1 = std::max(e.x1, p[0]);
    e.y0 = std::min(e.y0, p[1]);
    e.y1 = std::max(e.y1, p[1]);
  }
  return e;
}

double squared_distance(const Point& p, const Point& a, const Point& b) {
  const double dx = b[0] - a[0], dy = b[1] - a[1], length2 = dx * dx + dy * dy;
  const double t = length2 > 0 ? std::clamp(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / length2, 0.0, 1.0) : 0;
  const double x = p[0] - a[0] - t * dx, y = p[1] - a[1] - t * dy;
  return x * x + y * y;
}

/// Is every point of `from`, and the middle of every edge, within `reach` of the other contour?
bool lies_along(const Points& from, const Points& other, double reach) {
  const auto near = [&](const Point& p) {
    for (std::size_t i = 0; i < other.size(); ++i)
      if (squared_distance(p, other[i], other[(i + 1) % other.size()]) <= reach * reach) return true;
    return false;
  };
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Point &a = from[i], &b = from[(i + 1) % from.size()];
    if (!near(a) || !near({0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])})) return false;
  }
  return true;
}

bool cross(const Points& a, const Points& b) {
  const auto inside = std::count_if(a.begin(), a.end(), [&](const Point& p) { return is_inside(p, b); });
  const double share = static_cast<double>(inside) / static_cast<double>(a.size());
  return share > kCrossingShare && share < 1 - kCrossingShare;
}

bool are_copies(const Points& a, const Points& b) {
  const Extent e = extent_of(a), f = extent_of(b);
  const double size = std::max(e.size(), f.size()), loose = kCrossing_rel * size;
  const auto apart = [&](double u, double v) { return std::abs(u - v) > loose; };
  if (apart(e.x0, f.x0) || apart(e.x1, f.x1) || apart(e.y0, f.y0) || apart(e.y1, f.y1)) return false;
  const double strict = std::min(kSame_rel * size, kSame_mm);
  if (lies_along(a, b, strict) && lies_along(b, a, strict)) return true;
  return lies_along(a, b, loose) && lies_along(b, a, loose) && cross(a, b);
}

/// A contour drawn round twice without a break.
bool goes_round_twice(const Points& p) {
  const std::size_t half = p.size() / 2;
  return half >= 3 && p.size() == 2 * half &&
         std::equal(p.begin(), p.begin() + static_cast<std::ptrdiff_t>(half),
                    p.begin() + static_cast<std::ptrdiff_t>(half));
}

}  // namespace

std::size_t remove_copies(std::vector<ContourPolygon>& polygons) {
  std::size_t removed = 0, kept = 0;
  for (std::size_t q = 0; q < polygons.size(); ++q) {
    Points& points = polygons[q].points;
    if (goes_round_twice(points)) {
      points.resize(points.size() / 2);
      ++removed;
    }
    const bool copy =
        points.size() > 2 &&
        std::any_of(polygons.begin(), polygons.begin() + static_cast<std::ptrdiff_t>(kept),
                    [&](const ContourPolygon& p) { return p.points.size() > 2 && are_copies(p.points, points); });
    if (copy) {
      ++removed;
      continue;
    }
    if (kept != q) polygons[kept] = std::move(polygons[q]);
    ++kept;
  }
  polygons.resize(kept);
  return removed;
}

}  // namespace stackmesh
