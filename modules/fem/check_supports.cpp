#include "fem/check_supports.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <set>

#include "base/disjoint_sets.h"
#include "base/error.h"
#include "fem/boundary_faces.h"

namespace stackmesh {
namespace {

constexpr double kNothing = 1e-11;  // of a pivot that was 1: what stands there when a motion is free
constexpr std::size_t kMostInAGroup = 300;

std::string number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", v);
  return text;
}
std::string text_of(Vec3 p) {
  for (double* c : {&p.x, &p.y, &p.z})
    if (std::abs(*c) < 5e-4) *c = 0;
  return "(" + number(p.x) + ", " + number(p.y) + ", " + number(p.z) + ")";
}

Vec3 axis_of(int axis) {
  return {axis == 0 ? 1.0 : 0, axis == 1 ? 1.0 : 0, axis == 2 ? 1.0 : 0};
}

/// Wedges hang together by their sides of four corners; their triangles are told to `visit`.
template <class Visit>
void join_wedges(const TetMesh& mesh, DisjointSets& joined, Visit visit) {
  std::map<std::array<std::int32_t, 4>, std::int32_t> first;
  for (std::size_t w = 0; w < mesh.wedges.size(); ++w) {
    const auto& v = mesh.wedges[w];
    const auto element = static_cast<std::int32_t>(mesh.tets.size() + w);
    for (const auto& f : kWedgeFaces) visit({v[f[0]], v[f[1]], v[f[2]]}, element);
    if (is_pyramid(v)) visit({v[1], v[2], v[4]}, element), visit({v[2], v[0], v[3]}, element);
    for (int k = 0; k < (is_pyramid(v) ? 1 : 3); ++k) {
      std::array<std::int32_t, 4> key = {v[k], v[(k + 1) % 3], v[3 + k], v[3 + (k + 1) % 3]};
      std::sort(key.begin(), key.end());
      const auto [at, fresh] = first.insert({key, element});
      if (!fresh) joined.join(at->second, element);
    }
  }
}

/// Which body each tet is of, numbered by first tet.
struct Bodies {
  std::vector<std::int32_t> of_tet;
  std::vector<Body> list;
  std::vector<double> size_mm;                     // half the diagonal of its box
  std::vector<std::vector<std::int32_t>> of_node;  // the bodies at a node, ascending

  explicit Bodies(const SolverModel& model) {
    const TetMesh& mesh = model.mesh;
    struct Side {
      std::array<std::int32_t, 3> key;
      std::int32_t tet;
    };
    std::vector<Side> sides;
    sides.reserve(4 * mesh.tets.size());
    for (std::size_t t = 0; t < mesh.tets.size(); ++t)
      for (const auto& face : kTetFaces) {
        Side s{{mesh.tets[t][face[0]], mesh.tets[t][face[1]], mesh.tets[t][face[2]]}, static_cast<std::int32_t>(t)};
        std::sort(s.key.begin(), s.key.end());
        sides.push_back(s);
      }
    DisjointSets joined(mesh.elements());
    join_wedges(mesh, joined, [&](std::array<std::int32_t, 3> key, std::int32_t element) {
      std::sort(key.begin(), key.end());
      sides.push_back({key, element});
    });
    std::sort(sides.begin(), sides.end(),
              [](const Side& a, const Side& b) { return a.key != b.key ? a.key < b.key : a.tet < b.tet; });
    for (std::size_t i = 0; i + 1 < sides.size(); ++i)
      if (sides[i].key == sides[i + 1].key) joined.join(sides[i].tet, sides[i + 1].tet);
    of_tet.assign(mesh.elements(), 0);
    std::map<std::int32_t, std::int32_t> number_of;
    std::vector<std::map<Label, double>> labels;
    std::vector<std::array<Vec3, 2>> boxes;
    of_node.resize(mesh.points.size());
    for (std::size_t t = 0; t < mesh.elements(); ++t) {
      const auto [at, fresh] =
          number_of.insert({joined.find(static_cast<std::int32_t>(t)), static_cast<std::int32_t>(list.size())});
      const std::int32_t b = of_tet[t] = at->second;
      const std::vector<std::array<std::int32_t, 4>> parts = tets_of_element(mesh, t);
      if (fresh) {
        list.emplace_back();
        labels.emplace_back();
        boxes.push_back({mesh.points[parts[0][0]], mesh.points[parts[0][0]]});
      }
      Body& body = list[b];
      ++body.tets;
      for (const auto& v : parts) {
        const Vec3 o = mesh.points[v[0]];
        const double volume =
            std::abs(dot(cross(mesh.points[v[1]] - o, mesh.points[v[2]] - o), mesh.points[v[3]] - o)) / 6;
        body.volume_mm3 += volume;
        labels[b][mesh.labels[t]] += volume;
        for (const std::int32_t k : v) body.centre = body.centre + (0.25 * volume) * mesh.points[k];
      }
      each_corner(mesh, t, [&](std::int32_t k) {
        const Vec3 p = mesh.points[k];
        Vec3 &low = boxes[b][0], &high = boxes[b][1];
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
      });
      const auto visit = [&](std::int32_t k) {
        std::vector<std::int32_t>& here = of_node[k];
        const auto place = std::lower_bound(here.begin(), here.end(), b);
        if (place == here.end() || *place != b) here.insert(place, b);
      };
      each_node(mesh, t, visit);
    }
    for (std::size_t b = 0; b < list.size(); ++b) {
      if (list[b].volume_mm3 > 0) list[b].centre = (1 / list[b].volume_mm3) * list[b].centre;
      size_mm.push_back(std::max(0.5 * norm(boxes[b][1] - boxes[b][0]), 1e-12));
      double most = -1;
      for (const auto& [label, volume] : labels[b])
        if (volume > most) {
          most = volume;
          list[b].label = label;
        }
      for (const LabelInfo& l : model.labels)
        if (l.number == list[b].label) list[b].name = l.name;
    }
  }
};

/// Something that moves as a whole: a body, or a rigid point; centre and size scale its rotations.
struct Mover {
  Vec3 centre;
  double size_mm = 1;
};

class Checker {
 public:
  Checker(const SolverModel& model, const std::string& path)
      : model_(model), sets_(model.sets), path_(path), bodies_(model) {
    for (std::size_t b = 0; b < bodies_.list.size(); ++b)
      movers_.push_back({bodies_.list[b].centre, bodies_.size_mm[b]});
    for (const RigidPoint& p : sets_.points) {
      double size = 1e-12;
      for (const std::int32_t v : nodes_of(p.set)) size = std::max(size, norm(model_.mesh.points[v] - p.at_mm));
      movers_.push_back({p.at_mm, size});
    }
  }

  void run() {
    for (const LoadStep& s : sets_.steps)
      if (s.analysis == Analysis::statics) step(s);
  }

 private:
  /// A velocity of one mover at a place along a direction, with a sign: a row of the constraints has one, or two of
  /// opposite signs.
  struct Term {
    std::int32_t mover;
    Vec3 at, along;
  };
  using Row = std::vector<Term>;

  const std::vector<std::int32_t>& nodes_of(const std::string& name) const {
    for (const NodeSet& s : sets_.node_sets)
      if (s.name == name) return s.nodes;
    fail_internal("a support names a set that is not there", name);
  }
  std::int32_t point_mover(std::int32_t point) const { return static_cast<std::int32_t>(bodies_.list.size()) + point; }

  void hold(std::vector<Row>& rows, std::int32_t node, Vec3 along) const {
    rows.push_back({{bodies_.of_node[node][0], model_.mesh.points[node], along}});
  }
  void join(std::vector<Row>& rows, std::int32_t a, std::int32_t b, Vec3 at, Vec3 along) const {
    if (a != b) rows.push_back({{a, at, along}, {b, at, -1.0 * along}});
  }

  /// What holds in every step.
  std::vector<Row> joints() const {
    std::vector<Row> rows;
    const std::vector<Vec3>& points = model_.mesh.points;
    for (std::size_t v = 0; v < points.size(); ++v)
      for (std::size_t k = 1; k < bodies_.of_node[v].size(); ++k)
        for (int axis = 0; axis < 3; ++axis)
          join(rows, bodies_.of_node[v][0], bodies_.of_node[v][k], points[v], axis_of(axis));
    for (const Tie& t : sets_.ties)
      for (const Tie::Node& n : t.nodes)
        for (int axis = 0; axis < 3; ++axis)
          if (n.axes[axis])
            join(rows, bodies_.of_node[n.node][0], bodies_.of_node[n.followed][0], points[n.node], axis_of(axis));
    for (const SpringSet& s : sets_.springs)
      for (const GroundSpring& g : s.springs) hold(rows, g.node, g.direction);
    for (std::size_t p = 0; p < sets_.points.size(); ++p)
      for (const std::int32_t v : nodes_of(sets_.points[p].set))
        for (int axis = 0; axis < 3; ++axis)
          join(rows, bodies_.of_node[v][0], point_mover(static_cast<std::int32_t>(p)), points[v], axis_of(axis));
    for (const SurfacePair& pair : sets_.pairs)
      if (pair.contact == Contact::contact) contact(pair, rows);
    return rows;
  }

  /// Each node of a pair's first surface against the one at the same place of the second one.
  void contact(const SurfacePair& pair, std::vector<Row>& rows) const {
    std::map<std::int32_t, std::int32_t> other;  // by the node that both were
    for (const std::int32_t v : nodes_of(pair.secondary)) other[sets_.original[v]] = v;
    std::map<std::int32_t, Vec3> normals;
    for (const FaceSet& s : sets_.surfaces) {
      if (s.name != pair.primary) continue;
      for (const TetFace f : s.faces) {
        const auto v = outward_nodes(model_.mesh, f);
        const Vec3 n = cross(model_.mesh.points[v[1]] - model_.mesh.points[v[0]],
                             model_.mesh.points[v[2]] - model_.mesh.points[v[0]]);
        for (const std::int32_t k : v)
          if (k >= 0) normals[k] = normals[k] + n;
      }
    }
    for (const auto& [v, n] : normals) {
      const auto twin = other.find(sets_.original[v]);
      if (twin == other.end() || !(norm(n) > 0)) continue;
      const std::int32_t a = bodies_.of_node[v][0], b = bodies_.of_node[twin->second][0];
      if (pair.friction > 0)
        for (int axis = 0; axis < 3; ++axis) join(rows, a, b, model_.mesh.points[v], axis_of(axis));
      else join(rows, a, b, model_.mesh.points[v], (1 / norm(n)) * n);
    }
  }

  void step(const LoadStep& step) const {
    std::vector<Row> rows = joints();
    for (const Support& s : step.supports)
      for (const std::int32_t v : nodes_of(s.set))
        for (int axis = 0; axis < 3; ++axis)
          if (s.value_mm[axis]) hold(rows, v, axis_of(axis));
    // Rotations of a point are held by two places beside it.
    for (const PointSupport& s : step.point_supports) {
      const Mover& m = movers_[point_mover(s.point)];
      for (int axis = 0; axis < 3; ++axis) {
        if (s.value[axis]) rows.push_back({{point_mover(s.point), m.centre, axis_of(axis)}});
        if (!s.value[axis + 3]) continue;
        // the place at the arm goes along by the rotation
        const Vec3 arm = m.size_mm * axis_of((axis + 1) % 3), along = axis_of((axis + 2) % 3);
        rows.push_back({{point_mover(s.point), m.centre + arm, along}, {point_mover(s.point), m.centre, -1.0 * along}});
      }
    }
    DisjointSets groups(movers_.size());
    for (const Row& r : rows)
      for (const Term& t : r) groups.join(r[0].mover, t.mover);
    std::map<std::int32_t, std::vector<std::int32_t>> members;
    for (std::size_t m = 0; m < movers_.size(); ++m)
      members[groups.find(static_cast<std::int32_t>(m))].push_back(static_cast<std::int32_t>(m));
    std::map<std::int32_t, std::vector<const Row*>> rows_of;
    for (const Row& r : rows) rows_of[groups.find(r[0].mover)].push_back(&r);
    std::map<std::int32_t, std::string> loose;  // body, and how it can move
    for (const auto& [root, list] : members)
      if (list.size() <= kMostInAGroup) find_motions(list, rows_of[root], loose);
    if (!loose.empty()) refuse(step, loose);
  }

  /// Coefficients of a term for its mover's three displacements, and its three rotations times its size.
  std::array<double, 6> coefficients(const Term& t) const {
    const Mover& m = movers_[t.mover];
    const Vec3 turn = (1 / m.size_mm) * cross(t.at - m.centre, t.along);
    return {t.along.x, t.along.y, t.along.z, turn.x, turn.y, turn.z};
  }

  /// The motions that no row hinders: zero pivots of the rows' normal matrix.
  void find_motions(const std::vector<std::int32_t>& list, const std::vector<const Row*>& rows,
                    std::map<std::int32_t, std::string>& loose) const {
    const std::size_t n = 6 * list.size();
    std::map<std::int32_t, std::size_t> place;
    for (std::size_t i = 0; i < list.size(); ++i) place[list[i]] = 6 * i;
    std::vector<double> a(n * n, 0);
    for (const Row* row : rows)
      for (const Term& s : *row)
        for (const Term& t : *row) {
          const auto x = coefficients(s), y = coefficients(t);
          const std::size_t i0 = place[s.mover], k0 = place[t.mover];
          for (int i = 0; i < 6; ++i)
            for (int k = 0; k < 6; ++k) a[(i0 + i) * n + k0 + k] += x[i] * y[k];
        }
    std::vector<double> scale(n, 0);
    for (std::size_t i = 0; i < n; ++i) scale[i] = a[i * n + i] > 0 ? 1 / std::sqrt(a[i * n + i]) : 0;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = 0; k < n; ++k) a[i * n + k] *= scale[i] * scale[k];
    // Elimination with the largest pivot first; what is left when pivots vanish can move.
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), 0);
    std::size_t rank = 0;
    for (; rank < n; ++rank) {
      std::size_t best = rank;
      for (std::size_t i = rank; i < n; ++i)
        if (a[order[i] * n + order[i]] > a[order[best] * n + order[best]]) best = i;
      std::swap(order[rank], order[best]);
      const std::size_t p = order[rank];
      if (!(a[p * n + p] > kNothing)) break;
      for (std::size_t i = rank + 1; i < n; ++i) {
        const std::size_t r = order[i];
        const double factor = a[r * n + p] / a[p * n + p];
        if (factor == 0) continue;
        for (std::size_t k = rank; k < n; ++k) a[r * n + order[k]] -= factor * a[p * n + order[k]];
      }
    }
    for (std::size_t free = rank; free < n; ++free) {
      std::vector<double> motion(n, 0);
      motion[order[free]] = 1;
      for (std::size_t i = rank; i-- > 0;) {
        double sum = a[order[i] * n + order[free]];
        for (std::size_t k = i + 1; k < rank; ++k) sum += a[order[i] * n + order[k]] * motion[order[k]];
        motion[order[i]] = -sum / a[order[i] * n + order[i]];
      }
      for (std::size_t i = 0; i < n; ++i)
        if (scale[i] > 0) motion[i] *= scale[i];
      double most = 0;
      for (const double m : motion) most = std::max(most, std::abs(m));
      for (const std::int32_t mover : list) {
        if (mover >= static_cast<std::int32_t>(bodies_.list.size())) continue;
        const double* const m = &motion[place[mover]];
        const Vec3 shift = {m[0], m[1], m[2]}, turn = {m[3], m[4], m[5]};
        if (std::max(norm(shift), norm(turn)) < 1e-3 * most) continue;
        loose.insert({mover, norm(turn) > 1e-6 * norm(shift) ? "turn about " + text_of((1 / norm(turn)) * turn)
                                                             : "move along " + text_of((1 / norm(shift)) * shift)});
      }
    }
  }

  std::set<std::int32_t> loaded_bodies(const LoadStep& step) const {
    std::set<std::int32_t> loaded;
    for (const auto& [v, force] : step.forces_n) loaded.insert(bodies_.of_node[v][0]);
    for (const PointLoad& l : step.point_loads)
      for (const std::int32_t v : nodes_of(sets_.points[l.point].set)) loaded.insert(bodies_.of_node[v][0]);
    for (const Pressure& p : step.pressures)
      for (const FaceSet& s : sets_.surfaces)
        if (s.name == p.set)
          for (const TetFace f : s.faces) loaded.insert(bodies_.of_tet[f.tet]);
    if (norm(step.gravity_mm_s2) > 0)
      for (std::size_t b = 0; b < bodies_.list.size(); ++b) loaded.insert(static_cast<std::int32_t>(b));
    return loaded;
  }

  [[noreturn]] void refuse(const LoadStep& step, const std::map<std::int32_t, std::string>& loose) const {
    const std::set<std::int32_t> loaded = loaded_bodies(step);
    std::vector<std::int32_t> order;
    for (const auto& [b, how] : loose) order.push_back(b);
    std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
      if (loaded.count(a) != loaded.count(b)) return loaded.count(a) > loaded.count(b);
      return bodies_.list[a].volume_mm3 > bodies_.list[b].volume_mm3;
    });
    std::string pieces;
    constexpr std::size_t kMost = 5;
    for (std::size_t i = 0; i < std::min(order.size(), kMost); ++i) {
      const Body& b = bodies_.list[order[i]];
      pieces += (i > 0 ? "; " : "") + std::string("piece of label ") + std::to_string(b.label) + " (" + b.name +
                ") of " + std::to_string(b.tets) + " elements and " + number(b.volume_mm3) + " mm3 at " +
                text_of(b.centre) + (loaded.count(order[i]) > 0 ? ", loaded" : "") + ": it can " + loose.at(order[i]);
    }
    if (order.size() > kMost) pieces += "; and " + std::to_string(order.size() - kMost) + " more";
    const bool whole = bodies_.list.size() == 1;
    fail_input(whole ? std::string("the body is not supported against rigid motion, so the deck would be singular")
                     : std::to_string(order.size()) + " of " + std::to_string(bodies_.list.size()) +
                           " bodies are not supported against rigid motion, so the deck would be singular",
               path_ + ", load_case, " + step.name + ", " + pieces,
               whole ? "hold it along more axes or on more faces (\"fixed\", \"springs\")"
                     : "leave loose pieces out (--keep-largest, --min-piece), or hold each of them (\"fixed\", "
                       "\"springs\"); contact without friction "
                       "holds nothing along its faces");
  }

  const SolverModel& model_;
  const SolverSets& sets_;
  const std::string& path_;
  const Bodies bodies_;
  std::vector<Mover> movers_;
};

}  // namespace

std::vector<Body> bodies_of(const SolverModel& model) {
  std::vector<Body> list = Bodies(model).list;
  std::stable_sort(list.begin(), list.end(), [](const Body& a, const Body& b) { return a.volume_mm3 > b.volume_mm3; });
  return list;
}

void check_supports(const SolverModel& model, const std::string& path) {
  const bool any = std::any_of(model.sets.steps.begin(), model.sets.steps.end(),
                               [](const LoadStep& s) { return s.analysis == Analysis::statics; });
  if (any) Checker(model, path).run();
}

}  // namespace stackmesh
