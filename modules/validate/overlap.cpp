#include "validate/overlap.h"

#include <algorithm>

#include "validate/boundaries.h"
#include "validate/grid_walk.h"
#include "validate/label_runs.h"

namespace stackmesh {

struct OverlapMeter::Grid {
  LabelRuns runs;
  std::size_t labels = 0;
  int threads = 0;
};

double LabelOverlap::dice(std::size_t mesh, std::size_t input) const {
  const std::size_t sum = mesh_centres[mesh] + input_centres[input];
  return sum > 0 ? 2.0 * static_cast<double>(both[mesh * input_centres.size() + input]) / static_cast<double>(sum) : 0;
}

double LabelOverlap::dice_of_all() const {
  std::size_t sum = 0, shared = 0;
  for (std::size_t l = 1; l < input_centres.size(); ++l) sum += input_centres[l];
  for (std::size_t m = 0; m < mesh_labels.size(); ++m) {
    sum += mesh_centres[m];
    for (std::size_t l = 1; l < input_centres.size(); ++l) shared += both[m * input_centres.size() + l];
  }
  return sum > 0 ? 2.0 * static_cast<double>(shared) / static_cast<double>(sum) : 0;
}

OverlapMeter::OverlapMeter(const LabelVolume& volume, int stack_axis, int threads) : grid_(new Grid) {
  grid_->runs = find_runs(volume, stack_axis, threads);
  grid_->labels = volume.labels.size();
  grid_->threads = threads;
}

OverlapMeter::~OverlapMeter() = default;

LabelOverlap OverlapMeter::measure(const InterfaceComplex& complex, const Frame& frame, int slices) const {
  LabelOverlap result;
  for (const InterfaceTriangle& t : complex.triangles)
    for (const Label l : {t.below, t.above})
      if (l != 0 && (result.mesh_labels.empty() || result.mesh_labels.back() != l)) result.mesh_labels.push_back(l);
  std::sort(result.mesh_labels.begin(), result.mesh_labels.end());
  result.mesh_labels.erase(std::unique(result.mesh_labels.begin(), result.mesh_labels.end()), result.mesh_labels.end());
  const auto row_of = [&](Label l) {
    return l == 0
               ? -1
               : static_cast<std::int32_t>(std::lower_bound(result.mesh_labels.begin(), result.mesh_labels.end(), l) -
                                           result.mesh_labels.begin());
  };
  Boundaries rows;  // one piece a label: nobody asks for pieces
  rows.row.reserve(complex.triangles.size());
  for (const InterfaceTriangle& t : complex.triangles)
    rows.row.push_back(t.below == t.above ? std::array<std::int32_t, 2>{-1, -1}
                                          : std::array<std::int32_t, 2>{row_of(t.below), row_of(t.above)});
  if (frame.mirrors())
    for (auto& sides : rows.row) std::swap(sides[0], sides[1]);
  rows.piece = rows.row;
  for (std::size_t r = 0; r < result.mesh_labels.size(); ++r) rows.piece_row.push_back(static_cast<std::int32_t>(r));
  std::vector<Vec3> points;
  points.reserve(complex.points.size());
  for (const Vec3& p : complex.points) points.push_back(grid_->runs.to_grid(frame.to_world(p)));
  const std::vector<std::int32_t> no_label(result.mesh_labels.size(), -1);
  const int step = slices > 0 ? std::max(1, grid_->runs.size[2] / slices) : 1;
  GridWalk walk = walk_grid(complex, rows, grid_->runs, points, no_label, grid_->labels, grid_->threads, step);
  result.mesh_centres = std::move(walk.row_centres);
  result.input_centres = std::move(walk.input);
  result.both = std::move(walk.overlap);
  return result;
}

}  // namespace stackmesh
