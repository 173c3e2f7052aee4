#include "validate/check_fidelity.h"

#include <algorithm>
#include <limits>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "validate/band.h"
#include "validate/boundaries.h"
#include "validate/box_tree.h"
#include "validate/face_rectangles.h"
#include "validate/grid_walk.h"
#include "validate/label_runs.h"
#include "validate/match_components.h"
#include "validate/statistics.h"

namespace stackmesh {
namespace {

constexpr std::size_t kChunk = 1024, kShiftSamples = 4000;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Corners {
  Vec3 a, b, c;
};

double segment_distance2(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 e = b - a;
  const double length2 = dot(e, e);
  const double s = length2 > 0 ? std::clamp(dot(p - a, e) / length2, 0.0, 1.0) : 0;
  const Vec3 d = p - (a + s * e);
  return dot(d, d);
}

double triangle_distance2(const Vec3& p, const Corners& t) {
  const Vec3 n = cross(t.b - t.a, t.c - t.a);
  const double area2 = dot(n, n);
  if (area2 > 0 && dot(cross(t.b - t.a, p - t.a), n) >= 0 && dot(cross(t.c - t.b, p - t.b), n) >= 0 &&
      dot(cross(t.a - t.c, p - t.c), n) >= 0) {
    const double height = dot(p - t.a, n);
    return height * height / area2;
  }
  return std::min({segment_distance2(p, t.a, t.b), segment_distance2(p, t.b, t.c), segment_distance2(p, t.c, t.a)});
}

/// Distances from points to the nearest of some items; the points follow each other closely. None where there are no
/// items.
template <class Item, class Distance2>
std::vector<double> distances_of(const std::vector<Vec3>& points, const std::vector<Item>& items,
                                 const std::vector<Box>& boxes, int threads, Distance2 distance2,
                                 std::vector<std::int32_t>* nearest = nullptr) {
  std::vector<double> distances;
  if (points.empty() || items.empty()) return distances;
  const BoxTree tree(boxes);
  distances.resize(points.size());
  if (nearest) nearest->resize(points.size());
  parallel_for((points.size() + kChunk - 1) / kChunk, threads, [&](std::size_t chunk) {
    std::int32_t hint = -1;
    for (std::size_t i = chunk * kChunk; i < std::min(points.size(), (chunk + 1) * kChunk); ++i) {
      double best = 0;
      hint = tree.nearest(
          points[i], hint, [&](std::int32_t k) { return distance2(points[i], items[k]); }, &best);
      distances[i] = std::sqrt(best);
      if (nearest) (*nearest)[i] = hint;
    }
  });
  return distances;
}

Distance distribution(std::vector<double> distances) {
  if (distances.empty()) return {kNaN, kNaN, kNaN};
  Distance d;
  for (const double x : distances) d.mean += x / static_cast<double>(distances.size()), d.max = std::max(d.max, x);
  d.p95 = percentile(distances, 0.95);
  return d;
}

/// What is closer to the band than a ten thousandth of a voxel is inside: files round coordinates.
BandDistance band_distance(const std::vector<double>& distances, double rounding_mm) {
  if (distances.empty()) return {kNaN, kNaN, kNaN};
  BandDistance d;
  const double n = static_cast<double>(distances.size());
  for (const double x : distances)
    if (x > rounding_mm) d.mean += x / n, d.max = std::max(d.max, x), d.outside_share += 1;
  d.outside_share /= n;
  return d;
}

std::uint64_t hash(std::uint64_t x) {  // splitmix64
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// Centres of faces, or of the in-plane ones only, at most about `most`, chosen by a hash of their number so
/// that no pattern survives.
std::vector<Vec3> sample_faces(const LabelRuns& runs, const std::vector<FaceStrip>& strips, std::size_t most,
                               std::uint64_t seed, bool in_plane_only = true) {
  std::size_t count = 0;
  for (const FaceStrip& s : strips)
    if (s.axis != 2 || !in_plane_only) count += static_cast<std::size_t>(s.end - s.begin);
  const bool all = count <= most;
  const std::uint64_t threshold =
      all ? 0
          : static_cast<std::uint64_t>(18446744073709551615.0 *
                                       (static_cast<double>(most) / static_cast<double>(count)));
  std::vector<Vec3> points;
  std::size_t number = 0;
  for (const FaceStrip& s : strips) {
    if (s.axis == 2 && in_plane_only) continue;
    for (std::int32_t w = s.begin; w < s.end; ++w)
      if (all || hash(seed ^ hash(number++)) < threshold)
        points.push_back(runs.place(w + (s.axis == 0 ? 0.5 * s.sign : 0), s.u + (s.axis == 1 ? 0.5 * s.sign : 0),
                                    s.v + (s.axis == 2 ? 0.5 * s.sign : 0)));
  }
  return points;
}

/// Points spread by area: one in each of equal shares of it, placed in their triangle by a low-discrepancy
/// sequence.
std::vector<Vec3> sample_surface(const std::vector<Corners>& triangles, std::size_t most) {
  const std::size_t count = std::min(most, std::max<std::size_t>(20000, 4 * triangles.size()));
  double total = 0;
  for (const Corners& t : triangles) total += norm(cross(t.b - t.a, t.c - t.a));
  std::vector<Vec3> points;
  if (!(total > 0) || count == 0) return points;
  double passed = 0;
  for (const Corners& t : triangles) {
    passed += norm(cross(t.b - t.a, t.c - t.a));
    while (points.size() < count &&
           (static_cast<double>(points.size()) + 0.5) / static_cast<double>(count) * total <= passed) {
      const double n = static_cast<double>(points.size());
      double x = std::fmod(0.5 + n * 0.75487766624669276, 1), y = std::fmod(0.5 + n * 0.56984029099805327, 1);
      if (x + y > 1) x = 1 - x, y = 1 - y;
      points.push_back(t.a + (x * (t.b - t.a) + y * (t.c - t.a)));
    }
  }
  return points;
}

/// The shift t, and a swelling b, that fit best to the signed distances s = n.t + b of voxel faces from the
/// triangle nearest to them. Outliers (parts that are missing) are left out, in two rounds. mm along W, U, V.
std::optional<Vec3> fit_shift(const std::vector<Vec3>& points, const std::vector<std::int32_t>& nearest,
                              const std::vector<Corners>& triangles, double voxel_mm) {
  struct Sample {
    double n[4], s;
  };
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Corners& t = triangles[nearest[i]];
    const Vec3 n = cross(t.b - t.a, t.c - t.a);
    const double length = norm(n);
    if (!(length > 0)) continue;
    const double s = dot(n, t.a - points[i]) / length;
    if (std::abs(s) < 2 * voxel_mm) samples.push_back({{n.x / length, n.y / length, n.z / length, 1}, s});
  }
  double x[4] = {0, 0, 0, 0}, gate = 2 * voxel_mm;
  for (int round = 0; round < 3; ++round) {
    double a[4][5] = {};
    std::size_t used = 0;
    for (const Sample& m : samples) {
      double residual = m.s;
      for (int k = 0; k < 4; ++k) residual -= m.n[k] * x[k];
      if (std::abs(residual) > gate) continue;
      ++used;
      for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) a[i][j] += m.n[i] * m.n[j];
        a[i][4] += m.n[i] * m.s;
      }
    }
    if (used < 50) return std::nullopt;
    // b first, so that the pivots of the shift tell whether it is determined.
    const int order[4] = {3, 0, 1, 2};
    for (int i = 0; i < 4; ++i) {
      const int p = order[i];
      if (a[p][p] < 0.02 * static_cast<double>(used)) return std::nullopt;
      for (int j = 0; j < 4; ++j) {
        if (j == p) continue;
        const double factor = a[j][p] / a[p][p];
        for (int k = 0; k < 5; ++k) a[j][k] -= factor * a[p][k];
      }
    }
    for (int k = 0; k < 4; ++k) x[k] = a[k][4] / a[k][k];
    std::vector<double> residuals;
    for (const Sample& m : samples) {
      double residual = m.s;
      for (int k = 0; k < 4; ++k) residual -= m.n[k] * x[k];
      residuals.push_back(std::abs(residual));
    }
    gate = std::max(3 * percentile(residuals, 0.5), 0.02 * voxel_mm);
  }
  return Vec3{x[0], x[1], x[2]};
}

/// What the walk through the voxel centres counted, of each label.
void count_centres(const GridWalk& walk, const LabelVolume& volume, std::vector<LabelFidelity>& rows) {
  const std::size_t labels = volume.labels.size();
  for (std::size_t l = 1; l < labels; ++l) {
    LabelFidelity& row = rows[l - 1];
    row.label = volume.labels[l].number;
    row.input_voxels = walk.input[l];
    row.mesh_voxels = walk.mesh[l];
    const std::size_t sum = walk.input[l] + walk.mesh[l];
    row.wrong_centres = sum - 2 * walk.both[l];
    row.wrong_centres_share =
        walk.input[l] > 0 ? static_cast<double>(row.wrong_centres) / static_cast<double>(walk.input[l]) : kNaN;
    row.dice = sum > 0 ? 2.0 * static_cast<double>(walk.both[l]) / static_cast<double>(sum) : kNaN;
  }
}

/// Which label of the input each label of the mesh covers best.
void find_best_matches(const GridWalk& walk, const LabelRuns& runs, const LabelVolume& volume,
                       const std::vector<std::int32_t>& row_label, std::vector<LabelFidelity>& rows) {
  const std::size_t labels = volume.labels.size();
  for (std::size_t r = 0; r < row_label.size(); ++r) {
    if (row_label[r] < 0) continue;
    LabelFidelity& row = rows[row_label[r] - 1];
    const Vec3& m = walk.row_middle[r];
    row.middle = runs.to_world(runs.place(m.x, m.y, m.z));
    for (std::size_t l = 1; l < labels; ++l) {
      const std::size_t sum = walk.input[l] + walk.row_centres[r];
      const double dice =
          sum > 0 ? 2.0 * static_cast<double>(walk.overlap[r * labels + l]) / static_cast<double>(sum) : 0;
      if (dice > row.best_dice) row.best_dice = dice, row.best_match = volume.labels[l].number;
    }
  }
}

std::vector<Box> boxes_of(const std::vector<Corners>& triangles) {
  std::vector<Box> boxes(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const Vec3& p : {triangles[t].a, triangles[t].b, triangles[t].c}) boxes[t].add(p);
  return boxes;
}

/// By how much a label's surface is shifted as a whole against its voxels, in voxels along the volume's axes.
void measure_shift(const LabelRuns& runs, const std::vector<Corners>& triangles, const std::vector<Box>& boxes,
                   const std::vector<FaceStrip>& faces, const FidelityOptions& options, LabelFidelity& row) {
  const std::vector<Vec3> all_round = sample_faces(runs, faces, kShiftSamples, options.seed, false);
  std::vector<std::int32_t> nearest;
  distances_of(all_round, triangles, boxes, options.threads, triangle_distance2, &nearest);
  const double voxel = std::max({runs.spacing_mm[0], runs.spacing_mm[1], runs.spacing_mm[2]});
  if (const auto shift = nearest.empty() ? std::nullopt : fit_shift(all_round, nearest, triangles, voxel)) {
    const double along[3] = {shift->x, shift->y, shift->z};
    double by_axis[3];
    for (int k = 0; k < 3; ++k) by_axis[runs.axis[k]] = along[k] / runs.spacing_mm[k];
    row.offset_voxels = Vec3{by_axis[0], by_axis[1], by_axis[2]};
  }
}

/// Distances between a label's voxel faces and its surface, both ways, and of its surface from the band.
/// @param rounding_mm what is not outside the band yet
void measure_distances(const LabelRuns& runs, const std::vector<Corners>& triangles,
                       const std::vector<FaceStrip>& faces, const std::vector<Rectangle>& band, double rounding_mm,
                       const FidelityOptions& options, LabelFidelity& row) {
  const std::vector<Box> boxes = boxes_of(triangles);
  const std::vector<Vec3> from_faces = sample_faces(runs, faces, options.face_samples, options.seed);
  row.distance_samples = from_faces.size();
  row.distance_mm = distribution(distances_of(from_faces, triangles, boxes, options.threads, triangle_distance2));
  if (!triangles.empty() && !faces.empty()) measure_shift(runs, triangles, boxes, faces, options, row);

  const std::vector<Rectangle> rectangles = rectangles_of(runs, faces);
  const std::vector<Vec3> from_surface = sample_surface(triangles, options.surface_samples);
  row.reverse_distance_samples = from_surface.size();
  row.reverse_distance_mm =
      distribution(distances_of(from_surface, rectangles, boxes_of(rectangles), options.threads, rectangle_distance2));
  row.band_distance_mm = band_distance(
      distances_of(from_surface, band, boxes_of(band), options.threads, rectangle_distance2), rounding_mm);
}

}  // namespace

std::vector<LabelFidelity> check_fidelity(const InterfaceComplex& complex, const LabelVolume& volume,
                                          const FidelityOptions& options) {
  if (options.stack_axis < 0 || options.stack_axis > 2)
    fail_usage("stacking axis " + std::to_string(options.stack_axis), "fidelity check", "use 0, 1 or 2");
  const std::size_t labels = volume.labels.size();
  const Boundaries boundaries = find_boundaries(complex, 0);
  const LabelRuns runs = find_runs(volume, options.stack_axis, options.threads);

  std::vector<std::int32_t> row_label, label_row(labels, -1);
  for (std::size_t row = 0; row < boundaries.labels.size(); ++row) {
    row_label.push_back(-1);
    for (std::size_t l = 1; l < labels; ++l)
      if (volume.labels[l].number == boundaries.labels[row].label) {
        row_label.back() = static_cast<std::int32_t>(l);
        label_row[l] = static_cast<std::int32_t>(row);
      }
  }
  std::vector<Vec3> points;
  points.reserve(complex.points.size());
  for (const Vec3& p : complex.points) points.push_back(runs.to_grid(p));

  std::vector<LabelFidelity> rows(labels > 0 ? labels - 1 : 0);
  {  // the walk is large, and no longer needed when distances are measured
    const GridWalk walk = walk_grid(complex, boundaries, runs, points, row_label, labels, options.threads);
    count_centres(walk, volume, rows);
    match_components(runs, complex, points, boundaries, walk, row_label, rows);
    find_best_matches(walk, runs, volume, row_label, rows);
  }

  std::vector<std::vector<std::int32_t>> of_row(boundaries.labels.size());
  for (std::size_t t = 0; t < boundaries.row.size(); ++t)
    for (const std::int32_t row : boundaries.row[t])
      if (row >= 0) of_row[row].push_back(static_cast<std::int32_t>(t));
  const std::vector<std::vector<FaceStrip>> faces = find_faces(runs, labels, options.threads);
  const std::vector<std::vector<BandStrip>> bands = find_bands(runs, labels, options.threads);
  double wider[3] = {0, 0, 0};
  for (int k = 0; options.band_mm && k < 3; ++k)
    wider[k] = std::max(0.0, 0.5 * ((*options.band_mm)[runs.axis[k]] - runs.spacing_mm[k]));
  const Vec3 wider_mm = {wider[0], wider[1], wider[2]};
  double rounding_mm = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) rounding_mm = std::min(rounding_mm, 1e-4 * (runs.spacing_mm[k] + 2 * wider[k]));
  for (std::size_t l = 1; l < labels; ++l) {
    std::vector<Corners> triangles;
    if (label_row[l] >= 0)
      for (const std::int32_t t : of_row[label_row[l]]) {
        const auto& v = complex.triangles[t].v;
        const bool below = boundaries.row[t][0] == label_row[l];  // outwards, but for a mirrored grid
        triangles.push_back({points[v[0]], points[v[below ? 1 : 2]], points[v[below ? 2 : 1]]});
      }
    measure_distances(runs, triangles, faces[l], boxes_of_band(runs, bands[l], wider_mm), rounding_mm, options,
                      rows[l - 1]);
  }
  return rows;
}

}  // namespace stackmesh
