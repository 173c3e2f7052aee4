#include "enhance/expected_tets.h"

#include <cmath>

#include "enhance/sizing.h"

namespace stackmesh {
namespace {

// Measured: 1.9 tetrahedra a triangle in a thin skull, 3 to 4 in a heart, 9.5 in lungs with fine triangles.
constexpr double kTetsOfLayer = 1.7, kTetsOfDepth = 0.38;

}  // namespace

double ExpectedTets::times_longer_for(double target) const {
  double low = 0.01, high = 100;
  for (int step = 0; step < 40; ++step) {
    const double middle = std::sqrt(low * high);
    (at(middle) > target ? low : high) = middle;
  }
  return high;
}

ExpectedTets expected_tets(const ComplexMesh& mesh, const std::vector<double>& size,
                           const std::map<Label, double>& volumes_mm3) {
  const std::size_t labels = mesh.labels().size();
  std::vector<double> area(labels, 0), triangles(labels, 0);
  for (const MeshTriangle& t : mesh.triangles) {
    if (t.patch < 0) continue;
    const double l = (size[t.v[0]] + size[t.v[1]] + size[t.v[2]]) / 3, a = norm(mesh.area_vector(t.v));
    for (std::int32_t side : mesh.sides(t.patch)) {
      area[side] += a;
      triangles[side] += a / (kTriangleArea * l * l);
    }
  }
  ExpectedTets out;
  for (std::size_t i = 0; i < labels; ++i) {
    const auto v = volumes_mm3.find(mesh.labels()[i]);
    if (v == volumes_mm3.end() || !(area[i] > 0)) continue;
    const double l = std::sqrt(area[i] / (kTriangleArea * triangles[i]));
    out.layer += kTetsOfLayer * triangles[i];
    out.depth += kTetsOfDepth * triangles[i] * v->second / (area[i] * l);
  }
  return out;
}

}  // namespace stackmesh
