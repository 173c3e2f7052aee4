#include "run/turn_as_a_whole.h"

#include <algorithm>
#include <map>

#include "meshio/read_mesh.h"
#include "validate/exact.h"

namespace stackmesh {
namespace {

void swap_corners(std::vector<InterfaceTriangle>& triangles) {
  for (InterfaceTriangle& t : triangles) std::swap(t.v[1], t.v[2]);
}

std::array<std::int32_t, 3> sorted(std::array<std::int32_t, 3> v) {
  std::sort(v.begin(), v.end());
  return v;
}

/// Whether most triangles run against those of the same corners in `others`.
bool run_against(const std::vector<InterfaceTriangle>& triangles, const std::vector<InterfaceTriangle>& others) {
  std::map<std::array<std::int32_t, 3>, const InterfaceTriangle*> known;
  for (const InterfaceTriangle& t : others) known[sorted(t.v)] = &t;
  std::size_t against = 0, with = 0;
  for (const InterfaceTriangle& t : triangles) {
    const auto it = known.find(sorted(t.v));
    if (it == known.end()) continue;
    const auto& w = it->second->v;
    const std::size_t at = static_cast<std::size_t>(std::find(w.begin(), w.end(), t.v[0]) - w.begin());
    const bool same = (w[(at + 1) % 3] == t.v[1]) == (it->second->below == t.below);
    (same ? with : against) += 1;
  }
  return against > with;
}

bool faces_inwards(const InterfaceComplex& surface) {
  double volume = 0;
  const Vec3 o = surface.points.empty() ? Vec3{} : surface.points[0];
  for (const InterfaceTriangle& t : surface.triangles) {
    const Vec3 a = surface.points[t.v[0]] - o, b = surface.points[t.v[1]] - o, c = surface.points[t.v[2]] - o;
    const double part = dot(a, cross(b, c)) / 6;
    volume += (t.below != 0 ? part : 0) - (t.above != 0 ? part : 0);
  }
  return volume < 0;
}

}  // namespace

std::vector<std::string> turn_as_a_whole(InterfaceComplex& surface, TetMesh& tets, bool has_faces) {
  std::vector<std::string> notes;
  if (tets.elements() == 0) {
    if (!faces_inwards(surface)) return notes;
    swap_corners(surface.triangles);
    return {"the triangles face inwards, as in a mirrored frame: all were turned round"};
  }
  std::size_t negative = 0, positive = 0;
  for (const auto& t : tets.tets) {
    const int sign = exact_orientation(tets.points[t[0]], tets.points[t[1]], tets.points[t[2]], tets.points[t[3]]);
    negative += sign<0, positive += sign> 0;
  }
  if (negative > positive) {
    for (std::size_t t = 0; t < tets.tets.size(); ++t) turn_round(tets, t);
    notes.push_back("most tetrahedra (" + std::to_string(negative) + " of " + std::to_string(tets.tets.size()) +
                    ") number their nodes the other way round, as a mirrored frame does; all were turned, and the rest "
                    "counts as inverted");
  }
  surface.points = tets.points;
  surface.triangles = faces_of_tets(tets);
  if (!has_faces) {
    tets.faces = surface.triangles;
  } else if (run_against(tets.faces, surface.triangles)) {
    swap_corners(tets.faces);
    notes.push_back(
        "the interface triangles run against the tetrahedra, as in a mirrored frame: all were turned round");
  }
  return notes;
}

}  // namespace stackmesh
