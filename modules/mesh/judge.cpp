#include "mesh/judge.h"

#include <utility>

namespace stackmesh {

void to_world(std::vector<Vec3>& points, std::vector<InterfaceTriangle>& triangles, const Frame& frame) {
  for (Vec3& p : points) p = frame.to_world(p);
  if (frame.mirrors())
    for (InterfaceTriangle& t : triangles) std::swap(t.v[1], t.v[2]);
}

Judgement judge(const InterfaceComplex& surface, const Frame& frame, int threads) {
  Judgement j;
  j.world = surface;
  to_world(j.world.points, j.world.triangles, frame);
  SurfaceCheckOptions check;
  check.threads = threads;
  j.check = check_surface(j.world, check);
  return j;
}

}  // namespace stackmesh
