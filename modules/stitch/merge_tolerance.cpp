#include "stitch/merge_tolerance.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/warning.h"
#include "model/edge_grid.h"

namespace stackmesh {
namespace {

std::vector<GridSegment> segments_of(const Section& s) {
  std::vector<GridSegment> out;
  out.reserve(s.edges.size());
  for (const SectionEdge& e : s.edges) out.push_back({s.points[e.a], s.points[e.b]});
  return out;
}

/// A section is sound when its edges meet in common end points only.
bool is_sound(const Section& s) {
  const std::vector<GridSegment> segments = segments_of(s);
  const EdgeGrid grid(segments);
  bool sound = true;
  for (std::size_t i = 0; i < segments.size() && sound; ++i) {
    if (segments[i].a == segments[i].b) return false;
    grid.near_segment(segments[i], [&](std::int32_t k) {
      if (static_cast<std::size_t>(k) >= i || !sound) return;
      const GridSegment &t = segments[i], &u = segments[k];
      if (properly_cross(t, u)) sound = false;
      for (GridPoint p : {t.a, t.b})
        if (p != u.a && p != u.b && on_segment(u, p)) sound = false;
      for (GridPoint p : {u.a, u.b})
        if (p != t.a && p != t.b && on_segment(t, p)) sound = false;
      if ((t.a == u.a && t.b == u.b) || (t.a == u.b && t.b == u.a)) sound = false;
    });
  }
  return sound;
}

/// Each point of `section` moved to the nearest vertex of `beneath`, else onto its nearest edge, within tolerance.
std::vector<GridPoint> drawn_points(const Stack& stack, const Section& section, const Section& beneath,
                                    double tolerance_mm) {
  const std::vector<GridSegment> segments = segments_of(beneath);
  const EdgeGrid grid(segments);
  const double gx = stack.grid_x_mm, gy = stack.grid_y_mm;
  const auto reach = [&](double g) { return static_cast<std::int32_t>(std::min(tolerance_mm / g, 1e8)); };
  std::vector<GridPoint> out = section.points;
  for (GridPoint& p : out) {
    double best_vertex = tolerance_mm, best_edge = tolerance_mm;
    GridPoint vertex = p, foot = p;
    bool has_vertex = false, has_edge = false;
    const auto distance = [&](double x, double y) { return std::hypot((x - p.x) * gx, (y - p.y) * gy); };
    const GridPoint origin = p;
    const std::int32_t rx = reach(gx), ry = reach(gy);
    const auto look = [&](std::int32_t i) {
      const GridSegment& s = segments[i];
      for (GridPoint q : {s.a, s.b}) {
        const double d = distance(q.x, q.y);
        if (d < best_vertex || (d == best_vertex && (!has_vertex || q < vertex))) {
          best_vertex = d;
          vertex = q;
          has_vertex = true;
        }
      }
      const double dx = (static_cast<double>(s.b.x) - s.a.x) * gx, dy = (static_cast<double>(s.b.y) - s.a.y) * gy;
      const double px = (static_cast<double>(origin.x) - s.a.x) * gx, py = (static_cast<double>(origin.y) - s.a.y) * gy;
      const double t = std::clamp((px * dx + py * dy) / (dx * dx + dy * dy), 0.0, 1.0);
      const GridPoint q = {static_cast<std::int32_t>(std::lround(s.a.x + t * dx / gx)),
                           static_cast<std::int32_t>(std::lround(s.a.y + t * dy / gy))};
      const double d = distance(q.x, q.y);
      if (d < best_edge || (d == best_edge && (!has_edge || q < foot))) {
        best_edge = d;
        foot = q;
        has_edge = true;
      }
    };
    grid.near_box({p.x - rx, p.y - ry}, {p.x + rx, p.y + ry}, look);
    if (has_vertex) p = vertex;
    else if (has_edge) p = foot;
  }
  return out;
}

}  // namespace

double merge_close_contours(Stack& stack, double tolerance_mm, int /*threads*/, std::vector<Warning>& warnings) {
  if (tolerance_mm <= 0) return 0;
  double largest = 0;
  std::size_t reduced = 0, refused = 0;
  for (std::size_t i = 1; i < stack.sections.size(); ++i) {  // each section sees the final one beneath it
    Section& section = stack.sections[i];
    if (section.points.empty() || stack.sections[i - 1].points.empty()) continue;
    if (!is_sound(section)) {
      ++refused;
      continue;
    }
    double tolerance = tolerance_mm;
    bool applied = false;
    for (int halvings = 0; halvings < 6 && !applied; ++halvings, tolerance /= 2) {
      Section moved = section;
      moved.points = drawn_points(stack, section, stack.sections[i - 1], tolerance);
      bool turned = false;  // labels must keep their area's sign
      for (const LabelInfo& label : stack.labels)
        if (label.number != 0 && label_area_mm2(stack, section, label.number) > 0 &&
            label_area_mm2(stack, moved, label.number) <= 0)
          turned = true;
      if (turned || !is_sound(moved)) continue;
      section.points = std::move(moved.points);
      largest = std::max(largest, tolerance);
      applied = true;
      if (halvings > 0) ++reduced;
    }
    if (!applied) ++refused;
  }
  if (reduced + refused > 0) {
    std::ostringstream text;
    text << "--snap " << tolerance_mm << " mm was reduced in " << reduced << " section(s) and left out in " << refused
         << ", where it would have made contours cross";
    warnings.push_back({WarningCode::merge_reduced, "", text.str()});
  }
  return largest;
}

}  // namespace stackmesh
