#include "volume/best_place.h"

#include <algorithm>
#include <cmath>

#include "volume/tet_quality.h"

namespace stackmesh::volume {
namespace {

constexpr double kGain = 1e-5;  // what a step must gain at least

/// The point nearest to the origin of the convex hull of `points` (Gilbert's method): a way along which all of the
/// functions grow that these are the gradients of.
Vec3 nearest_to_origin(const std::vector<Vec3>& points) {
  Vec3 x = points.front();
  for (int i = 0; i < 30; ++i) {
    const Vec3* least = &points.front();
    for (const Vec3& p : points)
      if (dot(p, x) < dot(*least, x)) least = &p;
    const double gap = dot(x, x) - dot(*least, x);
    if (gap <= 1e-3 * dot(x, x)) break;
    const Vec3 d = *least - x;
    x = x + std::min(1.0, gap / dot(d, d)) * d;
  }
  return x;
}

double quality_of(const FanTet& t, const Vec3& p) {
  return tet_quality(p, t.b, t.c, t.d);
}

Vec3 gradient(const FanTet& t, const Vec3& p, double h) {
  const auto at = [&](double x, double y, double z) { return quality_of(t, {p.x + x, p.y + y, p.z + z}); };
  return {(at(h, 0, 0) - at(-h, 0, 0)) / (2 * h), (at(0, h, 0) - at(0, -h, 0)) / (2 * h),
          (at(0, 0, h) - at(0, 0, -h)) / (2 * h)};
}

}  // namespace

double fan_quality(const std::vector<FanTet>& fan, const Vec3& p, double stop) {
  double worst = 2;
  for (const FanTet& t : fan) {
    worst = std::min(worst, quality_of(t, p));
    if (worst <= stop) return worst;
  }
  return worst;
}

Vec3 best_place(const std::vector<FanTet>& fan, Vec3 p, double& quality, double enough,
                const std::function<bool(const Vec3&)>& allowed) {
  double size = 1e300;
  for (const FanTet& t : fan)
    for (const Vec3& corner : {t.b, t.c, t.d}) size = std::min(size, norm(corner - p));
  double reach = 0.3 * size;
  std::vector<Vec3> gradients;
  for (int round = 0; round < 12 && quality < enough && reach > 1e-3 * size; ++round) {
    gradients.clear();
    const double close = quality + std::max(0.02, 0.1 * std::abs(quality));
    for (const FanTet& t : fan)
      if (quality_of(t, p) < close) gradients.push_back(gradient(t, p, 1e-5 * size));
    if (gradients.empty()) break;
    const Vec3 way = nearest_to_origin(gradients);
    const double steep = norm(way);
    if (steep * size < 1e-4) break;
    bool moved = false;
    for (int half = 0; half < 5; ++half, reach /= 2) {
      const Vec3 to = p + (reach / steep) * way;
      if (allowed && !allowed(to)) continue;
      const double q = fan_quality(fan, to, quality);
      if (q <= quality + kGain) continue;
      p = to, quality = q;
      moved = true;
      break;
    }
    if (!moved) break;
    reach *= 1.5;
  }
  return p;
}

}  // namespace stackmesh::volume
