#include "sections/drawn_detail.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/disjoint_sets.h"

namespace stackmesh {
namespace {

constexpr double kCoarsestAcross = 24, kFinestAcross = 64;  // pixels over a typical contour
constexpr double kThinShare = 0.05;                         // of the contours' length
constexpr std::size_t kRaysPerSection = 200;
constexpr double kBulgeShare = 0.75;  // of the contours' length

struct Weighted {
  double value, weight;
};

/// The value below which that share of the weight lies.
double quantile(std::vector<Weighted> list, double share) {
  if (list.empty()) return 0;
  std::sort(list.begin(), list.end(), [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  double sum = 0, all = 0;
  for (const Weighted& w : list) all += w.weight;
  for (const Weighted& w : list)
    if ((sum += w.weight) >= share * all) return w.value;
  return list.back().value;
}

struct Place {
  double x, y;
};

Place place(const Stack& stack, const Section& s, std::int32_t v) {
  return {s.points[v].x * stack.grid_x_mm, s.points[v].y * stack.grid_y_mm};
}

/// How far a ray goes from the middle of edge `from`, to its left or right, before it meets another edge.
double sight(const std::vector<std::pair<Place, Place>>& edges, std::size_t from, bool left) {
  const auto& [a, b] = edges[from];
  const double length = std::hypot(b.x - a.x, b.y - a.y);
  const double nx = (left ? -1 : 1) * (b.y - a.y) / length, ny = (left ? 1 : -1) * (b.x - a.x) / length;
  const double ox = 0.5 * (a.x + b.x), oy = 0.5 * (a.y + b.y);
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (e == from) continue;
    const auto& [p, q] = edges[e];
    const double dx = q.x - p.x, dy = q.y - p.y, across = nx * dy - ny * dx;
    if (across == 0) continue;
    const double t = ((p.x - ox) * dy - (p.y - oy) * dx) / across, u = ((p.x - ox) * ny - (p.y - oy) * nx) / across;
    if (t > 0 && u >= 0 && u <= 1) nearest = std::min(nearest, t);
  }
  return nearest;
}

}  // namespace

double contour_extent_mm(const Stack& stack) {
  std::vector<Weighted> extents;
  for (const Section& s : stack.sections) {
    DisjointSets sets;
    for (std::size_t i = 0; i < s.points.size(); ++i) sets.add();
    for (const SectionEdge& e : s.edges) sets.join(e.a, e.b);
    struct Box {
      double x0 = std::numeric_limits<double>::infinity(), y0 = x0, x1 = -x0, y1 = -x0, length = 0;
    };
    std::vector<Box> boxes(s.points.size());
    for (const SectionEdge& e : s.edges) {
      const Place a = place(stack, s, e.a), b = place(stack, s, e.b);
      Box& box = boxes[sets.find(e.a)];
      for (const Place& p : {a, b}) {
        box.x0 = std::min(box.x0, p.x);
        box.y0 = std::min(box.y0, p.y);
        box.x1 = std::max(box.x1, p.x);
        box.y1 = std::max(box.y1, p.y);
      }
      box.length += std::hypot(b.x - a.x, b.y - a.y);
    }
    for (const Box& b : boxes)
      if (b.length > 0) extents.push_back({std::max(b.x1 - b.x0, b.y1 - b.y0), b.length});
  }
  return quantile(std::move(extents), 0.5);
}

double contour_wall_mm(const Stack& stack) {
  std::vector<Weighted> seen;
  for (const Section& s : stack.sections) {
    std::vector<std::pair<Place, Place>> edges;
    std::vector<const SectionEdge*> source;
    for (const SectionEdge& e : s.edges) {
      edges.emplace_back(place(stack, s, e.a), place(stack, s, e.b));
      source.push_back(&e);
    }
    const std::size_t step = edges.size() / kRaysPerSection + 1;
    for (std::size_t i = 0; i < edges.size(); i += step) {
      const double length = std::hypot(edges[i].second.x - edges[i].first.x, edges[i].second.y - edges[i].first.y);
      if (!(length > 0)) continue;
      if (source[i]->left != 0) seen.push_back({sight(edges, i, true), length});
      if (source[i]->right != 0) seen.push_back({sight(edges, i, false), length});
    }
  }
  return seen.empty() ? std::numeric_limits<double>::infinity() : quantile(std::move(seen), kThinShare);
}

double drawn_bulge_mm(const Stack& stack) {
  std::vector<Weighted> bulges;
  for (const Section& s : stack.sections) {
    if (s.interpolated) continue;
    // of a point where two edges meet, else the first two
    std::vector<std::array<std::int32_t, 2>> edges_of(s.points.size(), {-1, -1});
    std::vector<char> passes(s.points.size(), 0);
    for (std::size_t e = 0; e < s.edges.size(); ++e)
      for (std::int32_t v : {s.edges[e].a, s.edges[e].b}) {
        if (passes[v] < 2) edges_of[v][passes[v]] = static_cast<std::int32_t>(e);
        passes[v] = static_cast<char>(std::min(passes[v] + 1, 3));
      }
    for (std::size_t e = 0; e < s.edges.size(); ++e) {
      const auto away = [&](std::int32_t edge, std::int32_t v) {  // the direction in which an edge leaves a point
        const SectionEdge& f = s.edges[edge];
        const Place p = place(stack, s, v), q = place(stack, s, f.a == v ? f.b : f.a);
        return Place{q.x - p.x, q.y - p.y};
      };
      double turns = 0;
      for (std::int32_t v : {s.edges[e].a, s.edges[e].b}) {
        if (passes[v] != 2) continue;  // a junction has no turn
        const Place p = away(edges_of[v][0], v), q = away(edges_of[v][1], v);
        turns += std::abs(std::atan2(p.x * q.y - p.y * q.x, -(p.x * q.x + p.y * q.y)));
      }
      const Place a = place(stack, s, s.edges[e].a), b = place(stack, s, s.edges[e].b);
      const double length = std::hypot(b.x - a.x, b.y - a.y);
      bulges.push_back({length * turns / 16, length});
    }
  }
  return quantile(std::move(bulges), kBulgeShare);
}

double drawn_gap_mm(const Stack& stack) {
  std::vector<Weighted> gaps;
  const Section* last = nullptr;
  for (const Section& s : stack.sections) {
    if (s.interpolated) continue;
    if (last != nullptr) gaps.push_back({s.z_mm - last->z_mm, 1});
    last = &s;
  }
  return quantile(std::move(gaps), 0.5);
}

double drawn_pixel_mm(const Stack& stack, double typical_edge_mm) {
  const double extent = contour_extent_mm(stack);
  if (!(extent > 0) || typical_edge_mm <= extent / kFinestAcross) return typical_edge_mm;
  const double detail = std::min(extent / kCoarsestAcross, 0.5 * contour_wall_mm(stack));
  return std::min(typical_edge_mm, std::max(extent / kFinestAcross, detail));
}

}  // namespace stackmesh
