#include "mesh/voids.h"

#include "base/error.h"

namespace stackmesh {

Hollowed hollowed(const InterfaceComplex& complex, const std::set<Label>& voids) {
  Hollowed out;
  out.complex.points = complex.points;
  out.complex.space = complex.space;
  for (std::size_t i = 0; i < complex.triangles.size(); ++i) {
    InterfaceTriangle t = complex.triangles[i];
    Label behind = 0;
    for (Label* side : {&t.below, &t.above})
      if (voids.count(*side) > 0) behind = *side, *side = 0;
    if (t.below == t.above) continue;
    out.complex.triangles.push_back(t);
    out.original.push_back(static_cast<std::int32_t>(i));
    out.behind.push_back(behind);
  }
  return out;
}

void name_voids(std::vector<InterfaceTriangle>& triangles, const std::vector<Label>& behind) {
  if (behind.empty()) return;
  if (triangles.size() % behind.size() != 0)
    fail_internal("the mesh does not have the triangles that it was filled from", "voids");
  const std::size_t parts = triangles.size() / behind.size();
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (const Label l = behind[i / parts]; l != 0)
      (triangles[i].below == 0 ? triangles[i].below : triangles[i].above) = l;
}

}  // namespace stackmesh
