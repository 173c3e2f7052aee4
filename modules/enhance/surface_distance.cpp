#include "enhance/surface_distance.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "enhance/reference.h"

namespace stackmesh {

SurfaceSamples sample_surface(const ComplexMesh& mesh, std::size_t count) {
  const auto counts = [&](const MeshTriangle& t) { return t.patch >= 0 && !mesh.is_cap(t.patch); };
  double area = 0;
  for (const MeshTriangle& t : mesh.triangles)
    if (counts(t)) area += norm(mesh.area_vector(t.v));
  SurfaceSamples out;
  const double each = area / static_cast<double>(std::max<std::size_t>(1, count));
  if (!(each > 0)) return out;
  double due = 0.5 * each;
  for (const MeshTriangle& t : mesh.triangles) {
    if (!counts(t)) continue;
    const double a = norm(mesh.area_vector(t.v));
    due += a;
    const int here = static_cast<int>(due / each);
    due -= here * each;
    // The points of a sequence that fills the triangle evenly.
    double u = 0.5, w = 0.5;
    for (int i = 0; i < here; ++i) {
      u = std::fmod(u + 0.7548776662466927, 1.0);
      w = std::fmod(w + 0.5698402909980532, 1.0);
      const bool over = u + w > 1;
      const double x = over ? 1 - u : u, y = over ? 1 - w : w;
      const Vec3 &p = mesh.points[t.v[0]], &q = mesh.points[t.v[1]], &r = mesh.points[t.v[2]];
      out.points.push_back(p + x * (q - p) + y * (r - p));
      out.patches.push_back(t.patch);
    }
  }
  return out;
}

double mean_distance(const SurfaceSamples& samples, const ComplexMesh& mesh, double reach_mm, int threads) {
  if (samples.points.empty()) return 0;
  const Reference now(mesh, reach_mm, threads);
  std::vector<double> off(samples.points.size());
  constexpr std::size_t kRun = 256;
  parallel_for((off.size() + kRun - 1) / kRun, threads, [&](std::size_t run) {
    std::int32_t hint = -1;
    for (std::size_t i = run * kRun; i < std::min(off.size(), (run + 1) * kRun); ++i) {
      const auto foot = now.nearest(samples.points[i], samples.patches[i], reach_mm, hint, 0.1 * reach_mm);
      if (foot) hint = foot->face;
      off[i] = foot ? foot->distance_mm : reach_mm;
    }
  });
  double sum = 0;
  for (double d : off) sum += d;
  return sum / static_cast<double>(off.size());
}

double distance_gained(ComplexMesh& mesh, const SurfaceSamples& samples, std::vector<Vec3> places, double reach_mm,
                       int threads) {
  const double before = mean_distance(samples, mesh, reach_mm, threads);
  std::swap(mesh.points, places);
  const double after = mean_distance(samples, mesh, reach_mm, threads);
  std::swap(mesh.points, places);
  return after - before;
}

}  // namespace stackmesh
