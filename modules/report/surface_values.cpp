#include "report/surface_values.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace stackmesh {
namespace {

std::array<double, 3> key(Vec3 p) {
  return {p.x + 0.0, p.y + 0.0, p.z + 0.0};
}  // -0 is 0

std::array<Vec3, 3> sorted(std::array<Vec3, 3> corners) {
  std::sort(corners.begin(), corners.end(), [](Vec3 a, Vec3 b) { return key(a) < key(b); });
  return corners;
}

using Key = std::array<std::array<double, 3>, 3>;
Key key(const std::array<Vec3, 3>& c) {
  return {key(c[0]), key(c[1]), key(c[2])};
}

std::uint8_t step(double share) {
  return static_cast<std::uint8_t>(1 + std::lround(254 * std::clamp(share, 0.0, 1.0)));
}

/// Of each element, MPa; empty where the materials only hold the place.
std::vector<double> moduli_of(const SolverModel& model) {
  const SolverSets& sets = model.sets;
  std::vector<double> modulus = sets.modulus_mpa;
  if (modulus.empty() && !sets.placeholder_materials) {
    modulus.assign(model.mesh.elements(), 0);
    for (const ElementMaterial& m : sets.materials)
      for (const std::int32_t t : m.tets) modulus[t] = m.young_mpa;
  }
  return modulus;
}

/// The stress that 99.5 % of the nodes keep below: a few nodes at the end of a support must not make the rest pale.
double high_stress(const std::vector<double>& mises_mpa) {
  std::vector<double> order = mises_mpa;
  const auto at = order.begin() + static_cast<std::ptrdiff_t>(std::ceil(0.995 * static_cast<double>(order.size()))) - 1;
  std::nth_element(order.begin(), at, order.end());
  return *at;
}

/// The sets of faces, the largest first, at most 250.
std::vector<const FaceSet*> by_falling_size(const SolverSets& sets) {
  std::vector<const FaceSet*> by_size;
  for (const FaceSet& s : sets.surfaces) by_size.push_back(&s);
  std::stable_sort(by_size.begin(), by_size.end(),
                   [](const FaceSet* a, const FaceSet* b) { return a->faces.size() > b->faces.size(); });
  if (by_size.size() > 250) by_size.erase(by_size.begin(), by_size.end() - 250);
  return by_size;
}

std::array<std::int32_t, 3> corner_nodes(const TetMesh& mesh, TetFace f) {
  const auto element = static_cast<std::size_t>(f.tet);
  std::array<std::int32_t, 3> nodes;
  for (int k = 0; k < 3; ++k)
    nodes[k] = mesh.is_wedge(element) ? mesh.wedges[element - mesh.tets.size()][kWedgeFaces[f.face][k]]
                                      : mesh.tets[element][kTetFaces[f.face][k]];
  return nodes;
}

}  // namespace

SurfaceValues surface_values(const SolverModel& model, const std::vector<double>& mises_mpa) {
  const SolverSets& sets = model.sets;
  SurfaceValues out;
  std::set<std::string> held, loaded;
  for (const LoadStep& s : sets.steps) {
    for (const Support& support : s.supports) held.insert(support.set);
    for (const Pressure& p : s.pressures) loaded.insert(p.set);
  }
  // Forces have become nodal ones: a face is loaded where all of its nodes are.
  std::vector<char> pushed(model.mesh.points.size(), 0), kept(model.mesh.points.size(), 0);
  for (const LoadStep& s : sets.steps)
    for (const auto& [node, force] : s.forces_n) pushed[node] = 1;
  for (const NodeSet& n : sets.node_sets)
    if (held.count(n.name) > 0)
      for (const std::int32_t v : n.nodes) kept[v] = 1;

  const std::vector<double> modulus = moduli_of(model);
  for (const double e : modulus)
    if (e > 0) {
      out.modulus_low_mpa = out.modulus_low_mpa > 0 ? std::min(out.modulus_low_mpa, e) : e;
      out.modulus_high_mpa = std::max(out.modulus_high_mpa, e);
    }
  if (!mises_mpa.empty()) out.mises_high_mpa = high_stress(mises_mpa);

  // A face shows the smallest set that it is in: the larger ones are seen around it.
  std::map<Key, std::size_t> place;
  for (const FaceSet* s : by_falling_size(sets)) {
    out.sets.push_back(s->name);
    for (const TetFace f : s->faces) {
      const std::array<std::int32_t, 3> nodes = corner_nodes(model.mesh, f);
      const std::array<Vec3, 3> corners =
          sorted({model.mesh.points[nodes[0]], model.mesh.points[nodes[1]], model.mesh.points[nodes[2]]});
      const auto [at, fresh] = place.insert({key(corners), out.values.size()});
      if (fresh) {
        out.corners.push_back(corners);
        TriangleValues v;
        const auto all = [&](const std::vector<char>& of) { return of[nodes[0]] && of[nodes[1]] && of[nodes[2]]; };
        if (all(kept)) v.acts |= 1;
        if (!modulus.empty() && modulus[f.tet] > 0)
          v.modulus =
              step(out.modulus_high_mpa > out.modulus_low_mpa ? std::log(modulus[f.tet] / out.modulus_low_mpa) /
                                                                    std::log(out.modulus_high_mpa / out.modulus_low_mpa)
                                                              : 1);
        if (out.mises_high_mpa > 0)
          v.mises = step((mises_mpa[nodes[0]] + mises_mpa[nodes[1]] + mises_mpa[nodes[2]]) / 3 / out.mises_high_mpa);
        out.values.push_back(v);
      }
      TriangleValues& v = out.values[at->second];
      v.set = static_cast<std::uint8_t>(out.sets.size());
      const auto mids_pushed = [&] {  // of second order, corners of a plane face bear nothing
        if (model.mesh.mid.empty()) return pushed[nodes[0]] && pushed[nodes[1]] && pushed[nodes[2]];
        const auto face = outward_face_of(model.mesh, f);
        for (int k = 3; k < 6; ++k)
          if (!pushed[face[k]]) return false;
        return true;
      };
      if (loaded.count(s->name) > 0 || mids_pushed()) v.acts |= 2;
    }
  }
  return out;
}

std::vector<TriangleValues> values_on(const InterfaceComplex& surface, const SurfaceValues& values) {
  std::map<Key, std::size_t> place;
  for (std::size_t i = 0; i < values.corners.size(); ++i) place[key(values.corners[i])] = i;
  std::vector<TriangleValues> out(surface.triangles.size());
  std::size_t found = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& v = surface.triangles[t].v;
    const auto at = place.find(key(sorted({surface.points[v[0]], surface.points[v[1]], surface.points[v[2]]})));
    if (at == place.end()) continue;
    out[t] = values.values[at->second];
    ++found;
  }
  return 2 * found >= surface.triangles.size() ? out : std::vector<TriangleValues>();
}

}  // namespace stackmesh
