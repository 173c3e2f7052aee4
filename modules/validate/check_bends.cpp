#include "validate/check_bends.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "validate/boundaries.h"
#include "validate/statistics.h"

namespace stackmesh {
namespace {

constexpr double kSharp_deg = 40;

struct Sum {
  std::size_t edges = 0, sharp = 0;
  double length = 0, bend = 0;

  void add(double deg, double length_mm) {
    ++edges, sharp += deg > kSharp_deg;
    length += length_mm, bend += deg * length_mm;
  }
  Bends bends() const {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    if (edges == 0 || !(length > 0)) return {edges, kNaN, kNaN};
    return {edges, bend / length, static_cast<double>(sharp) / static_cast<double>(edges)};
  }
};

}  // namespace

BendCheck check_bends(const InterfaceComplex& complex, int threads) {
  const Boundaries boundaries = find_boundaries(complex, 0, true);
  const std::vector<Neighbours>& neighbours = boundaries.neighbours;
  const auto normal = [&](std::int32_t side) {  // out of the label, to a factor
    const auto& v = complex.triangles[side / 2].v;
    const Vec3& a = complex.points[v[0]];
    const Vec3 n = cross(complex.points[v[1]] - a, complex.points[v[2]] - a);
    return side % 2 == 0 ? n : -1 * n;
  };
  std::vector<double> bend_deg(neighbours.size(), -1);
  constexpr std::size_t kChunk = 1 << 14;
  parallel_for((neighbours.size() + kChunk - 1) / kChunk, threads, [&](std::size_t chunk) {
    for (std::size_t k = chunk * kChunk; k < std::min(neighbours.size(), (chunk + 1) * kChunk); ++k) {
      Vec3 m = normal(neighbours[k].side), n = normal(neighbours[k].other);
      const double lm = norm(m), ln = norm(n);
      if (!(lm > 0) || !(ln > 0)) continue;
      m = (1 / lm) * m, n = (1 / ln) * n;
      bend_deg[k] = kDegrees * std::atan2(norm(cross(m, n)), dot(m, n));
    }
  });
  Sum all;
  std::vector<Sum> of_row(boundaries.labels.size());
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    if (bend_deg[k] < 0) continue;
    const double length = boundaries.edge_lengths_mm[neighbours[k].edge];
    of_row[neighbours[k].row].add(bend_deg[k], length);
    if (neighbours[k].first) all.add(bend_deg[k], length);
  }
  BendCheck check;
  check.surface = all.bends();
  for (std::size_t row = 0; row < of_row.size(); ++row)
    check.labels.push_back({boundaries.labels[row].label, of_row[row].bends()});
  return check;
}

}  // namespace stackmesh
