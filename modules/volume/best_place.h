#pragma once
#include <functional>
#include <vector>

#include "model/geometry.h"

namespace stackmesh::volume {

/// Three corners of a tet whose first corner is the common point of a fan; positive when seen from it.
struct FanTet {
  Vec3 b, c, d;
};

/// The quality (tet_quality) of the fan's worst tet with its point at p; not looked for further once below `stop`.
double fan_quality(const std::vector<FanTet>& fan, const Vec3& p, double stop);

/// Climbs from p along the common gradient of the fan's worst tets [freitag1997].
/// @param quality of the fan with its point at p (tet_quality of the worst tet); then at the place returned
/// @param enough tets better than it do not count
/// @param allowed places where the point may go; unset: everywhere
Vec3 best_place(const std::vector<FanTet>& fan, Vec3 p, double& quality, double enough,
                const std::function<bool(const Vec3&)>& allowed = {});

}  // namespace stackmesh::volume
