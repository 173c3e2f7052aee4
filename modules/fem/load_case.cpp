#include "fem/load_case.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/text.h"
#include "fem/face_integral.h"

namespace stackmesh {
namespace {

/// x of m x = b for a symmetric m, by Cramer's rule.
Vec3 solve3(const double m[3][3], Vec3 b) {
  const Vec3 r0 = {m[0][0], m[0][1], m[0][2]}, r1 = {m[1][0], m[1][1], m[1][2]}, r2 = {m[2][0], m[2][1], m[2][2]};
  const double det = dot(r0, cross(r1, r2));
  return (1 / det) * (b.x * cross(r1, r2) + b.y * cross(r2, r0) + b.z * cross(r0, r1));
}

class Loader {
 public:
  Loader(SolverModel& model, const std::string& path) : model_(model), path_(path) {}

  void run(const LoadCase& load_case) {
    case_ = &load_case;
    SolverSets& sets = model_.sets;
    for (const LoadCase::Point& p : load_case.points) {
      faces_of(p.set);
      if (!p.rigid) continue;
      sets.points.push_back({unique("point_" + p.name), p.set, p.at_mm});
      rigid_[p.name] = static_cast<std::int32_t>(sets.points.size()) - 1;
      for (const std::int32_t v : node_set(p.set).nodes) {
        const auto [at, fresh] = bound_.insert({v, p.name});
        if (!fresh)
          fail("a node is bound to two points, '" + at->second + "' and '" + p.name + "'",
               "node " + std::to_string(v + 1), "choose sets that do not touch");
      }
    }
    for (const LoadCase::Spring& s : load_case.springs) spring(s);
    if (load_case.steps.empty()) {
      if (!load_case.always.empty()) step(load_case.defaults);
    } else {
      for (const LoadCase::Step& s : load_case.steps) step(s);
    }
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& where, const std::string& mend) const {
    fail_input(what, path_ + ", load_case" + (where.empty() ? "" : ", ") + where, mend);
  }
  [[noreturn]] void missing(const std::string& name) const {
    std::vector<std::string> known;
    for (const NodeSet& s : model_.sets.node_sets) known.push_back(s.name);
    const std::string nearest =
        "of its " + std::to_string(known.size()) + " sets the nearest are " + nearest_names(name, known);
    for (const LabelInfo& l : model_.labels)
      for (const std::string end : {"low", "high"})
        if (name == l.name + "_cap_" + end)
          fail("the load case names set '" + name + "', but label " + std::to_string(l.number) + " has no flat " + end +
                   " end",
               "", "mesh with --caps flat, choose its end with --select, or another set; " + nearest);
    fail("the load case names set '" + name + "', which the model does not have", "", nearest);
  }
  const NodeSet& node_set(const std::string& name) const {
    for (const NodeSet& s : model_.sets.node_sets)
      if (s.name == name) return s;
    missing(name);
  }
  const std::vector<TetFace>& faces_of(const std::string& name) const {
    node_set(name);
    for (const FaceSet& s : model_.sets.surfaces)
      if (s.name == name) return s.faces;
    fail("set '" + name + "' has no faces to load", "", "load a set of faces, not an outline");
  }
  std::string unique(const std::string& name) const {
    const auto taken = [&](const std::string& n) {
      for (const NodeSet& s : model_.sets.node_sets)
        if (lower_case(s.name) == lower_case(n)) return true;
      for (const RigidPoint& p : model_.sets.points)
        if (lower_case(p.name) == lower_case(n)) return true;
      for (const SpringSet& s : model_.sets.springs)
        if (lower_case(s.name) == lower_case(n)) return true;
      return false;
    };
    std::string clean;
    for (const char c : name) clean += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
    std::string result = clean;
    for (int n = 2; taken(result); ++n) result = clean + "_" + std::to_string(n);
    return result;
  }

  void step(const LoadCase::Step& from) {
    LoadStep out;
    out.name = from.name.empty() ? "load case" : from.name;
    out.analysis = from.analysis;
    out.large_displacements = from.large_displacements;
    out.increments = from.increments;
    const bool frequency = from.analysis == Analysis::frequency;
    if (frequency) out.modes = from.modes;
    std::map<std::pair<std::int32_t, int>, std::pair<double, std::string>> held;
    std::map<std::int32_t, Vec3> forces;
    std::map<std::int32_t, PointLoad> point_loads;
    for (const LoadCase::Acting* acting : {&case_->always, &from.acting}) {
      for (const LoadCase::Held& h : acting->held) hold(h, held, out);
      if (frequency) continue;
      for (const LoadCase::Loaded& l : acting->loaded) load(l, forces, point_loads, out);
      if (acting->gravity_mm_s2) out.gravity_mm_s2 = *acting->gravity_mm_s2;
    }
    if (frequency || norm(out.gravity_mm_s2) > 0) needs_density(out.name);
    out.forces_n.assign(forces.begin(), forces.end());
    for (const auto& [point, l] : point_loads) out.point_loads.push_back(l);
    model_.sets.steps.push_back(std::move(out));
  }

  void needs_density(const std::string& step) const {
    for (std::size_t t = 0; t < model_.sets.density_t_mm3.size(); ++t)
      if (!(model_.sets.density_t_mm3[t] > 0))
        fail("gravity and natural frequencies need a density, and label " + std::to_string(model_.mesh.labels[t]) +
                 " has none",
             step, "give it \"density_t_mm3\" (water: 1e-9)");
  }

  void hold(const LoadCase::Held& h, std::map<std::pair<std::int32_t, int>, std::pair<double, std::string>>& held,
            LoadStep& out) const {
    // A point's six ways to move are numbered as a node's, behind all nodes.
    const auto point = rigid_.find(h.set);
    const auto hold_one = [&](std::int32_t v, int axis, double value) {
      const auto [at, fresh] = held.insert({{v, axis}, {value, h.set}});
      if (!fresh && at->second.first != value)
        fail("a node is held to two different displacements, in sets '" + at->second.second + "' and '" + h.set + "'",
             "node " + std::to_string(v + 1), "choose sets that do not touch, or the same displacement");
    };
    if (point != rigid_.end()) {
      PointSupport s;
      s.point = point->second;
      const auto number = static_cast<std::int32_t>(model_.mesh.points.size()) + point->second;
      for (int axis = 0; axis < 6; ++axis) {
        s.value[axis] = axis < 3 ? h.value_mm[axis] : h.value_rad[axis - 3];
        if (s.value[axis]) hold_one(number, axis, *s.value[axis]);
      }
      out.point_supports.push_back(s);
      return;
    }
    for (const std::int32_t v : node_set(h.set).nodes) {
      if (const auto bound = bound_.find(v); bound != bound_.end())
        fail("a node is held in set '" + h.set + "' and bound to point '" + bound->second + "'",
             "node " + std::to_string(v + 1), "hold the point, or choose sets that do not touch");
      for (int axis = 0; axis < 3; ++axis)
        if (h.value_mm[axis]) hold_one(v, axis, *h.value_mm[axis]);
    }
    out.supports.push_back({h.set, h.value_mm});
  }

  void load(const LoadCase::Loaded& l, std::map<std::int32_t, Vec3>& forces,
            std::map<std::int32_t, PointLoad>& point_loads, LoadStep& out) const {
    const Vec3 force = l.force_n.value_or(Vec3{}), moment = l.moment_nmm.value_or(Vec3{});
    if (const auto rigid = rigid_.find(l.set); rigid != rigid_.end()) {
      PointLoad& p = point_loads[rigid->second];
      p.point = rigid->second;
      p.force_n = p.force_n + force;
      p.moment_nmm = p.moment_nmm + moment;
      return;
    }
    for (const LoadCase::Point& p : case_->points)
      if (p.name == l.set) return spread(faces_of(p.set), force, moment, &p.at_mm, forces);
    if (l.pressure_mpa) {
      faces_of(l.set);
      out.pressures.push_back({l.set, *l.pressure_mpa});
      return;
    }
    spread(faces_of(l.set), force, moment, nullptr, forces);
  }

  /// A traction a + b x (r - c) over the faces, c their centre, that has this force, and this moment about the point
  /// (or the centre).
  void spread(const std::vector<TetFace>& faces, Vec3 force, Vec3 moment, const Vec3* about,
              std::map<std::int32_t, Vec3>& forces) const {
    double area = 0, m[3][3] = {{0}};
    Vec3 centre;
    visit_face_points(model_.mesh, faces, [&](const FacePoint& p) {
      area += norm(p.area);
      centre = centre + norm(p.area) * p.position;
    });
    centre = (1 / area) * centre;
    if (about != nullptr) moment = moment + cross(*about - centre, force);
    Vec3 turn;
    if (norm(moment) > 0) {
      visit_face_points(model_.mesh, faces, [&](const FacePoint& p) {
        const Vec3 r = p.position - centre;
        const double x[3] = {r.x, r.y, r.z};
        for (int i = 0; i < 3; ++i)
          for (int k = 0; k < 3; ++k) m[i][k] += norm(p.area) * ((i == k ? dot(r, r) : 0) - x[i] * x[k]);
      });
      turn = solve3(m, moment);
    }
    visit_face_points(model_.mesh, faces, [&](const FacePoint& p) {
      const Vec3 traction = norm(p.area) * ((1 / area) * force + cross(turn, p.position - centre));
      for (int k = 0; k < 6; ++k)
        if (p.nodes[k] >= 0) forces[p.nodes[k]] = forces[p.nodes[k]] + p.shape[k] * traction;
    });
  }

  /// Springs from the nodes of a set to the ground, each by its share of the area.
  void spring(const LoadCase::Spring& s) {
    std::map<std::int32_t, Vec3> normals;
    std::map<std::int32_t, double> areas;
    double area = 0, shares = 0;
    visit_face_points(model_.mesh, faces_of(s.set), [&](const FacePoint& p) {
      area += norm(p.area);
      for (int k = 0; k < 6; ++k) {
        if (p.nodes[k] < 0) continue;
        normals[p.nodes[k]] = normals[p.nodes[k]] + p.shape[k] * p.area;
        areas[p.nodes[k]] += p.shape[k] * norm(p.area);
      }
    });
    // corners of second-order faces bear nothing, but for curvature
    const double least = 1e-6 * area / static_cast<double>(areas.size());
    for (const auto& [v, a] : areas) shares += a > least ? a : 0;
    SpringSet out;
    out.name = unique("springs_" + s.set);
    for (const auto& [v, a] : areas) {
      if (!(a > least)) continue;
      if (s.mpa_per_mm) {
        const Vec3 n = normals.at(v);
        if (norm(n) > least) out.springs.push_back({v, (1 / norm(n)) * n, *s.mpa_per_mm * norm(n)});
        continue;
      }
      const double stiffness[3] = {s.n_per_mm->x, s.n_per_mm->y, s.n_per_mm->z};
      for (int axis = 0; axis < 3; ++axis)
        if (stiffness[axis] > 0)
          out.springs.push_back(
              {v, {axis == 0 ? 1.0 : 0, axis == 1 ? 1.0 : 0, axis == 2 ? 1.0 : 0}, stiffness[axis] * a / shares});
    }
    model_.sets.springs.push_back(std::move(out));
  }

  SolverModel& model_;
  const std::string& path_;
  const LoadCase* case_ = nullptr;
  std::map<std::string, std::int32_t> rigid_;  // points to places in SolverSets::points
  std::map<std::int32_t, std::string> bound_;  // nodes to their points
};

}  // namespace

void apply_load_case(SolverModel& model, const LoadCase& load_case, const std::string& path) {
  Loader(model, path).run(load_case);
}

Vec3 force_of(const SolverModel& model, const Pressure& pressure) {
  Vec3 sum;
  for (const FaceSet& s : model.sets.surfaces)
    if (s.name == pressure.set)
      visit_face_points(model.mesh, s.faces, [&](const FacePoint& p) { sum = sum - pressure.mpa * p.area; });
  return sum;
}

}  // namespace stackmesh
