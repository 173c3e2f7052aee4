#include "volume/tetgen_call.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace stackmesh::volume {
namespace {

double median(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.10g", v);
  return text;
}

double z_scale_for_aspect(const InterfaceComplex& complex) {
  std::vector<double> steps, edges;
  for (const InterfaceTriangle& t : complex.triangles) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 d = complex.points[t.v[(k + 1) % 3]] - complex.points[t.v[k]];
      if (d.z != 0) steps.push_back(std::abs(d.z));
      if (d.x != 0 || d.y != 0) edges.push_back(std::hypot(d.x, d.y));
    }
  }
  const double step = median(steps), edge = median(edges);
  if (step <= 0 || edge <= 0) return 1;
  const double ratio = step / edge;
  if (ratio <= 16 && ratio >= 1.0 / 16) return 1;
  return std::ldexp(1.0, -static_cast<int>(std::lround(std::log2(ratio))));
}

Vec3 turned(Vec3 p, int turns) {
  for (int i = 0; i < turns; ++i) p = {p.y, p.z, p.x};
  return p;
}

std::string describe(const TetgenCall& call, const std::string& switches) {
  return "TetGen -" + switches + (call.z_scale == 1 ? "" : " with z scaled by " + number(call.z_scale)) +
         (call.turns == 0 ? "" : " with the axes turned " + std::string(call.turns == 1 ? "once" : "twice"));
}

std::string switches(const TetgenCall& call, const FillOptions& options, const std::optional<double>& max_volume_mm3) {
  std::string s = "p";
  if (call.refine) {
    // A volume bound alone refines too: TetGen's own ratio of 2, no dihedral bound.
    s += "q" + number(options.radius_edge.value_or(2));
    if (options.dihedral_deg) s += "/" + number(*options.dihedral_deg);
    if (has_sizes(call, options, max_volume_mm3)) s += "m";
    if (max_volume_mm3) s += "a" + number(*max_volume_mm3 * call.z_scale);
  }
  // Y keeps the surface; M keeps TetGen from merging points closer than its tolerance, which would make
  // features thinner than 1e-8 of the box intersect themselves.
  return s + "YM" + call.tolerance;
}

bool has_sizes(const TetgenCall& call, const FillOptions& options, const std::optional<double>& max_volume_mm3) {
  return call.refine && options.inner_growth && !max_volume_mm3 && call.z_scale == 1;
}

std::vector<double> inner_sizes(const Compact& part, double growth) {
  constexpr double kTetGensOwn = 0.85;
  std::vector<double> sum(part.points.size(), 0), count(part.points.size(), 0);
  for (std::size_t i = 0; i < part.corners.size(); ++i) {
    const std::int32_t a = part.corners[i], b = part.corners[i % 3 == 2 ? i - 2 : i + 1];
    const double length = norm(part.points[b] - part.points[a]);
    for (const std::int32_t v : {a, b}) sum[v] += length, count[v] += 1;
  }
  for (std::size_t p = 0; p < sum.size(); ++p) sum[p] *= kTetGensOwn * growth / count[p];
  return sum;
}

}  // namespace stackmesh::volume
