#include "validate/check_surface.h"

#include <algorithm>

#include "base/parallel.h"
#include "validate/boundaries.h"
#include "validate/label_agreement.h"
#include "validate/self_intersections.h"
#include "validate/statistics.h"

namespace stackmesh {
SurfaceCheck check_surface(const InterfaceComplex& complex, const SurfaceCheckOptions& options) {
  SurfaceCheck check;
  check.vertices = complex.points.size();
  check.triangles = complex.triangles.size();

  Boundaries boundaries = find_boundaries(complex, options.list_limit);
  check.open_edges = boundaries.open_edges;
  check.nonmanifold_edges = boundaries.nonmanifold_edges;
  check.open_edge_list = std::move(boundaries.open_edge_list);
  for (const LabelBoundary& b : boundaries.labels)
    check.labels.push_back({b.label, b.closed, b.outer_pieces, b.vertices - b.edges + b.triangles, b.genus,
                            b.volume_mm3, b.area_mm2, 180, b.nonmanifold_edges});

  SelfIntersections found = find_self_intersections(complex, options.threads, options.list_limit);
  check.self_intersections = found.count;
  check.degenerate_triangles = found.degenerate;
  check.intersecting_pairs = std::move(found.pairs);
  if (check.open_edges == 0 && check.self_intersections == 0) {
    LabelConflicts conflicts = find_label_conflicts(complex, options.threads, options.list_limit);
    check.self_intersections = conflicts.count;
    check.intersecting_pairs = std::move(conflicts.pairs);
  }

  std::vector<double> angles(complex.triangles.size());
  constexpr std::size_t kChunk = 1 << 14;
  parallel_for((angles.size() + kChunk - 1) / kChunk, options.threads, [&](std::size_t chunk) {
    for (std::size_t t = chunk * kChunk; t < std::min(angles.size(), (chunk + 1) * kChunk); ++t) {
      const auto& v = complex.triangles[t].v;
      angles[t] = smallest_angle_deg(complex.points[v[0]], complex.points[v[1]], complex.points[v[2]]);
    }
  });
  for (std::size_t t = 0; t < angles.size(); ++t)
    for (const std::int32_t row : boundaries.row[t])
      if (row >= 0) check.labels[row].angle_min_deg = std::min(check.labels[row].angle_min_deg, angles[t]);
  check.angle_median_deg = percentile(angles, 0.5);
  check.angle_p1_deg = percentile(angles, 0.01);
  check.angle_min_deg = percentile(angles, 0);
  check.edge_median_mm = percentile(boundaries.edge_lengths_mm, 0.5);
  check.edge_min_mm = percentile(boundaries.edge_lengths_mm, 0);
  return check;
}

}  // namespace stackmesh
