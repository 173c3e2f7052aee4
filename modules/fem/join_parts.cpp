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
      if (p.stabilise > 0) stabilise(p);
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
      if (!done.insert(pair->name).second)
        fail_input("the law names a pair of parts twice", where, "name each pair once");
      if (law.parts != pair->parts) {  // the first of the law is the primary one
        std::swap(pair->parts[0], pair->parts[1]);
        std::swap(pair->primary, pair->secondary);
      }
      pair->contact = law.contact;
      pair->friction = law.friction;
      pair->stiffness_mpa_mm = law.stiffness_mpa_mm.value_or(0);
      pair->stabilise = law.stabilise;
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
        for (int k = 0; k < 3; ++k, ++count)
          edges += norm(model_.mesh.points[v[k]] - model_.mesh.points[v[(k + 1) % 3]]);
      }
      const double mean = sum / static_cast<double>(faces.faces.size());
      softer = softer == 0 ? mean : std::min(softer, mean);
    }
    return 50 * softer / (edges / static_cast<double>(count));
  }

  /// Soft springs along the axes on all corners of those parts of a pair that have no support: they catch what contact
  /// does not hold before it closes, or where it slides.
  void stabilise(const SurfacePair& p) {
    double area = 0;
    for (const TetFace f : surface(p.primary).faces) {
      const auto v = outward_nodes(model_.mesh, f);
      area += 0.5 * norm(cross(model_.mesh.points[v[1]] - model_.mesh.points[v[0]],
                               model_.mesh.points[v[2]] - model_.mesh.points[v[0]]));
    }
    const std::map<std::int32_t, int> held = supported_axes();
    const SolverSets& sets = model_.sets;
    for (const std::string& name : p.parts) {
      const auto part = static_cast<int>(std::find(sets.parts.begin(), sets.parts.end(), name) - sets.parts.begin());
      const bool is_held =
          std::any_of(held.begin(), held.end(), [&](const auto& h) { return sets.part_of_node[h.first] == part; });
      if (is_held) continue;
      std::set<std::int32_t> corners;
      for (std::size_t e = 0; e < model_.mesh.elements(); ++e)
        each_corner(model_.mesh, e, [&](std::int32_t v) {
          if (sets.part_of_node[v] == part) corners.insert(v);
        });
      SpringSet springs;
      springs.name = unique("stabilise_" + name);
      const double each = p.stabilise * p.stiffness_mpa_mm * area / static_cast<double>(corners.size());
      for (const std::int32_t v : corners)
        for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
          springs.springs.push_back({v, axis, each});
      model_.sets.springs.push_back(std::move(springs));
    }
  }

  /// Axes of each node that are supported: in all steps alike where it is tied.
  std::map<std::int32_t, int> supported_axes() const {
    std::map<std::int32_t, int> axes;  // bits
    for (const LoadStep& step : model_.sets.steps)
      for (const auto& [v, bits] : supported_axes(step)) axes[v] |= bits;
    return axes;
  }
  std::map<std::int32_t, int> supported_axes(const LoadStep& step) const {
    std::map<std::int32_t, int> axes;
    for (const Support& s : step.supports)
      for (const NodeSet& set : model_.sets.node_sets) {
        if (set.name != s.set) continue;
        for (const std::int32_t v : set.nodes)
          for (int axis = 0; axis < 3; ++axis)
            if (s.value_mm[axis]) axes[v] |= 1 << axis;
      }
    return axes;
  }
  /// A support that leaves out a tie in one step would leave the node free in another.
  void check_ties(const std::map<std::int32_t, int>& axes) const {
    std::set<std::int32_t> bound;
    for (const RigidPoint& p : model_.sets.points)
      for (const NodeSet& set : model_.sets.node_sets)
        if (set.name == p.set) bound.insert(set.nodes.begin(), set.nodes.end());
    for (const LoadStep& step : model_.sets.steps) {
      const std::map<std::int32_t, int> here = supported_axes(step);
      for (const auto& [v, bits] : axes) {
        const auto at = here.find(v);
        if ((at == here.end() ? 0 : at->second) != bits && is_follower_.count(v) > 0)
          fail_input("a node of tied parts is held in one step and free in another",
                     o_.path + ", load_case, " + step.name + ", node " + std::to_string(v + 1),
                     "hold the same sets in all steps where they reach tied faces, or choose sets away from them");
      }
    }
    for (const std::int32_t v : is_tied_)
      if (bound.count(v) > 0)
        fail_input("a node of tied parts is bound to a rigid point",
                   o_.path + ", load_case, points, node " + std::to_string(v + 1),
                   "choose a set away from the tied faces");
  }

  /// What two parts do to each other; those without a common face, that touch in points or along edges at most, do as
  /// all others.
  Contact between(int a, int b) const {
    for (const SurfacePair& p : model_.sets.pairs)
      if ((p.parts[0] == model_.sets.parts[a] && p.parts[1] == model_.sets.parts[b]) ||
          (p.parts[0] == model_.sets.parts[b] && p.parts[1] == model_.sets.parts[a]))
        return p.contact;
    return o_.others;
  }

  void tie() {
    SolverSets& sets = model_.sets;
    std::map<std::int32_t, std::vector<std::int32_t>> places;  // original node to its copies
    for (std::size_t v = 0; v < sets.original.size(); ++v)
      places[sets.original[v]].push_back(static_cast<std::int32_t>(v));
    const std::map<std::int32_t, int> axes = supported_axes();
    const auto held = [&](std::int32_t v) {
      return axes.count(v) > 0 ? __builtin_popcount(static_cast<unsigned>(axes.at(v))) : 0;
    };
    const std::size_t parts = sets.parts.size();
    std::vector<char> tied(parts * parts, 0);
    for (std::size_t a = 0; a < parts; ++a)
      for (std::size_t b = 0; b < parts; ++b)
        tied[a * parts + b] = a != b && between(static_cast<int>(a), static_cast<int>(b)) == Contact::tie;
    std::map<std::pair<int, int>, Tie> ties;  // part that follows, part that is followed
    for (auto& [original, copies] : places) {
      std::stable_sort(copies.begin(), copies.end(), [&](std::int32_t a, std::int32_t b) { return held(a) > held(b); });
      while (copies.size() > 1) {  // the first is followed by all that are tied to it, if only by way of others
        std::vector<std::int32_t> group = {copies[0]}, rest(copies.begin() + 1, copies.end());
        for (std::size_t i = 0; i < group.size(); ++i)
          for (std::size_t k = 0; k < rest.size();) {
            if (tied[sets.part_of_node[group[i]] * parts + sets.part_of_node[rest[k]]] == 0) {
              ++k;
              continue;
            }
            group.push_back(rest[k]);
            rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(k));
          }
        if (group.size() > 1) is_tied_.insert(group.begin(), group.end());
        is_follower_.insert(group.begin() + 1, group.end());
        for (std::size_t i = 1; i < group.size(); ++i) {
          Tie::Node node{group[i], group[0], {}};
          for (int axis = 0; axis < 3; ++axis)
            node.axes[axis] = axes.count(node.node) == 0 || (axes.at(node.node) >> axis & 1) == 0;
          if (held(node.node) < 3)
            ties[{sets.part_of_node[node.node], sets.part_of_node[node.followed]}].nodes.push_back(node);
        }
        copies = std::move(rest);
      }
    }
    check_ties(axes);
    for (auto& [ab, tie] : ties) {
      std::sort(tie.nodes.begin(), tie.nodes.end(),
                [](const Tie::Node& a, const Tie::Node& b) { return a.node < b.node; });
      tie.name = unique("tie_" + sets.parts[ab.first] + "_to_" + sets.parts[ab.second]);
      NodeSet set;
      set.name = tie.name;
      set.note = "nodes of part " + sets.parts[ab.first] + " that follow those at the same place of part " +
                 sets.parts[ab.second];
      for (const Tie::Node& n : tie.nodes) set.nodes.push_back(n.node);
      sets.node_sets.push_back(std::move(set));
      sets.ties.push_back(std::move(tie));
    }
  }

  std::string unique(const std::string& name) const {
    const auto taken = [&](const std::string& n) {
      const auto same = [&](const auto& s) { return lower_case(s.name) == lower_case(n); };
      return std::any_of(model_.sets.node_sets.begin(), model_.sets.node_sets.end(), same) ||
             std::any_of(model_.sets.springs.begin(), model_.sets.springs.end(), same);
    };
    std::string result = name;
    for (int n = 2; taken(result); ++n) result = name + "_" + std::to_string(n);
    return result;
  }

  SolverModel& model_;
  const JoinOptions& o_;
  std::set<std::int32_t> is_tied_, is_follower_;  // nodes that follow or are followed, and those that follow
};

}  // namespace

void join_parts(SolverModel& model, const JoinOptions& options) {
  Joiner(model, options).run();
}

}  // namespace stackmesh
