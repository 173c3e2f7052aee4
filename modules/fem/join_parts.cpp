#include "fem/join_parts.h"

#include <algorithm>
#include <map>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "fem/boundary_faces.h"

namespace stackmesh {
namespace {

class Joiner {
 public:
  Joiner(SolverModel& model, const JoinOptions& options) : model_(model), o_(options) {}

  void run() {
    for (SurfacePair& p : model_.sets.pairs) p.contact = o_.others;
    if (o_.laws != nullptr) apply_laws();
    for (SurfacePair& p : model_.sets.pairs) {
      if (p.contact != Contact::contact) continue;
      if (model_.sets.placeholder_materials)
        fail_usage("contact needs materials, for its stiffness", "parts '" + p.parts[0] + "' and '" + p.parts[1] + "'",
                   "give them with --materials LAW.json, or choose --contact tie");
      if (p.stiffness_mpa_mm <= 0) p.stiffness_mpa_mm = default_stiffness(p);
    }
    tie();
  }

 private:
  void apply_laws() {
    std::set<std::string> done;
    for (const ContactLaw& law : *o_.laws) {
      SurfacePair* pair = nullptr;
      std::string known;
      for (SurfacePair& p : model_.sets.pairs) {
        known += (known.empty() ? "" : ", ") + p.parts[0] + "-" + p.parts[1];
        if (std::is_permutation(p.parts.begin(), p.parts.end(), law.parts.begin())) pair = &p;
      }
      const std::string where = o_.path + ", contact of '" + law.parts[0] + "' and '" + law.parts[1] + "'";
      if (pair == nullptr)
        fail_input("the law names parts that do not touch, or are not there", where,
                   known.empty() ? "give the parts with --parts A=1,3 B=2,4" : "these touch: " + known.substr(0, 300));
      if (!done.insert(pair->name).second) fail_input("the law names a pair of parts twice", where, "name each pair once");
      if (law.parts != pair->parts) {  // the first of the law is the primary one
        std::swap(pair->parts[0], pair->parts[1]);
        std::swap(pair->primary, pair->secondary);
      }
      pair->contact = law.contact;
      pair->friction = law.friction;
      pair->stiffness_mpa_mm = law.stiffness_mpa_mm.value_or(0);
    }
  }

  const FaceSet& surface(const std::string& name) const {
    for (const FaceSet& s : model_.sets.surfaces)
      if (s.name == name) return s;
    fail_internal("a pair names a surface that is not there", name);
  }

  double default_stiffness(const SurfacePair& p) const {
    double softer = 0, edges = 0;
    std::size_t count = 0;
    for (const std::string& name : {p.primary, p.secondary}) {
      double sum = 0;
      const FaceSet& faces = surface(name);
      for (const TetFace f : faces.faces) {
        sum += model_.sets.modulus_mpa[f.tet];
        const auto v = outward_nodes(model_.mesh, f);
        for (int k = 0; k < 3; ++k, ++count) edges += norm(model_.mesh.points[v[k]] - model_.mesh.points[v[(k + 1) % 3]]);
      }
      const double mean = sum / static_cast<double>(faces.faces.size());
      softer = softer == 0 ? mean : std::min(softer, mean);
    }
    return 50 * softer / (edges / static_cast<double>(count));
  }

  /// Axes of each node that are supported.
  std::map<std::int32_t, int> supported_axes() const {
    std::map<std::int32_t, int> axes;  // bits
    for (const Support& s : model_.sets.supports)
      for (const NodeSet& set : model_.sets.node_sets) {
        if (set.name != s.set) continue;
        for (const std::int32_t v : set.nodes)
          for (int axis = 0; axis < 3; ++axis)
            if (s.value_mm[axis]) axes[v] |= 1 << axis;
      }
    return axes;
  }

  /// Another copy of the same place, and the pair over which it is reached.
  struct Neighbour {
    std::int32_t node;
    std::size_t pair;
    bool primary;  ///< it is on the pair's primary surface
  };

  void tie() {
    SolverSets& sets = model_.sets;
    std::map<std::int32_t, std::vector<Neighbour>> neighbours;
    for (std::size_t i = 0; i < sets.pairs.size(); ++i) {
      if (sets.pairs[i].contact != Contact::tie) continue;
      std::map<std::int32_t, std::int32_t> at;  // original node to the primary surface's copy
      for (const std::int32_t v : nodes_of_faces(model_.mesh, surface(sets.pairs[i].primary).faces)) at[sets.original[v]] = v;
      for (const std::int32_t v : nodes_of_faces(model_.mesh, surface(sets.pairs[i].secondary).faces)) {
        const std::int32_t other = at.at(sets.original[v]);
        neighbours[v].push_back({other, i, true});
        neighbours[other].push_back({v, i, false});
      }
    }
    const std::map<std::int32_t, int> axes = supported_axes();
    const auto held = [&](std::int32_t v) { return axes.count(v) > 0 ? axes.at(v) : 0; };
    std::vector<std::pair<int, std::int32_t>> order;  // most supported first, then by number
    for (const auto& [v, list] : neighbours) order.push_back({-__builtin_popcount(static_cast<unsigned>(held(v))), v});
    std::sort(order.begin(), order.end());
    std::set<std::int32_t> reached;
    std::map<std::pair<std::size_t, bool>, std::map<std::int32_t, std::int32_t>> followed;  // pair, whether its primary side follows
    for (const auto& [key, root] : order) {
      if (!reached.insert(root).second) continue;
      std::vector<std::int32_t> front = {root};
      for (std::size_t i = 0; i < front.size(); ++i) {
        const std::int32_t v = front[i];  // the vector grows
        for (const Neighbour& n : neighbours[v]) {
          if (!reached.insert(n.node).second) continue;
          front.push_back(n.node);
          if (held(v) == 7 && held(n.node) == 7) continue;  // both held all round: nothing to tie
          followed[{n.pair, n.primary}][n.node] = v;
        }
      }
    }
    for (const auto& [key, nodes] : followed) {
      const SurfacePair& p = sets.pairs[key.first];
      Tie tie;
      tie.name = unique("tie_" + p.parts[key.second ? 0 : 1] + "_to_" + p.parts[key.second ? 1 : 0]);
      tie.faces = key.second ? p.secondary : p.primary;
      tie.nodes.assign(nodes.begin(), nodes.end());
      NodeSet set;
      set.name = tie.name;
      set.note = "nodes that follow those at the same place on " + tie.faces;
      for (const auto& [copy, node] : tie.nodes) set.nodes.push_back(copy);
      sets.node_sets.push_back(std::move(set));
      sets.ties.push_back(std::move(tie));
    }
  }

  std::string unique(const std::string& name) const {
    const auto taken = [&](const std::string& n) {
      return std::any_of(model_.sets.node_sets.begin(), model_.sets.node_sets.end(), [&](const NodeSet& s) { return lower_case(s.name) == lower_case(n); });
    };
    std::string result = name;
    for (int n = 2; taken(result); ++n) result = name + "_" + std::to_string(n);
    return result;
  }

  SolverModel& model_;
  const JoinOptions& o_;
};

}  // namespace

void join_parts(SolverModel& model, const JoinOptions& options) { Joiner(model, options).run(); }

}  // namespace stackmesh
