#include "report/histograms.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "report/shape.h"

namespace stackmesh {
namespace {

constexpr std::size_t kChunk = 1 << 14;

/// `values` is reordered.
Histogram count(const std::string& name, const std::string& title, const std::string& unit, double low, double high,
                std::size_t bins, std::vector<float>& values) {
  Histogram h{name, title, unit, low, high, std::vector<std::size_t>(bins, 0), values.size()};
  for (const float x : values)
    ++h.counts[static_cast<std::size_t>(
        std::clamp((x - low) / (high - low) * static_cast<double>(bins), 0.0, static_cast<double>(bins) - 1))];
  if (values.empty()) return h;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  h.smallest = *least, h.largest = *most;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  h.median = *middle;
  return h;
}

/// A round number no less than the value that a share of 0.2 % of the values pass.
double round_top(std::vector<float>& values) {
  if (values.empty()) return 1;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.998 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  const double top = *at;
  if (!(top > 0)) return 1;
  const double decade = std::pow(10, std::floor(std::log10(top)));
  for (const double step : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0})
    if (step * decade >= top) return step * decade;
  return 10 * decade;
}

}  // namespace

std::vector<Histogram> make_histograms(const InterfaceComplex& complex, const TetMesh* mesh,
                                       const std::vector<float>& distances_mm, int threads) {
  std::vector<Histogram> all;
  const std::size_t triangles = complex.triangles.size();
  std::vector<float> angles(3 * triangles), edges;
  parallel_for((triangles + kChunk - 1) / kChunk, threads, [&](std::size_t chunk) {
    for (std::size_t t = chunk * kChunk; t < std::min(triangles, (chunk + 1) * kChunk); ++t) {
      const auto& v = complex.triangles[t].v;
      const auto of_corners = triangle_angles_deg(complex.points[v[0]], complex.points[v[1]], complex.points[v[2]]);
      for (int k = 0; k < 3; ++k) angles[3 * t + k] = static_cast<float>(of_corners[k]);
    }
  });
  all.push_back(count("angles", "Angles of surface triangles", "degrees", 0, 180, 36, angles));

  if (mesh != nullptr) {
    std::vector<float> dihedrals(6 * mesh->tets.size());
    parallel_for((mesh->tets.size() + kChunk - 1) / kChunk, threads, [&](std::size_t chunk) {
      for (std::size_t t = chunk * kChunk; t < std::min(mesh->tets.size(), (chunk + 1) * kChunk); ++t) {
        const auto& v = mesh->tets[t];
        const auto cosines =
            dihedral_cosines(mesh->points[v[0]], mesh->points[v[1]], mesh->points[v[2]], mesh->points[v[3]]);
        for (int k = 0; k < 6; ++k)
          dihedrals[6 * t + k] =
              static_cast<float>(57.295779513082320877 * std::acos(std::clamp(cosines[k], -1.0, 1.0)));
      }
    });
    all.push_back(count("dihedrals", "Dihedral angles of tetrahedra", "degrees", 0, 180, 36, dihedrals));
  }

  // Each edge once, by the numbers of its ends.
  std::vector<std::uint64_t> names;
  names.reserve(3 * triangles);
  for (const InterfaceTriangle& t : complex.triangles)
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(t.v[k], t.v[(k + 1) % 3]);
      names.push_back(static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32 | static_cast<std::uint32_t>(b));
    }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  for (const std::uint64_t name : names)
    edges.push_back(static_cast<float>(norm(complex.points[name >> 32] - complex.points[name & 0xffffffffu])));
  const double longest = round_top(edges);
  all.push_back(count("edges", "Edge lengths of the surface", "mm", 0, longest, 30, edges));

  if (!distances_mm.empty()) {
    std::vector<float> distances = distances_mm;
    const double farthest = round_top(distances);
    all.push_back(count("distances", "Distances of surface vertices to the labels' voxel boundary", "mm", 0, farthest,
                        30, distances));
  }
  return all;
}

}  // namespace stackmesh
