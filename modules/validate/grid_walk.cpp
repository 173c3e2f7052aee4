#include "validate/grid_walk.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/parallel.h"

namespace stackmesh {
namespace {

/// Where the lines pass, in voxels from the centres: irrational ratios, far below any feature.
constexpr double kOffset[3] = {1.0e-7, 1.7320508e-7, 1.4142136e-7};

struct Crossing {
  std::int32_t u;
  double w;  // in voxels
  std::int32_t triangle;
  bool upwards;  // from below to above
};

class Walker {
 public:
  Walker(const InterfaceComplex& complex, const Boundaries& boundaries, const LabelRuns& runs,
         const std::vector<Vec3>& grid_points, const std::vector<std::int32_t>& row_label, std::size_t labels, int step)
      : complex_(complex), boundaries_(boundaries), runs_(runs), row_label_(row_label), labels_(labels), step_(step) {
    points_.reserve(grid_points.size());
    for (const Vec3& p : grid_points)
      points_.push_back({p.x / runs.spacing_mm[0], p.y / runs.spacing_mm[1], p.z / runs.spacing_mm[2]});
    left_handed_ = dot(cross(runs.direction[0], runs.direction[1]), runs.direction[2]) < 0;
  }

  GridWalk run(int threads) {
    GridWalk walk;
    walk.input.assign(labels_, 0), walk.mesh.assign(labels_, 0), walk.both.assign(labels_, 0);
    const std::size_t in_plane = static_cast<std::size_t>(runs_.size[1]);
    for (std::size_t v = 0; v < static_cast<std::size_t>(runs_.size[2]); v += static_cast<std::size_t>(step_))
      for (std::size_t k = runs_.start[v * in_plane]; k < runs_.start[(v + 1) * in_plane]; ++k)
        walk.input[runs_.runs[k].label] += static_cast<std::size_t>(runs_.runs[k].end - runs_.runs[k].begin);
    const std::size_t rows = row_label_.size();
    walk.row_centres.assign(rows, 0), walk.row_middle.assign(rows, {}), walk.overlap.assign(rows * labels_, 0);
    std::vector<std::array<std::uint64_t, 3>> sums(rows, {0, 0, 0});
    sort_triangles_to_planes();
    const std::size_t planes = static_cast<std::size_t>(runs_.size[2]);
    std::vector<Pairs> same_solid(planes), meets(planes);
    std::mutex mutex;
    parallel_for(planes, threads, [&](std::size_t v) {
      if (v % static_cast<std::size_t>(step_) != 0 || start_[v] == start_[v + 1]) return;
      PlaneResult plane(row_label_.size(), labels_);
      walk_plane(static_cast<std::int32_t>(v), plane);
      make_unique(plane.same_solid);
      make_unique(plane.meets);
      same_solid[v] = std::move(plane.same_solid);
      meets[v] = std::move(plane.meets);
      const std::lock_guard<std::mutex> lock(mutex);  // sums of integers: any order
      for (std::size_t row = 0; row < rows; ++row) {
        if (plane.centres[row] == 0) continue;
        walk.row_centres[row] += plane.centres[row];
        sums[row][0] += plane.sum_w[row], sums[row][1] += plane.sum_u[row], sums[row][2] += plane.centres[row] * v;
        for (std::size_t l = 0; l < labels_; ++l) walk.overlap[row * labels_ + l] += plane.overlap[row * labels_ + l];
      }
    });
    for (std::size_t row = 0; row < rows; ++row) {
      const double n = static_cast<double>(std::max<std::size_t>(1, walk.row_centres[row]));
      walk.row_middle[row] = {static_cast<double>(sums[row][0]) / n, static_cast<double>(sums[row][1]) / n,
                              static_cast<double>(sums[row][2]) / n};
      if (row_label_[row] < 0) continue;
      walk.mesh[row_label_[row]] += walk.row_centres[row];
      walk.both[row_label_[row]] += walk.overlap[row * labels_ + row_label_[row]];
    }
    DisjointSets solids(boundaries_.piece_row.size());
    for (const Pairs& pairs : same_solid)
      for (const auto& p : pairs) solids.join(p.first, p.second);
    for (std::size_t p = 0; p < boundaries_.piece_row.size(); ++p)
      walk.solid.push_back(solids.find(static_cast<std::int32_t>(p)));
    for (const Pairs& pairs : meets)
      for (const auto& p : pairs) walk.meets.push_back({p.first, walk.solid[p.second]});
    make_unique(walk.meets);
    return walk;
  }

 private:
  using Pairs = std::vector<std::pair<std::int32_t, std::int32_t>>;

  struct PlaneResult {
    PlaneResult(std::size_t rows, std::size_t labels)
        : centres(rows), sum_w(rows), sum_u(rows), overlap(rows * labels) {}
    std::vector<std::size_t> centres, sum_w, sum_u, overlap;
    Pairs same_solid, meets;
  };

  static void make_unique(Pairs& pairs) {
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  }

  static void add(Pairs& pairs, std::int32_t a, std::int32_t b) {
    if (pairs.empty() || pairs.back() != std::make_pair(a, b)) pairs.push_back({a, b});
  }

  /// The planes whose lines a triangle may cross.
  std::pair<std::int32_t, std::int32_t> planes_of(std::size_t t) const {
    const auto& v = complex_.triangles[t].v;
    const auto z = std::minmax({points_[v[0]].z, points_[v[1]].z, points_[v[2]].z});
    const double last = runs_.size[2] - 1.0;
    return {static_cast<std::int32_t>(std::clamp(std::ceil(z.first - kOffset[2]), 0.0, last + 1)),
            static_cast<std::int32_t>(std::clamp(std::floor(z.second - kOffset[2]), -1.0, last))};
  }

  void sort_triangles_to_planes() {
    start_.assign(static_cast<std::size_t>(runs_.size[2]) + 1, 0);
    const auto each = [&](auto visit) {
      for (std::size_t t = 0; t < complex_.triangles.size(); ++t) {
        if (boundaries_.row[t][0] < 0 && boundaries_.row[t][1] < 0) continue;
        const auto range = planes_of(t);
        for (std::int32_t v = range.first; v <= range.second; ++v) visit(v, static_cast<std::int32_t>(t));
      }
    };
    each([&](std::int32_t v, std::int32_t) { ++start_[v + 1]; });
    for (std::size_t v = 0; v + 1 < start_.size(); ++v) start_[v + 1] += start_[v];
    triangles_.resize(start_.back());
    std::vector<std::size_t> at(start_.begin(), start_.end() - 1);
    each([&](std::int32_t v, std::int32_t t) { triangles_[at[v]++] = t; });
  }

  /// Twice the signed area of (p, q, (y, z)) in the plane of U and V. Computed the same way for both
  /// triangles at an edge, so that a line passes exactly one of them.
  double beside(std::int32_t p, std::int32_t q, double y, double z) const {
    const bool swapped = p > q;
    if (swapped) std::swap(p, q);
    const Vec3 &a = points_[p], &b = points_[q];
    const double area = (b.y - a.y) * (z - a.z) - (b.z - a.z) * (y - a.y);
    return swapped ? -area : area;
  }
  static bool left(std::int32_t p, std::int32_t q, double area) { return p < q ? area >= 0 : area > 0; }

  void cross_triangle(std::int32_t t, double z, std::vector<Crossing>& out) const {
    const auto& v = complex_.triangles[t].v;
    double low = 1e300, high = -1e300;  // where the line of lines at z cuts the triangle
    for (int k = 0; k < 3; ++k) {
      const Vec3 &a = points_[v[k]], &b = points_[v[(k + 1) % 3]];
      if ((a.z < z) == (b.z < z)) continue;
      const double y = a.y + (z - a.z) / (b.z - a.z) * (b.y - a.y);
      low = std::min(low, y), high = std::max(high, y);
    }
    if (low > high) return;
    const double slack = 1e-6 * (1 + std::abs(low) + std::abs(high));
    const std::int32_t first = static_cast<std::int32_t>(std::max(0.0, std::ceil(low - slack - kOffset[1])));
    const std::int32_t last =
        static_cast<std::int32_t>(std::min(runs_.size[1] - 1.0, std::floor(high + slack - kOffset[1])));
    const double w0 = points_[v[0]].x, w1 = points_[v[1]].x, w2 = points_[v[2]].x;
    for (std::int32_t u = first; u <= last; ++u) {
      const double y = u + kOffset[1];
      const double c = beside(v[0], v[1], y, z), a = beside(v[1], v[2], y, z), b = beside(v[2], v[0], y, z);
      const bool in_c = left(v[0], v[1], c), in_a = left(v[1], v[2], a), in_b = left(v[2], v[0], b);
      if (in_a != in_b || in_b != in_c) continue;
      const double sum = a + b + c;
      const double w = sum != 0 ? (a * w0 + b * w1 + c * w2) / sum : (w0 + w1 + w2) / 3;
      out.push_back({u, std::clamp(w, std::min({w0, w1, w2}), std::max({w0, w1, w2})), t, in_a != left_handed_});
    }
  }

  void walk_plane(std::int32_t v, PlaneResult& result) const {
    std::vector<Crossing> crossings;
    for (std::size_t k = start_[v]; k < start_[v + 1]; ++k) cross_triangle(triangles_[k], v + kOffset[2], crossings);
    std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
      return a.u != b.u ? a.u < b.u : a.w != b.w ? a.w < b.w : a.triangle < b.triangle;
    });
    for (auto begin = crossings.begin(); begin != crossings.end();) {
      const auto end = std::find_if(begin, crossings.end(), [&](const Crossing& c) { return c.u != begin->u; });
      walk_line(static_cast<std::size_t>(v) * runs_.size[1] + begin->u, &*begin, &*begin + (end - begin), result);
      begin = end;
    }
  }

  std::int32_t row_before(const Crossing& c) const { return boundaries_.row[c.triangle][c.upwards ? 0 : 1]; }

  void walk_line(std::size_t line, Crossing* begin, Crossing* end, PlaneResult& result) const {
    std::int32_t row = -1, piece = -1;
    double since = 0;
    std::size_t run = runs_.start[line];
    for (Crossing* c = begin; c != end; ++c) {
      // At the tip of a wedge rounding may swap two crossings: take the one that continues the label we are
      // in.
      for (Crossing* d = c; row_before(*c) != row && d != end && d->w - c->w < 1e-3; ++d)
        if (row_before(*d) == row) std::rotate(c, d, d + 1);
      if (row >= 0) {
        if (row_before(*c) == row) add(result.same_solid, piece, boundaries_.piece[c->triangle][c->upwards ? 0 : 1]);
        count(line, run, row, piece, since, c->w, result);
      }
      row = boundaries_.row[c->triangle][c->upwards ? 1 : 0];
      piece = boundaries_.piece[c->triangle][c->upwards ? 1 : 0];
      since = c->w;
    }
  }

  /// The voxel centres of the line between two crossings.
  void count(std::size_t line, std::size_t& run, std::int32_t row, std::int32_t piece, double from, double to,
             PlaneResult& result) const {
    const std::int32_t label = row_label_[row];
    const auto centre = [&](double w) {
      return static_cast<std::int32_t>(std::clamp(std::ceil(w - kOffset[0]), 0.0, static_cast<double>(runs_.size[0])));
    };
    const std::int32_t first = centre(from), last = centre(to);
    if (first >= last) return;
    const std::size_t n = static_cast<std::size_t>(last - first);
    result.centres[row] += n;
    result.sum_w[row] += n * (static_cast<std::size_t>(first) + static_cast<std::size_t>(last) - 1) / 2;
    result.sum_u[row] += n * (line % static_cast<std::size_t>(runs_.size[1]));
    while (run < runs_.start[line + 1] && runs_.runs[run].end <= first) ++run;
    for (std::size_t k = run; k < runs_.start[line + 1] && runs_.runs[k].begin < last; ++k) {
      result.overlap[static_cast<std::size_t>(row) * labels_ + static_cast<std::size_t>(runs_.runs[k].label)] +=
          static_cast<std::size_t>(std::min(last, runs_.runs[k].end) - std::max(first, runs_.runs[k].begin));
      if (runs_.runs[k].label == label) add(result.meets, runs_.runs[k].component, piece);
    }
  }

  const InterfaceComplex& complex_;
  const Boundaries& boundaries_;
  const LabelRuns& runs_;
  const std::vector<std::int32_t>& row_label_;
  const std::size_t labels_;
  const int step_;
  std::vector<Vec3> points_;  // along W, U, V in voxels
  bool left_handed_ = false;
  std::vector<std::size_t> start_;  // triangles of each plane
  std::vector<std::int32_t> triangles_;
};

}  // namespace

GridWalk walk_grid(const InterfaceComplex& complex, const Boundaries& boundaries, const LabelRuns& runs,
                   const std::vector<Vec3>& grid_points, const std::vector<std::int32_t>& row_label, std::size_t labels,
                   int threads, int step) {
  return Walker(complex, boundaries, runs, grid_points, row_label, labels, step).run(threads);
}

}  // namespace stackmesh
