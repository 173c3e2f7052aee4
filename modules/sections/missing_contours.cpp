#include "sections/missing_contours.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "sections/polygons.h"
#include "stitch/stitch.h"

namespace stackmesh {
namespace {

using Point = std::array<double, 2>;

/// Twice the area that the polygon goes round.
double twice_area(const std::vector<Point>& p) {
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Point &a = p[i], &b = p[(i + 1) % p.size()];
    sum += (a[0] - p[0][0]) * (b[1] - p[0][1]) - (b[0] - p[0][0]) * (a[1] - p[0][1]);
  }
  return std::abs(sum);
}

/// The closed curves in which a closed surface meets a plane of constant z. A point at exactly that height counts as
/// above.
std::vector<ContourPolygon> cut(const InterfaceComplex& surface, double z_mm) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> ids;  // an edge that is cut -> its point
  std::vector<Point> points;
  std::multimap<std::int32_t, std::int32_t> next;
  const auto above = [&](std::int32_t v) { return surface.points[v].z >= z_mm; };
  const auto id_of = [&](std::int32_t u, std::int32_t v) {
    const auto key = std::minmax(u, v);
    const auto [it, fresh] =
        ids.emplace(std::pair<std::int32_t, std::int32_t>(key), static_cast<std::int32_t>(points.size()));
    if (fresh) {
      const Vec3 a = surface.points[key.first], b = surface.points[key.second];
      const double t = (z_mm - a.z) / (b.z - a.z);
      points.push_back({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
    }
    return it->second;
  };
  for (const InterfaceTriangle& t : surface.triangles)
    for (int i = 0; i < 3; ++i) {  // the corner that is alone on its side
      const std::int32_t a = t.v[i], b = t.v[(i + 1) % 3], c = t.v[(i + 2) % 3];
      if (above(a) == above(b) || above(a) == above(c)) continue;
      const std::int32_t p = id_of(a, b), q = id_of(a, c);
      // The same sense on either side of an edge, so that the pieces join head to tail.
      if (above(a) != (t.above == 0)) next.emplace(p, q);
      else next.emplace(q, p);
    }
  std::vector<ContourPolygon> polygons;
  while (!next.empty()) {
    ContourPolygon polygon;
    const std::int32_t start = next.begin()->first;
    std::int32_t at = start;
    do {
      const auto piece = next.find(at);
      if (piece == next.end()) break;
      polygon.points.push_back(points[at]);
      at = piece->second;
      next.erase(piece);
    } while (at != start);
    if (polygon.points.size() > 2 && twice_area(polygon.points) > 0) polygons.push_back(std::move(polygon));
  }
  return polygons;
}

/// The section in which the stitched stack meets a plane.
ContourSection cut_stitched(Stack stack, double z_mm) {
  StitchOptions options;
  options.caps = Caps::round;
  options.threads = 1;
  Monitor silent;
  const Vec3 origin = stack.frame.origin;
  const InterfaceComplex surface = stitch_sections(std::move(stack), options, silent).complex;
  ContourSection section;
  section.z_mm = z_mm;
  section.interpolated = true;
  section.polygons = cut(surface, z_mm);
  for (ContourPolygon& polygon : section.polygons)
    for (Point& p : polygon.points) {
      p[0] += origin.x;
      p[1] += origin.y;
    }
  return section;
}

Stack stack_of(const ContourSection& low, const ContourSection& high) {
  LabelContours both;
  both.sections = {low, high};
  std::vector<Warning> unused;
  ContourStackOptions as_they_are;
  as_they_are.repair = true;
  return sections_from_contours({both}, unused, as_they_are);
}

}  // namespace

ContourSection contours_between(const ContourSection& low, const ContourSection& high, double z_mm) {
  return cut_stitched(stack_of(low, high), z_mm);
}

ContourSection dome_section(const ContourSection& last, double gap_mm, bool slices, double way_mm) {
  ContourSection above = last;
  above.z_mm += gap_mm;
  Stack stack = stack_of(last, above);
  stack.sections.pop_back();
  stack.drawn_ends.clear();
  stack.slices = slices;
  stack.end_gap_mm = gap_mm;
  return cut_stitched(std::move(stack), last.z_mm + way_mm);
}

}  // namespace stackmesh
