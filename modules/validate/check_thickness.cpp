#include "validate/check_thickness.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "validate/box_tree.h"

namespace stackmesh {
namespace {

/// Where the ray meets the triangle, in lengths of `along`; infinite where it does not.
double meets(const Vec3& from, const Vec3& along, const Vec3& a, const Vec3& b, const Vec3& c) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const Vec3 u = b - a, v = c - a, p = cross(along, v);
  const double det = dot(u, p);
  if (det == 0) return kNever;
  const Vec3 s = from - a;
  const double x = dot(s, p) / det;
  if (x < -1e-9 || x > 1 + 1e-9) return kNever;
  const Vec3 q = cross(s, u);
  const double y = dot(along, q) / det;
  if (y < -1e-9 || x + y > 1 + 1e-9) return kNever;
  return dot(v, q) / det;
}

struct Seen {
  double thickness_mm, area_mm2, edge_mm;
  Vec3 where;
};

}  // namespace

std::vector<LabelThickness> check_thickness(const InterfaceComplex& complex, const ThicknessOptions& options) {
  std::vector<Label> labels;
  for (const InterfaceTriangle& t : complex.triangles)
    for (const Label l : {t.below, t.above})
      if (l != 0 && t.below != t.above && (labels.empty() || labels.back() != l)) labels.push_back(l);
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  std::vector<Box> boxes(complex.triangles.size());
  for (std::size_t t = 0; t < boxes.size(); ++t)
    for (const std::int32_t v : complex.triangles[t].v) boxes[t].add(complex.points[v]);
  const BoxTree tree(boxes);
  std::vector<std::vector<std::int32_t>> of_label(labels.size());  // 2 * triangle + (1: above)
  for (std::size_t t = 0; t < complex.triangles.size(); ++t)
    for (int side = 0; side < 2; ++side) {
      const InterfaceTriangle& triangle = complex.triangles[t];
      const Label l = side == 0 ? triangle.below : triangle.above;
      if (l == 0 || triangle.below == triangle.above) continue;
      of_label[std::lower_bound(labels.begin(), labels.end(), l) - labels.begin()].push_back(
          static_cast<std::int32_t>(2 * t) + side);
    }
  std::vector<LabelThickness> rows;
  for (std::size_t l = 0; l < labels.size(); ++l) {
    const std::vector<std::int32_t>& sides = of_label[l];
    const std::size_t stride = std::max<std::size_t>(1, (sides.size() + options.samples - 1) / options.samples);
    std::vector<Seen> seen((sides.size() + stride - 1) / stride, Seen{0, 0, 0, {}});
    constexpr std::size_t kChunk = 256;
    parallel_for((seen.size() + kChunk - 1) / kChunk, options.threads, [&](std::size_t chunk) {
      for (std::size_t i = chunk * kChunk; i < std::min(seen.size(), (chunk + 1) * kChunk); ++i) {
        const std::int32_t side = sides[i * stride];
        const auto& v = complex.triangles[side / 2].v;
        const Vec3 a = complex.points[v[0]], b = complex.points[v[1]], c = complex.points[v[2]];
        const Vec3 n = cross(b - a, c - a);
        const double twice = norm(n);
        if (!(twice > 0)) continue;
        const Vec3 from = (1.0 / 3) * (a + b + c), inwards = ((side % 2 == 0 ? -1 : 1) / twice) * n;
        double nearest = std::numeric_limits<double>::infinity();
        tree.along_ray(from, inwards, nearest, [&](std::int32_t t, double* reach) {
          if (t == side / 2) return;
          const auto& w = complex.triangles[t].v;
          const double at = meets(from, inwards, complex.points[w[0]], complex.points[w[1]], complex.points[w[2]]);
          if (at > 0 && at < *reach) *reach = nearest = at;
        });
        if (std::isinf(nearest)) continue;  // the surface is open
        seen[i] = {nearest, 0.5 * twice, (norm(b - a) + norm(c - b) + norm(a - c)) / 3, from};
      }
    });
    LabelThickness row;
    row.label = labels[l];
    double area = 0, thin = 0, least = std::numeric_limits<double>::infinity();
    for (const Seen& s : seen) {
      if (s.area_mm2 == 0) continue;
      area += s.area_mm2;
      if (s.thickness_mm < options.elements * s.edge_mm) thin += s.area_mm2;
      if (s.thickness_mm / s.edge_mm < least)
        least = s.thickness_mm / s.edge_mm, row.thinnest = s.where, row.thinnest_mm = s.thickness_mm;
    }
    if (area > 0) row.thin_share = thin / area;
    std::sort(seen.begin(), seen.end(), [](const Seen& x, const Seen& y) { return x.thickness_mm < y.thickness_mm; });
    double passed = 0;
    for (const Seen& s : seen) {
      passed += s.area_mm2;
      row.p5_mm = s.thickness_mm;
      if (passed >= 0.05 * area && passed > 0) break;
    }
    rows.push_back(row);
  }
  return rows;
}

}  // namespace stackmesh
