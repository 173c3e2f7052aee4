#include "sections/contour_crossings.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "planar/planar.h"
#include "planar/snap_rounding.h"

namespace stackmesh {
namespace {

/// How often each contour winds round a region.
using Windings = std::map<std::size_t, int>;

bool is_inside(const Windings& w) {
  return std::any_of(w.begin(), w.end(), [](const auto& e) { return e.second != 0; });
}

bool is_odd(const Windings& w) {
  int parity = 0;
  for (const auto& e : w) parity ^= e.second & 1;
  return parity != 0;
}

double area_of(const Cdt& cdt, FaceHandle f) {
  return cdt.is_infinite(f) ? 0 : std::abs(cdt.triangle(f).area());
}

/// Joins directed edges to closed walks; every vertex has as many coming in as going out.
std::vector<std::vector<GridPoint>> walk(const std::vector<GridPoint>& points,
                                         std::multimap<std::int32_t, std::int32_t> next) {
  std::vector<std::vector<GridPoint>> loops;
  while (!next.empty()) {
    std::vector<GridPoint> loop;
    const std::int32_t start = next.begin()->first;
    std::int32_t at = start;
    do {
      const auto edge = next.find(at);
      if (edge == next.end()) break;
      loop.push_back(points[at]);
      at = edge->second;
      next.erase(edge);
    } while (at != start);
    if (loop.size() > 2) loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace

UnitedContours unite_contours(const std::vector<std::vector<GridPoint>>& contours) {
  std::vector<GridSegment> segments;
  std::vector<std::size_t> contour_of;
  for (std::size_t c = 0; c < contours.size(); ++c)
    for (std::size_t i = 0; i < contours[c].size(); ++i) {
      const GridPoint a = contours[c][i], b = contours[c][(i + 1) % contours[c].size()];
      if (a == b) continue;
      segments.push_back({a, b});
      contour_of.push_back(c);
    }
  const NodedSegments noded = std::move(node_segments({segments}, 1)[0]);

  // What winding changes from the right of an edge (a < b) to its left.
  std::map<std::pair<std::int32_t, std::int32_t>, Windings> changes;
  for (const NodedEdge& e : noded.edges) {
    const bool turned = e.b < e.a;
    changes[{std::min(e.a, e.b), std::max(e.a, e.b)}][contour_of[e.source]] += turned ? -1 : 1;
  }
  Cdt cdt;
  std::vector<VertexHandle> handles;
  for (std::size_t i = 0; i < noded.points.size(); ++i) {
    handles.push_back(cdt.insert(PlanarPoint(noded.points[i].x, noded.points[i].y)));
    handles.back()->info() = static_cast<std::int32_t>(i);
  }
  for (const auto& [ends, change] : changes) cdt.insert_constraint(handles[ends.first], handles[ends.second]);

  UnitedContours united;
  std::vector<Windings> windings = {{}};  // by PlanarFace::sheet
  std::vector<FaceHandle> stack = {cdt.infinite_face()};
  stack[0]->info().sheet = 0;
  std::multimap<std::int32_t, std::int32_t> boundary;
  while (!stack.empty()) {
    const FaceHandle f = stack.back();
    stack.pop_back();
    const Windings here = windings[f->info().sheet];
    const bool inside = is_inside(here);
    const double area = area_of(cdt, f);
    united.area += inside ? area : 0;
    united.disputed += inside && !is_odd(here) ? area : 0;
    for (int i = 0; i < 3; ++i) {
      const FaceHandle g = f->neighbor(i);
      Windings there = here;
      if (f->is_constrained(i)) {
        // f lies to the left of its edge ccw -> cw; g to the right.
        const std::int32_t a = f->vertex(Cdt::ccw(i))->info(), b = f->vertex(Cdt::cw(i))->info();
        const auto change = changes.find({std::min(a, b), std::max(a, b)});
        if (change != changes.end())
          for (const auto& [contour, turns] : change->second) there[contour] -= a < b ? turns : -turns;
        if (inside && !is_inside(there)) boundary.emplace(a, b);
      }
      if (g->info().sheet >= 0) continue;
      if (there != here) {
        g->info().sheet = static_cast<std::int32_t>(windings.size());
        windings.push_back(std::move(there));
      } else {
        g->info().sheet = f->info().sheet;
      }
      stack.push_back(g);
    }
  }
  united.loops = walk(noded.points, std::move(boundary));
  return united;
}

}  // namespace stackmesh
