#include "fem/load_case.h"

#include <cmath>
#include <map>

#include "base/error.h"
#include "base/text.h"
#include "fem/boundary_faces.h"

namespace stackmesh {
namespace {

/// Seven points on a triangle, exact to fifth order.
struct FacePoint {
  double l[3], weight;
};
std::vector<FacePoint> face_rule() {
  constexpr double a = 0.0597158717897698, b = 0.4701420641051151, w = 0.1323941527885062;
  constexpr double c = 0.7974269853530873, d = 0.1012865073234563, v = 0.1259391805448271;
  return {{{1.0 / 3, 1.0 / 3, 1.0 / 3}, 0.225}, {{a, b, b}, w}, {{b, a, b}, w}, {{b, b, a}, w}, {{c, d, d}, v}, {{d, c, d}, v}, {{d, d, c}, v}};
}

/// For each node of a face the integral of its shape function times the outward normal, and times the area alone.
struct FaceIntegral {
  std::array<std::int32_t, 6> nodes;
  Vec3 normal[6];
  double area[6] = {0, 0, 0, 0, 0, 0};
};

FaceIntegral integrate(const TetMesh& mesh, TetFace face) {
  FaceIntegral out;
  out.nodes = outward_nodes(mesh, face);
  const int count = mesh.mid.empty() ? 3 : 6;
  for (const FacePoint& p : face_rule()) {
    double shape[6], du[6], dv[6];  // coordinates u, v are those of corners 1 and 2
    if (count == 3) {
      for (int k = 0; k < 3; ++k) shape[k] = p.l[k];
      const double u[3] = {-1, 1, 0}, v[3] = {-1, 0, 1};
      std::copy(u, u + 3, du);
      std::copy(v, v + 3, dv);
    } else {
      const double dl[2][3] = {{-1, 1, 0}, {-1, 0, 1}};
      for (int k = 0; k < 3; ++k) {
        const int m = (k + 1) % 3;
        shape[k] = p.l[k] * (2 * p.l[k] - 1);
        du[k] = (4 * p.l[k] - 1) * dl[0][k];
        dv[k] = (4 * p.l[k] - 1) * dl[1][k];
        shape[3 + k] = 4 * p.l[k] * p.l[m];
        du[3 + k] = 4 * (dl[0][k] * p.l[m] + p.l[k] * dl[0][m]);
        dv[3 + k] = 4 * (dl[1][k] * p.l[m] + p.l[k] * dl[1][m]);
      }
    }
    Vec3 xu, xv;
    for (int k = 0; k < count; ++k) {
      xu = xu + du[k] * mesh.points[out.nodes[k]];
      xv = xv + dv[k] * mesh.points[out.nodes[k]];
    }
    const Vec3 n = 0.5 * cross(xu, xv);
    for (int k = 0; k < count; ++k) {
      out.normal[k] = out.normal[k] + (p.weight * shape[k]) * n;
      out.area[k] += p.weight * shape[k] * norm(n);
    }
  }
  return out;
}

class Loader {
 public:
  Loader(SolverModel& model, const std::string& path) : model_(model), path_(path) {}

  void run(const LoadCase& load_case) {
    std::map<std::pair<std::int32_t, int>, std::pair<double, std::string>> held;
    for (const LoadCase::Held& h : load_case.held) {
      const NodeSet& set = node_set(h.set);
      for (int axis = 0; axis < 3; ++axis) {
        if (!h.value_mm[axis]) continue;
        for (const std::int32_t v : set.nodes) {
          const auto [at, fresh] = held.insert({{v, axis}, {*h.value_mm[axis], h.set}});
          if (!fresh && at->second.first != *h.value_mm[axis])
            fail_input("a node is held to two different displacements, in sets '" + at->second.second + "' and '" + h.set + "'",
                       path_ + ", load_case, node " + std::to_string(v + 1), "choose sets that do not touch, or the same displacement");
        }
      }
      model_.sets.supports.push_back({h.set, h.value_mm});
    }
    std::map<std::int32_t, Vec3> forces;
    for (const LoadCase::Loaded& l : load_case.loaded) load(l, forces);
    model_.sets.forces_n.assign(forces.begin(), forces.end());
  }

 private:
  [[noreturn]] void missing(const std::string& name) const {
    std::vector<std::string> known;
    for (const NodeSet& s : model_.sets.node_sets) known.push_back(s.name);
    const std::string nearest = "of its " + std::to_string(known.size()) + " sets the nearest are " + nearest_names(name, known);
    for (const LabelInfo& l : model_.labels)
      for (const std::string end : {"low", "high"})
        if (name == l.name + "_cap_" + end)
          fail_input("the load case names set '" + name + "', but label " + std::to_string(l.number) + " has no flat " + end + " end", path_ + ", load_case",
                     "mesh with --caps flat, choose its end with --select, or another set; " + nearest);
    fail_input("the load case names set '" + name + "', which the model does not have", path_ + ", load_case", nearest);
  }
  const NodeSet& node_set(const std::string& name) const {
    for (const NodeSet& s : model_.sets.node_sets)
      if (s.name == name) return s;
    missing(name);
  }

  void load(const LoadCase::Loaded& l, std::map<std::int32_t, Vec3>& forces) const {
    node_set(l.set);
    const FaceSet* set = nullptr;
    for (const FaceSet& s : model_.sets.surfaces)
      if (s.name == l.set) set = &s;
    if (set == nullptr) fail_input("set '" + l.set + "' has no faces to load", path_ + ", load_case", "load a set of faces, not an outline");
    std::vector<FaceIntegral> parts;
    double area = 0;
    for (const TetFace f : set->faces) {
      parts.push_back(integrate(model_.mesh, f));
      for (const double a : parts.back().area) area += a;
    }
    for (const FaceIntegral& p : parts)
      for (int k = 0; k < 6; ++k) {
        if (p.nodes[k] < 0) continue;
        const Vec3 f = l.force_n ? (p.area[k] / area) * *l.force_n : -*l.pressure_mpa * p.normal[k];
        forces[p.nodes[k]] = forces[p.nodes[k]] + f;
      }
  }

  SolverModel& model_;
  const std::string& path_;
};

}  // namespace

void apply_load_case(SolverModel& model, const LoadCase& load_case, const std::string& path) { Loader(model, path).run(load_case); }

}  // namespace stackmesh
