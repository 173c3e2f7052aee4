#include "fem/recover_stress.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "fem/tet_shape.h"

namespace stackmesh {
namespace {

using Stress = std::array<double, 6>;  // xx, yy, zz, xy, yz, zx

// four points, exact for squares of linear stress
constexpr double kNear = 0.58541019662496852, kFar = 0.1381966011250105;

double mises(const Stress& s) {
  const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
  return std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

/// Twice the energy density of a stress.
double energy(const Stress& s, const ElementMaterial& m) {
  const double trace = s[0] + s[1] + s[2];
  const double square = s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + 2 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]);
  return ((1 + m.poisson) * square - m.poisson * trace * trace) / m.young_mpa;
}

/// Gradients of the barycentric coordinates at a point, and the determinant there.
std::array<Vec3, 4> gradients(const std::array<Vec3, 4>& d, double& determinant) {
  const Vec3 a = d[1] - d[0], b = d[2] - d[0], c = d[3] - d[0];
  determinant = dot(cross(a, b), c);
  const double f = 1 / determinant;
  const Vec3 g1 = f * cross(b, c), g2 = f * cross(c, a), g3 = f * cross(a, b);
  return {Vec3{} - g1 - g2 - g3, g1, g2, g3};
}

class Recovery {
 public:
  Recovery(const SolverModel& model, const std::vector<Vec3>& u)
      : model_(model), mesh_(model.mesh), u_(u), points_(mesh_.mid.empty() ? 1 : 4) {}

  StressMeasure run() {
    const SolverSets& sets = model_.sets;
    material_.assign(mesh_.tets.size(), nullptr);
    for (const ElementMaterial& m : sets.materials) {
      if (m.kind != MaterialKind::linear)
        fail_usage("errors of stress are estimated for linear isotropic materials", m.name,
                   "leave --accuracy out, or give E_MPa and poisson");
      for (const std::int32_t t : m.tets) material_[t] = &m;
    }
    for (std::size_t t = 0; t < mesh_.tets.size(); ++t) elements_.push_back(element(t));
    totals_.resize(sets.surfaces.size());
    for (std::size_t begin = 0, end; begin < mesh_.tets.size(); begin = end) {  // tets are grouped by label
      end = begin;
      while (end < mesh_.tets.size() && mesh_.labels[end] == mesh_.labels[begin]) ++end;
      label(begin, end);
    }
    return result();
  }

 private:
  struct Element {
    std::array<Stress, 4> at{};      // at points of integration; the first alone where it is constant
    std::array<double, 4> volume{};  // that they stand for
    double error = 0, whole = 0;     // energies
  };
  struct Total {
    double area = 0, square = 0, most = 0, error = 0, whole = 0;
  };

  std::array<double, 4> place(int g) const {
    std::array<double, 4> l = {0.25, 0.25, 0.25, 0.25};
    if (points_ == 4) {
      l.fill(kFar);
      l[g] = kNear;
    }
    return l;
  }

  Element element(std::size_t t) const {
    Element e;
    for (int g = 0; g < points_; ++g) {
      const std::array<double, 4> l = place(g);
      double determinant = 0;
      const std::array<Vec3, 4> grad = gradients(tet_derivatives(mesh_, t, l), determinant);
      double h[3][3] = {};  // displacement gradient
      const auto add = [&](std::int32_t node, Vec3 n) {
        const double u[3] = {u_[node].x, u_[node].y, u_[node].z}, d[3] = {n.x, n.y, n.z};
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) h[i][j] += u[i] * d[j];
      };
      for (int k = 0; k < 4; ++k) add(mesh_.tets[t][k], (points_ == 1 ? 1 : 4 * l[k] - 1) * grad[k]);
      if (points_ == 4)
        for (int m = 0; m < 6; ++m) {
          const int a = kTetEdges[m][0], b = kTetEdges[m][1];
          add(mesh_.mid[t][m], 4 * (l[a] * grad[b] + l[b] * grad[a]));
        }
      const ElementMaterial& material = *material_[t];
      const double mu = material.young_mpa / (2 * (1 + material.poisson)),
                   lambda = 2 * mu * material.poisson / (1 - 2 * material.poisson);
      const double trace = lambda * (h[0][0] + h[1][1] + h[2][2]);
      e.at[g] = {trace + 2 * mu * h[0][0], trace + 2 * mu * h[1][1], trace + 2 * mu * h[2][2],
                 mu * (h[0][1] + h[1][0]), mu * (h[1][2] + h[2][1]), mu * (h[2][0] + h[0][2])};
      e.volume[g] = determinant / 6 / points_;
    }
    return e;
  }

  /// Recovers the stress of one label's corners, then what it says of its elements and faces.
  void label(std::size_t begin, std::size_t end) {
    std::vector<Stress> at(mesh_.points.size(), Stress{});
    std::vector<double> weight(mesh_.points.size(), 0);
    for (std::size_t t = begin; t < end; ++t) {
      const Element& e = elements_[t];
      double volume = 0;
      for (int g = 0; g < points_; ++g) volume += e.volume[g];
      for (int k = 0; k < 4; ++k) {
        const std::int32_t node = mesh_.tets[t][k];
        weight[node] += volume;
        for (int g = 0; g < points_; ++g) {
          // linear, through the four points
          const double share = points_ == 1 ? 1 : ((g == k ? 1 : 0) - kFar) / (kNear - kFar);
          for (int c = 0; c < 6; ++c) at[node][c] += volume * share * e.at[g][c];
        }
      }
    }
    for (std::size_t n = 0; n < at.size(); ++n)
      if (weight[n] > 0)
        for (double& c : at[n]) c /= weight[n];
    for (std::size_t t = begin; t < end; ++t) {
      Element& e = elements_[t];
      const auto add = [&](const std::array<double, 4>& l, const Stress& own, double volume) {
        Stress recovered{}, apart{};
        for (int k = 0; k < 4; ++k)
          for (int c = 0; c < 6; ++c) recovered[c] += l[k] * at[mesh_.tets[t][k]][c];
        for (int c = 0; c < 6; ++c) apart[c] = recovered[c] - own[c];
        e.error += volume * energy(apart, *material_[t]);
        e.whole += volume * energy(recovered, *material_[t]);
        square_ += volume * mises(recovered) * mises(recovered);
        volume_ += volume;
      };
      if (points_ == 4)
        for (int g = 0; g < 4; ++g) add(place(g), e.at[g], e.volume[g]);
      else
        for (int g = 0; g < 4; ++g) {  // the difference is linear where the element's stress is constant
          std::array<double, 4> l = {kFar, kFar, kFar, kFar};
          l[g] = kNear;
          add(l, e.at[0], e.volume[0] / 4);
        }
    }
    for (std::size_t s = 0; s < totals_.size(); ++s)
      for (const TetFace f : model_.sets.surfaces[s].faces) {
        if (static_cast<std::size_t>(f.tet) < begin || static_cast<std::size_t>(f.tet) >= end) continue;
        std::array<std::int32_t, 3> v;
        for (int k = 0; k < 3; ++k) v[k] = mesh_.tets[f.tet][kTetFaces[f.face][k]];
        const double area =
            norm(cross(mesh_.points[v[1]] - mesh_.points[v[0]], mesh_.points[v[2]] - mesh_.points[v[0]])) / 2;
        Total& total = totals_[s];
        for (int k = 0; k < 3; ++k) {
          Stress middle{};
          for (int c = 0; c < 6; ++c) middle[c] = (at[v[k]][c] + at[v[(k + 1) % 3]][c]) / 2;
          total.square += area / 3 * mises(middle) * mises(middle);
          total.most = std::max(total.most, mises(at[v[k]]));
        }
        total.area += area;
        total.error += elements_[f.tet].error;
        total.whole += elements_[f.tet].whole;
      }
  }

  StressMeasure result() const {
    StressMeasure out;
    double error = 0, whole = 0;
    for (const Element& e : elements_) error += e.error, whole += e.whole;
    out.zz_rel = whole > 0 ? std::sqrt(error / whole) : 0;
    out.mises_rms_mpa = volume_ > 0 ? std::sqrt(square_ / volume_) : 0;
    const std::vector<char> held = held_nodes();
    for (std::size_t s = 0; s < totals_.size(); ++s) {
      const Total& t = totals_[s];
      if (t.area <= 0) continue;
      SetStress row;
      row.set = model_.sets.surfaces[s].name;
      row.mises_rms_mpa = std::sqrt(t.square / t.area);
      row.mises_max_mpa = t.most;
      row.zz_rel = t.whole > 0 ? std::sqrt(t.error / t.whole) : 0;
      for (const NodeSet& n : model_.sets.node_sets) {
        if (n.name != row.set) continue;
        row.held = true;
        for (const std::int32_t v : n.nodes) {
          row.displacement_max_mm = std::max(row.displacement_max_mm, norm(u_[v]));
          row.held = row.held && held[v];
        }
      }
      out.sets.push_back(row);
    }
    return out;
  }

  std::vector<char> held_nodes() const {
    std::vector<char> held(mesh_.points.size(), 0);
    for (const LoadStep& step : model_.sets.steps) {
      if (step.analysis != Analysis::statics) continue;
      for (const Support& support : step.supports)
        for (const NodeSet& n : model_.sets.node_sets)
          if (n.name == support.set)
            for (const std::int32_t v : n.nodes) held[v] = 1;
      break;
    }
    return held;
  }

  const SolverModel& model_;
  const TetMesh& mesh_;
  const std::vector<Vec3>& u_;
  const int points_;
  std::vector<const ElementMaterial*> material_;
  std::vector<Element> elements_;
  std::vector<Total> totals_;
  double square_ = 0, volume_ = 0;
};

}  // namespace

StressMeasure recover_stress(const SolverModel& model, const std::vector<Vec3>& displacement_mm) {
  return Recovery(model, displacement_mm).run();
}

}  // namespace stackmesh
