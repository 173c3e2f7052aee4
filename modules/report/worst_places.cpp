#include "report/worst_places.h"

#include <algorithm>
#include <cmath>

#include "report/shape.h"

namespace stackmesh {
namespace {

/// Bad first; equal figures by number.
struct Candidate {
  double badness;
  std::int32_t number;
};

/// Takes from the worst on, leaving out what is close to one taken before.
template <class Place>
std::vector<std::int32_t> take_apart(std::vector<Candidate> candidates, std::size_t most, double apart_mm,
                                     Place place) {
  // A few hundred times as many as are wanted suffice, unless nearly all of them are neighbours.
  const std::size_t looked_at = std::min(candidates.size(), 400 * most);
  const auto worse = [](const Candidate& a, const Candidate& b) {
    return a.badness != b.badness ? a.badness > b.badness : a.number < b.number;
  };
  std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(looked_at), candidates.end(),
                    worse);
  std::vector<std::int32_t> taken;
  for (std::size_t i = 0; i < looked_at && taken.size() < most; ++i) {
    const Vec3 p = place(candidates[i].number);
    if (std::none_of(taken.begin(), taken.end(), [&](std::int32_t t) { return norm(place(t) - p) < apart_mm; }))
      taken.push_back(candidates[i].number);
  }
  return taken;
}

}  // namespace

std::vector<WorstPlace> find_worst_places(const InterfaceComplex& complex, const TetMesh* mesh,
                                          const std::vector<float>& distances_mm, std::size_t most, double apart_mm) {
  std::vector<WorstPlace> places;
  const std::vector<Vec3>& points = complex.points;
  std::vector<Candidate> candidates;
  const auto angle = [&](std::int32_t t) {
    const auto& v = complex.triangles[t].v;
    const auto angles = triangle_angles_deg(points[v[0]], points[v[1]], points[v[2]]);
    return std::min({angles[0], angles[1], angles[2]});
  };
  for (std::size_t t = 0; t < complex.triangles.size(); ++t)
    candidates.push_back({-angle(static_cast<std::int32_t>(t)), static_cast<std::int32_t>(t)});
  const auto centre = [&](std::int32_t t) {
    const auto& v = complex.triangles[t].v;
    return (1.0 / 3) * (points[v[0]] + points[v[1]] + points[v[2]]);
  };
  for (const std::int32_t t : take_apart(std::move(candidates), most, apart_mm, centre)) {
    const InterfaceTriangle& f = complex.triangles[t];
    places.push_back(
        {"angle", angle(t), centre(t), {points[f.v[0]], points[f.v[1]], points[f.v[2]]}, {f.below, f.above}});
  }
  if (mesh != nullptr) {
    candidates.clear();
    const auto corner = [&](std::int32_t t, int k) { return mesh->points[mesh->tets[t][k]]; };
    const auto cosine = [&](std::int32_t t) {
      const auto cosines = dihedral_cosines(corner(t, 0), corner(t, 1), corner(t, 2), corner(t, 3));
      return *std::max_element(cosines.begin(), cosines.end());
    };
    for (std::size_t t = 0; t < mesh->tets.size(); ++t)
      candidates.push_back({cosine(static_cast<std::int32_t>(t)), static_cast<std::int32_t>(t)});
    const auto middle = [&](std::int32_t t) {
      return 0.25 * (corner(t, 0) + corner(t, 1) + (corner(t, 2) + corner(t, 3)));
    };
    for (const std::int32_t t : take_apart(std::move(candidates), most, apart_mm, middle))
      places.push_back({"dihedral",
                        57.295779513082320877 * std::acos(std::clamp(cosine(t), -1.0, 1.0)),
                        middle(t),
                        {corner(t, 0), corner(t, 1), corner(t, 2), corner(t, 3)},
                        {mesh->labels[t]}});
  }
  if (!distances_mm.empty()) {
    candidates.clear();
    for (std::size_t v = 0; v < distances_mm.size(); ++v)
      candidates.push_back({distances_mm[v], static_cast<std::int32_t>(v)});
    std::vector<std::vector<Label>> labels;
    const std::vector<std::int32_t> taken =
        take_apart(std::move(candidates), most, apart_mm, [&](std::int32_t v) { return points[v]; });
    labels.resize(taken.size());
    for (const InterfaceTriangle& t : complex.triangles)
      for (std::size_t i = 0; i < taken.size(); ++i)
        if (std::find(t.v.begin(), t.v.end(), taken[i]) != t.v.end())
          labels[i].insert(labels[i].end(), {t.below, t.above});
    for (std::size_t i = 0; i < taken.size(); ++i) {
      std::sort(labels[i].begin(), labels[i].end());
      labels[i].erase(std::unique(labels[i].begin(), labels[i].end()), labels[i].end());
      places.push_back({"distance", distances_mm[taken[i]], points[taken[i]], {points[taken[i]]}, labels[i]});
    }
  }
  return places;
}

}  // namespace stackmesh
