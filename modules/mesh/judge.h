#pragma once
// Private to the module: a surface in the coordinates that are handed out, and what the exact checks say of it.
#include "model/complex.h"
#include "model/geometry.h"
#include "validate/check_surface.h"

namespace stackmesh {

struct Judgement {
  InterfaceComplex world;
  SurfaceCheck check;
  bool is_sound() const { return check.open_edges == 0 && check.self_intersections == 0; }
};

/// @param surface in stack coordinates
Judgement judge(const InterfaceComplex& surface, const Frame& frame, int threads);

}  // namespace stackmesh
