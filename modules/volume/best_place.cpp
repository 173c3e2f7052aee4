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

/// Quality of each tet of the fan with its corner at p; stops, with what it has, at one that is not above `stop`.
/// @return the worst
double qualities_at(const std::vector<FanTet>& fan, const Vec3& p, double stop, std::vector<double>& out) {
  double worst = 2;
  out.clear();
  for (const FanTet& t : fan) {
    out.push_back(quality_of(t, p));
    worst = std::min(worst, out.back());
    if (worst <= stop) break;
  }
  return worst;
}

}  // namespace

double fan_quality(const std::vector<FanTet>& fan, const Vec3& p, double stop) {
  std::vector<double> each;
  return qualities_at(fan, p, stop, each);
}

Vec3 best_place(const std::vector<FanTet>& fan, Vec3 p, double& quality, double enough,
                const std::function<bool(const Vec3&)>& allowed) {
  if (quality >= enough) return p;
  double size = 1e300;
  for (const FanTet& t : fan)
    for (const Vec3& corner : {t.b, t.c, t.d}) size = std::min(size, norm(corner - p));
  double reach = 0.3 * size;
  static thread_local std::vector<Vec3> gradients;
  static thread_local std::vector<double> here, there;
  qualities_at(fan, p, -2, here);
  for (int round = 0; round < 12 && quality < enough && reach > 1e-3 * size; ++round) {
    gradients.clear();
    const double close = quality + std::max(0.02, 0.1 * std::abs(quality));
    for (std::size_t i = 0; i < fan.size(); ++i)
      if (here[i] < close) {
        gradients.emplace_back();
        tet_quality(p, fan[i].b, fan[i].c, fan[i].d, &gradients.back());
      }
    if (gradients.empty()) break;
    const Vec3 way = nearest_to_origin(gradients);
    const double steep = norm(way);
    if (steep * size < 1e-4) break;
    bool moved = false;
    for (int half = 0; half < 5; ++half, reach /= 2) {
      const Vec3 to = p + (reach / steep) * way;
      if (allowed && !allowed(to)) continue;
      const double q = qualities_at(fan, to, quality + kGain, there);
      if (q <= quality + kGain) continue;
      p = to, quality = q;
      std::swap(here, there);
      moved = true;
      break;
    }
    if (!moved) break;
    reach *= 1.5;
  }
  return p;
}

}  // namespace stackmesh::volume
