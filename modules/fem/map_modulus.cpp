#include "fem/map_modulus.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "fem/tet_shape.h"
#include "model/wedge_shape.h"

namespace stackmesh {
namespace {

constexpr int kMost = 10;  // points along an edge

/// Points and weights on [0, 1]: zeros of the Legendre polynomial, by Newton's method.
std::vector<std::pair<double, double>> gauss(int n) {
  std::vector<std::pair<double, double>> rule;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(M_PI * (i + 0.75) / (n + 0.5)), slope = 1;
    for (int pass = 0; pass < 50; ++pass) {
      double p = 1, before = 0;
      for (int k = 1; k <= n; ++k) {
        const double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
        before = p;
        p = next;
      }
      slope = n * (x * p - before) / (x * x - 1);
      const double step = p / slope;
      x -= step;
      if (std::abs(step) < 1e-15) break;
    }
    rule.emplace_back((1 + x) / 2, 1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

struct Place {
  std::array<double, 4> barycentric;
  double weight;
};

/// n * n * n points of a tet, from the rule on a line (a product rule on the collapsed cube).
std::vector<Place> tet_rule(int n) {
  std::vector<Place> places;
  const auto line = gauss(n);
  for (const auto& [u, wu] : line)
    for (const auto& [v, wv] : line)
      for (const auto& [w, ww] : line) {
        const double a = u, b = v * (1 - u), c = w * (1 - u) * (1 - v);
        places.push_back({{1 - a - b - c, a, b, c}, wu * wv * ww * (1 - u) * (1 - u) * (1 - v)});
      }
  return places;
}

}  // namespace

std::vector<ModulusLaw::Value> map_modulus(const TetMesh& mesh, const std::vector<std::int32_t>& tets,
                                           const InsideVoxels& voxels, double voxel_mm, const ModulusLaw& law,
                                           const MappingOptions& options) {
  std::vector<std::vector<Place>> rules;
  for (int n = 0; n <= kMost; ++n) rules.push_back(n < 2 ? std::vector<Place>() : tet_rule(n));
  std::vector<std::vector<WedgePlace>> wedge_rules;
  for (int n = 0; n <= kMost && !mesh.wedges.empty(); ++n)
    wedge_rules.push_back(n < 2 ? std::vector<WedgePlace>() : wedge_rule(gauss(n)));
  std::vector<ModulusLaw::Value> values(tets.size());
  constexpr std::size_t block = 512;
  parallel_for((tets.size() + block - 1) / block, options.threads, [&](std::size_t b) {
    for (std::size_t i = b * block; i < std::min(tets.size(), (b + 1) * block); ++i) {
      const auto element = static_cast<std::size_t>(tets[i]);
      double longest = 0;
      if (mesh.is_wedge(element)) {
        for (const auto& e : kWedgeEdges)
          longest = std::max(longest, norm(mesh.points[mesh.wedges[element - mesh.tets.size()][e[0]]] -
                                           mesh.points[mesh.wedges[element - mesh.tets.size()][e[1]]]));
      } else {
        for (const auto& e : kTetEdges)
          longest =
              std::max(longest, norm(mesh.points[mesh.tets[element][e[0]]] - mesh.points[mesh.tets[element][e[1]]]));
      }
      const int n = static_cast<int>(std::clamp<double>(std::ceil(1.5 * longest / voxel_mm) + 1, 3, kMost));
      double weights = 0, intensity = 0;
      ModulusLaw::Value sum;
      const auto add = [&](const Vec3& position, double w) {
        const double here = voxels.sample(position);
        weights += w;
        if (!options.integrate_modulus) {
          intensity += w * here;
          return;
        }
        const ModulusLaw::Value v = law.at(here);
        sum.young_mpa += w * v.young_mpa;
        sum.density_t_mm3 += w * v.density_t_mm3;
      };
      if (mesh.is_wedge(element)) {
        const WedgeNodes nodes = wedge_nodes(mesh, element - mesh.tets.size());
        for (const WedgePlace& place : wedge_rules[n]) {
          const WedgePoint p = wedge_point(nodes, place);
          add(p.position, place.weight * p.determinant);
        }
      } else {
        for (const Place& place : rules[n]) {
          const TetPoint p = tet_point(mesh, element, place.barycentric);
          add(p.position, place.weight * p.determinant);
        }
      }
      values[i] = options.integrate_modulus ? ModulusLaw::Value{sum.young_mpa / weights, sum.density_t_mm3 / weights}
                                            : law.at(intensity / weights);
    }
  });
  return values;
}

}  // namespace stackmesh
