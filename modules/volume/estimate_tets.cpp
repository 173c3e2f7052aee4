#include <algorithm>
#include <cmath>

#include "volume/fill_volume.h"
#include "volume/label_tets.h"

namespace stackmesh {

double estimate_tets(const InterfaceComplex& complex, const FillOptions& options) {
  double edges = 0, volume = 0, sides = 0;
  for (const InterfaceTriangle& t : complex.triangles) {
    if (t.below == t.above) continue;
    const Vec3 &a = complex.points[t.v[0]], &b = complex.points[t.v[1]], &c = complex.points[t.v[2]];
    const double own = (t.below != 0) + (t.above != 0);
    sides += own;
    edges += own * (norm(b - a) + norm(c - b) + norm(a - c)) / 3;
  }
  const auto volumes = volume::surface_volumes(complex);
  for (const auto& [label, v] : volumes) volume += std::abs(v.mm3);
  if (sides == 0) return 0;
  const double edge = edges / sides * options.inner_growth.value_or(4);
  double tets = 1.5 * sides + volume / (0.12 * edge * edge * edge);
  if (options.max_volume_mm3) tets = std::max(tets, 1.5 * volume / *options.max_volume_mm3);
  double bounded = 0;
  for (const auto& [label, v] : volumes)
    if (const auto own = options.label_max_volume_mm3.find(label); own != options.label_max_volume_mm3.end())
      bounded += 1.5 * std::abs(v.mm3) / own->second;
  tets = std::max(tets, bounded);
  return tets;
}

double thickness_in_edges(const InterfaceComplex& complex) {
  double edges = 0, enclosed = 0;
  for (const InterfaceTriangle& t : complex.triangles) {
    const Vec3 &a = complex.points[t.v[0]], &b = complex.points[t.v[1]], &c = complex.points[t.v[2]];
    const double own = 0.5 * ((t.below != 0) + (t.above != 0)) * norm(cross(b - a, c - a));
    edges += own * (norm(b - a) + norm(c - b) + norm(a - c)) / 3;
  }
  for (const auto& [label, v] : volume::surface_volumes(complex)) enclosed += std::abs(v.mm3);
  return edges > 0 ? 2 * enclosed / edges : 0;
}

}  // namespace stackmesh
