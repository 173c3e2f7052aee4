#include "fem/lay_fibres.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"

namespace stackmesh {
namespace {

/// Gradients of the four linear shape functions of a tet, and its volume.
struct Gradients {
  Vec3 of[4];
  double volume = 0;
};

Gradients gradients(const TetMesh& mesh, const std::array<std::int32_t, 4>& v) {
  const Vec3 o = mesh.points[v[0]], a = mesh.points[v[1]] - o, b = mesh.points[v[2]] - o, c = mesh.points[v[3]] - o;
  const double six = dot(a, cross(b, c));
  Gradients g;
  g.volume = six / 6;
  g.of[1] = (1 / six) * cross(b, c);
  g.of[2] = (1 / six) * cross(c, a);
  g.of[3] = (1 / six) * cross(a, b);
  g.of[0] = -1.0 * (g.of[1] + g.of[2] + g.of[3]);
  return g;
}

/// Laplace's equation on the tets of a label: values held on some nodes.
class Laplace {
 public:
  Laplace(const TetMesh& mesh, const std::vector<std::int32_t>& tets) : mesh_(mesh), row_of_(mesh.points.size(), -1) {
    for (const std::int32_t t : tets)
      each_corner(mesh, static_cast<std::size_t>(t), [&](std::int32_t v) {
        if (row_of_[v] >= 0) return;
        row_of_[v] = static_cast<std::int32_t>(value_.size());
        value_.push_back(0.5);
      });
    held_.assign(value_.size(), 0);
    std::vector<std::vector<std::pair<std::int32_t, double>>> rows(value_.size());
    for (const std::int32_t t : tets)
      for (const auto& v : tets_of_element(mesh, static_cast<std::size_t>(t))) {
        const Gradients g = gradients(mesh, v);
        for (int i = 0; i < 4; ++i)
          for (int k = 0; k < 4; ++k) rows[row_of_[v[i]]].emplace_back(row_of_[v[k]], g.volume * dot(g.of[i], g.of[k]));
      }
    begins_.push_back(0);
    for (auto& row : rows) {
      std::stable_sort(row.begin(), row.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
      for (const auto& [column, entry] : row) {
        if (begins_.back() < columns_.size() && columns_.back() == column) entries_.back() += entry;
        else columns_.push_back(column), entries_.push_back(entry);
      }
      begins_.push_back(columns_.size());
    }
  }

  /// Nodes of a set that belong to the label's tets are held; how many.
  std::size_t hold(const std::vector<std::int32_t>& nodes, double value) {
    std::size_t count = 0;
    for (const std::int32_t v : nodes) {
      if (row_of_[v] < 0 || held_[row_of_[v]] != 0) continue;
      held_[row_of_[v]] = 1;
      value_[row_of_[v]] = value;
      ++count;
    }
    return count;
  }

  /// Conjugate gradients, scaled by the diagonal.
  void solve() {
    const std::size_t n = value_.size();
    std::vector<double> r(n), z(n), p(n), q(n), diagonal(n, 1);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = begins_[i]; k < begins_[i + 1]; ++k)
        if (columns_[k] == static_cast<std::int32_t>(i)) diagonal[i] = entries_[k];
    multiply(value_, r);
    double rz = 0, first = 0;
    for (std::size_t i = 0; i < n; ++i) {
      r[i] = held_[i] != 0 ? 0 : -r[i];
      p[i] = z[i] = r[i] / diagonal[i];
      rz += r[i] * z[i];
    }
    first = rz;
    for (std::size_t pass = 0; pass < 20 * n + 100 && rz > 1e-20 * first && rz > 0; ++pass) {
      multiply(p, q);
      double pq = 0;
      for (std::size_t i = 0; i < n; ++i) pq += held_[i] != 0 ? 0 : p[i] * q[i];
      const double step = rz / pq;
      double next = 0;
      for (std::size_t i = 0; i < n; ++i) {
        if (held_[i] != 0) continue;
        value_[i] += step * p[i];
        r[i] -= step * q[i];
        z[i] = r[i] / diagonal[i];
        next += r[i] * z[i];
      }
      for (std::size_t i = 0; i < n; ++i) p[i] = held_[i] != 0 ? 0 : z[i] + next / rz * p[i];
      rz = next;
    }
  }
  double at(std::int32_t node) const { return value_[row_of_[node]]; }

 private:
  void multiply(const std::vector<double>& x, std::vector<double>& y) const {
    for (std::size_t i = 0; i < x.size(); ++i) {
      double sum = 0;
      for (std::size_t k = begins_[i]; k < begins_[i + 1]; ++k) sum += entries_[k] * x[columns_[k]];
      y[i] = sum;
    }
  }

  const TetMesh& mesh_;
  std::vector<std::int32_t> row_of_, columns_;
  std::vector<double> value_, entries_;
  std::vector<std::size_t> begins_;
  std::vector<char> held_;
};

const NodeSet& set_named(const SolverModel& model, const std::string& name, const std::string& where) {
  std::vector<std::string> known;
  for (const NodeSet& s : model.sets.node_sets) {
    if (s.name == name) return s;
    known.push_back(s.name);
  }
  fail_input("the fibres name set '" + name + "', which the model does not have", where,
             "the nearest are " + nearest_names(name, known));
}

}  // namespace

void lay_axes(const std::array<Vec3, 2>& axes, const std::vector<std::int32_t>& tets, SolverSets& sets) {
  std::int32_t last = 0;
  for (const std::int32_t t : tets) last = std::max(last, t);
  if (sets.axes.size() <= static_cast<std::size_t>(last))
    sets.axes.resize(std::max<std::size_t>(static_cast<std::size_t>(last) + 1, sets.modulus_mpa.size()));
  for (const std::int32_t t : tets) sets.axes[t] = axes;
}

std::size_t lay_fibres(SolverModel& model, Label label, const FibreRule& rule, const std::string& where) {
  const TetMesh& mesh = model.mesh;
  std::vector<std::int32_t> tets;
  for (std::size_t t = 0; t < mesh.elements(); ++t)
    if (mesh.labels[t] == label) tets.push_back(static_cast<std::int32_t>(t));
  Laplace depth(mesh, tets);
  if (depth.hold(set_named(model, rule.from, where).nodes, 0) == 0)
    fail_input("set '" + rule.from + "' of the fibres has no node of the label", where + ", from",
               "name a set on the label's own faces");
  if (depth.hold(set_named(model, rule.to, where).nodes, 1) == 0)
    fail_input("set '" + rule.to + "' of the fibres has no node of the label, or only those of the other set",
               where + ", to", "name two sets on the label's own faces, away from each other");
  depth.solve();
  model.sets.axes.resize(mesh.elements());
  std::size_t unclear = 0;
  for (const std::int32_t t : tets) {
    Vec3 gradient;
    double here = 0, volumes = 0;  // of a wedge: the means of its tets
    for (const auto& v : tets_of_element(mesh, static_cast<std::size_t>(t))) {
      const Gradients g = gradients(mesh, v);
      const bool alone = !mesh.is_wedge(static_cast<std::size_t>(t));
      const double weight = alone ? 1 : g.volume;
      volumes += weight;
      for (int k = 0; k < 4; ++k) {
        gradient = gradient + (weight * depth.at(v[k])) * g.of[k];
        here += weight * (0.25 * depth.at(v[k]));
      }
    }
    gradient = (1 / volumes) * gradient;
    here /= volumes;
    const double steep = norm(gradient);
    Vec3 through = steep > 0 ? (1 / steep) * gradient : Vec3{1, 0, 0};
    Vec3 along = rule.along - dot(rule.along, through) * through;
    if (!(steep > 0) || norm(along) < 0.05) {
      ++unclear;
      const Vec3 other = std::abs(through.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
      if (norm(along) < 1e-6) along = other - dot(other, through) * through;
    }
    along = (1 / norm(along)) * along;
    const Vec3 around = cross(along, through);
    const double angle =
        (rule.angle_deg[0] + std::clamp(here, 0.0, 1.0) * (rule.angle_deg[1] - rule.angle_deg[0])) * M_PI / 180;
    const Vec3 fibre = std::cos(angle) * around + std::sin(angle) * along;
    model.sets.axes[t] = {fibre, cross(through, fibre)};
  }
  return unclear;
}

}  // namespace stackmesh
