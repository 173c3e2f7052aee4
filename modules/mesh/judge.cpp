#include "mesh/judge.h"

#include "model/space.h"

namespace stackmesh {

Judgement judge(const InterfaceComplex& surface, const Frame& frame, int threads) {
  Judgement j;
  j.world = surface;
  change_space(j.world, frame.world, frame);
  SurfaceCheckOptions check;
  check.threads = threads;
  j.check = check_surface(j.world, check);
  return j;
}

}  // namespace stackmesh
