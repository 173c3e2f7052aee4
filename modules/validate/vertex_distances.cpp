#include "validate/vertex_distances.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "validate/face_rectangles.h"

namespace stackmesh {

std::vector<float> vertex_distances(const InterfaceComplex& complex, const LabelVolume& volume, int stack_axis,
                                    int threads) {
  if (stack_axis < 0 || stack_axis > 2)
    fail_usage("stacking axis " + std::to_string(stack_axis), "vertex distances", "use 0, 1 or 2");
  const LabelRuns runs = find_runs(volume, stack_axis, threads);
  const std::size_t labels = volume.labels.size();
  const std::vector<std::vector<FaceStrip>> faces = find_faces(runs, labels, threads);
  std::vector<float> distances(complex.points.size(), 0);
  std::vector<std::vector<std::int32_t>> points_of(labels);
  for (const InterfaceTriangle& t : complex.triangles)
    for (const Label number : {t.below, t.above}) {
      const auto it = std::lower_bound(volume.labels.begin(), volume.labels.end(), number,
                                       [](const LabelInfo& l, Label n) { return l.number < n; });
      if (number == 0 || it == volume.labels.end() || it->number != number) continue;
      auto& points = points_of[it - volume.labels.begin()];
      points.insert(points.end(), t.v.begin(), t.v.end());
    }
  for (std::size_t l = 1; l < labels; ++l) {
    std::vector<std::int32_t>& points = points_of[l];
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    const std::vector<Rectangle> rectangles = rectangles_of(runs, faces[l]);
    if (points.empty() || rectangles.empty()) continue;
    const BoxTree tree(boxes_of(rectangles));
    constexpr std::size_t kChunk = 1024;
    parallel_for((points.size() + kChunk - 1) / kChunk, threads, [&](std::size_t chunk) {
      std::int32_t hint = -1;
      for (std::size_t i = chunk * kChunk; i < std::min(points.size(), (chunk + 1) * kChunk); ++i) {
        const Vec3 p = runs.to_grid(complex.points[points[i]]);
        double best2 = 0;
        hint = tree.nearest(
            p, hint, [&](std::int32_t r) { return rectangle_distance2(p, rectangles[r]); }, &best2);
        distances[points[i]] = std::max(distances[points[i]], static_cast<float>(std::sqrt(best2)));
      }
    });
  }
  return distances;
}

}  // namespace stackmesh
