#include "planar/planar.h"

#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "base/error.h"

namespace stackmesh {
namespace {

[[noreturn]] void fail_labels(const Section& section, GridPoint p, double sx, double sy) {
  fail_input("contours contradict each other: the labels on two sides of a region differ",
             "section at z = " + std::to_string(section.z_mm) + " mm near grid point (" + std::to_string(p.x * sx) +
                 ", " + std::to_string(p.y * sy) + ")",
             "mend crossing or open contours in this section");
}

/// One vertex per distinct point of either section.
std::vector<GridPoint> merge_points(const Section& lower, const Section& upper, std::vector<PlanarVertex>& vertices,
                                    std::vector<std::int32_t>& of_upper) {
  std::vector<GridPoint> points = lower.points;
  const std::size_t n = points.size(), m = upper.points.size();
  vertices.resize(n);
  for (std::size_t i = 0; i < n; ++i) vertices[i].lower = static_cast<std::int32_t>(i);
  const auto key = [](GridPoint p) {
    return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(p.x)) << 32) | static_cast<std::uint32_t>(p.y);
  };
  std::size_t capacity = 16;
  while (capacity < 2 * n) capacity *= 2;
  std::vector<std::int32_t> slots(capacity, -1);
  const auto slot = [&](GridPoint p) {
    const std::uint64_t h = key(p) * 0x9E3779B97F4A7C15ull;
    std::size_t i = (h ^ (h >> 29)) & (capacity - 1);
    while (slots[i] >= 0 && points[slots[i]] != p) i = (i + 1) & (capacity - 1);
    return i;
  };
  for (std::size_t i = 0; i < n; ++i) slots[slot(points[i])] = static_cast<std::int32_t>(i);
  of_upper.resize(m);
  for (std::size_t j = 0; j < m; ++j) {
    const std::int32_t found = slots[slot(upper.points[j])];
    if (found >= 0) {
      of_upper[j] = found;
    } else {
      of_upper[j] = static_cast<std::int32_t>(points.size());
      points.push_back(upper.points[j]);
      vertices.emplace_back();
    }
    vertices[of_upper[j]].upper = static_cast<std::int32_t>(j);
  }
  return points;
}

/// The face to the left of a -> b and the index of the edge in it; false if there is no such edge.
bool face_left_of(const Cdt& cdt, VertexHandle a, VertexHandle b, FaceHandle& face, int& index) {
  if (!cdt.is_edge(a, b, face, index)) return false;
  if (face->vertex(Cdt::ccw(index)) != a) {
    const FaceHandle other = face->neighbor(index);
    index = cdt.mirror_index(face, index);
    face = other;
  }
  return true;
}

/// Spreads the labels of one section over the triangles: from its edges outward, never across one of them.
class Flood {
 public:
  Flood(Plane& plane, const Section& section, EdgeOf of, double sx, double sy)
      : plane_(plane), section_(section), of_(of), sx_(sx), sy_(sy) {}

  /// @param near a place of the face, for an error
  void seed(FaceHandle face, Label label, GridPoint near) {
    if (label != 0 && plane_.cdt.is_infinite(face)) fail_labels(section_, near, sx_, sy_);
    PlanarFace& info = face->info();
    if (info.known & of_) {
      if (label_of(info) != label) fail_labels(section_, near, sx_, sy_);
      return;
    }
    info.known |= of_;
    label_of(info) = label;
    stack_.push_back(face);
  }

  void run() {
    if (stack_.empty()) seed(plane_.cdt.infinite_face(), 0, {0, 0});
    while (!stack_.empty()) {
      const FaceHandle face = stack_.back();
      stack_.pop_back();
      for (int i = 0; i < 3; ++i)
        if (!(face->info().edge[i] & of_)) {
          const FaceHandle next = face->neighbor(i);
          if ((next->info().known & of_) && label_of(next->info()) == label_of(face->info())) continue;
          seed(next, label_of(face->info()), place_of(face));
        }
    }
  }

 private:
  /// A corner of the face, on the section's grid.
  GridPoint place_of(FaceHandle face) const {
    for (int i = 0; i < 3; ++i) {
      if (plane_.cdt.is_infinite(face->vertex(i))) continue;
      const PlanarPoint& p = face->vertex(i)->point();
      return {static_cast<std::int32_t>(std::lround(p.x() / sx_)), static_cast<std::int32_t>(std::lround(p.y() / sy_))};
    }
    return {};
  }
  Label& label_of(PlanarFace& info) { return of_ == kLower ? info.lower : info.upper; }
  Plane& plane_;
  const Section& section_;
  EdgeOf of_;
  double sx_, sy_;
  std::vector<FaceHandle> stack_;
};

}  // namespace

void build_plane(const Section& lower, const Section& upper, double scale_x, double scale_y, Plane& plane) {
  std::vector<std::int32_t> of_upper;
  const std::vector<GridPoint> grid = merge_points(lower, upper, plane.vertices, of_upper);
  std::vector<PlanarPoint> points;
  points.reserve(grid.size());
  for (GridPoint p : grid) points.emplace_back(p.x * scale_x, p.y * scale_y);

  // Delaunay insertion along a space-filling curve (paper 3.1.1, 3.2.1).
  Cdt& cdt = plane.cdt;
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  using PointMap = CGAL::Pointer_property_map<PlanarPoint>::type;
  CGAL::spatial_sort(order.begin(), order.end(),
                     CGAL::Spatial_sort_traits_adapter_2<Kernel, PointMap>(CGAL::make_property_map(points)));
  plane.handles.resize(points.size());
  FaceHandle hint;
  for (std::size_t i : order) {
    const VertexHandle v = cdt.insert(points[i], hint);
    v->info() = static_cast<std::int32_t>(i);
    plane.handles[i] = v;
    hint = v->face();
  }

  // Every edge once; lower edges are in ascending (a, b) order by construction, upper ones are matched to them.
  plane.edges.reserve(lower.edges.size() + upper.edges.size());
  for (const SectionEdge& e : lower.edges) plane.edges.push_back({e.a, e.b, kLower});
  for (const SectionEdge& e : upper.edges) plane.edges.push_back({of_upper[e.a], of_upper[e.b], kUpper});
  for (const PlanarEdge& e : plane.edges) {
    if (e.of == kUpper && plane.vertices[e.a].lower >= 0 && plane.vertices[e.b].lower >= 0) {
      FaceHandle face;
      int i = 0;
      if (cdt.is_edge(plane.handles[e.a], plane.handles[e.b], face, i) && face->is_constrained(i)) continue;
    }
    cdt.insert_constraint(plane.handles[e.a], plane.handles[e.b]);
  }
  if (cdt.dimension() < 2) return;

  // Edges mark the faces beside them; labels spread from there (paper 3.2.2, with labels for in and out).
  Flood flood_lower(plane, lower, kLower, scale_x, scale_y), flood_upper(plane, upper, kUpper, scale_x, scale_y);
  std::vector<char> twin(plane.edges.size(), 0);
  for (std::size_t k = 0; k < plane.edges.size(); ++k) {
    const PlanarEdge& e = plane.edges[k];
    FaceHandle left;
    int i = 0;
    if (!face_left_of(cdt, plane.handles[e.a], plane.handles[e.b], left, i))
      fail_internal("a contour edge is missing in the triangulation", "section at z = " + std::to_string(lower.z_mm));
    const FaceHandle right = left->neighbor(i);
    const int j = cdt.mirror_index(left, i);
    twin[k] = left->info().edge[i] != kNone;
    left->info().edge[i] |= e.of;
    right->info().edge[j] |= e.of;
    const bool low = e.of == kLower;
    const SectionEdge& s = low ? lower.edges[k] : upper.edges[k - lower.edges.size()];
    const GridPoint at = low ? lower.points[s.a] : upper.points[s.a];
    Flood& flood = low ? flood_lower : flood_upper;
    flood.seed(left, s.left, at);
    flood.seed(right, s.right, at);
  }
  flood_lower.run();
  flood_upper.run();

  std::size_t kept = 0;
  for (std::size_t k = 0; k < plane.edges.size(); ++k)
    if (!twin[k]) plane.edges[kept++] = plane.edges[k];
  plane.edges.resize(kept);
}

}  // namespace stackmesh
