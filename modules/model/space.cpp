#include "model/space.h"

#include <utility>
#include <vector>

#include "base/error.h"

namespace stackmesh {
namespace {

bool turns(Space from, Space to) {
  if (from == Space::stack || to == Space::stack)
    fail_internal("stack coordinates were taken for those of the world", "frames");
  return (from == Space::ras) != (to == Space::ras);
}

/// @return whether the map mirrors
bool change(std::vector<Vec3>& points, std::vector<InterfaceTriangle>& triangles, Space& space, Space to,
            const Frame& frame) {
  bool mirrors = false;
  if (space == Space::stack && to != Space::stack) {
    for (Vec3& p : points) p = frame.to_world(p);
    mirrors = frame.mirrors();
    space = frame.world;
  }
  if (mirrors)
    for (InterfaceTriangle& t : triangles) std::swap(t.v[1], t.v[2]);
  if (space == to) return mirrors;
  if (turns(space, to))
    for (Vec3& p : points) p = in_space(p, space, to);
  space = to;
  return mirrors;
}

}  // namespace

Vec3 in_space(Vec3 p, Space from, Space to) {
  return turns(from, to) ? Vec3{-p.x, -p.y, p.z} : p;
}

Frame between(Space from, Space to) {
  Frame f;
  for (Vec3& axis : f.axes) axis = in_space(axis, from, to);
  f.world = to;
  return f;
}

void change_space(InterfaceComplex& complex, Space to, const Frame& frame) {
  change(complex.points, complex.triangles, complex.space, to, frame);
}

void change_space(TetMesh& mesh, Space to, const Frame& frame) {
  if (change(mesh.points, mesh.faces, mesh.space, to, frame)) turn_all_round(mesh);
}

}  // namespace stackmesh
