#include "meshio/nastran_steps.h"

#include <algorithm>

namespace stackmesh {

NastranSteps::NastranSteps(OutputBuffer& out, const PreparedMesh& mesh)
    : FixedFields(out), mesh_(mesh), sets_(mesh.sets) {
  const bool frequency = std::any_of(sets_.steps.begin(), sets_.steps.end(),
                                     [](const LoadStep& s) { return s.analysis == Analysis::frequency; });
  for (const LoadStep& s : sets_.steps)
    if (frequency == (s.analysis == Analysis::frequency)) steps_.push_back(&s);
}

int NastranSteps::solution() const {
  bool large = sets_.is_hyperelastic() && !steps_.empty();
  for (const LoadStep* s : steps_) {
    if (s->analysis == Analysis::frequency) return 103;
    large = large || s->large_displacements;
  }
  return large ? 106 : 101;
}

void NastranSteps::case_control() {
  if (steps_.empty()) return;
  const int sol = solution();
  out_ << "DISPLACEMENT = ALL\n";
  if (sol != 103) out_ << "STRESS = ALL\n";
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    const LoadStep& s = *steps_[k];
    out_ << "SUBCASE " << k + 1 << '\n';
    if (steps_.size() > 1) out_ << "  LABEL = " << s.name.substr(0, 60) << '\n';
    if (!s.supports.empty() || !s.point_supports.empty()) out_ << "  SPC = " << id(k, 1) << '\n';
    if (sol == 103) out_ << "  METHOD = " << id(k, 5) << '\n';
    else if (has_load(s)) out_ << "  LOAD = " << id(k, norm(s.gravity_mm_s2) > 0 ? 4 : 2) << '\n';
    if (sol == 106) out_ << "  NLPARM = " << id(k, 6) << '\n';
  }
}

void NastranSteps::bulk(std::int64_t& number, std::int64_t& property) {
  if (solution() == 106) out_ << "PARAM   LGDISP         1\n";
  points(number);
  springs(number, property);
  for (std::size_t k = 0; k < steps_.size(); ++k) step(k);
}

bool NastranSteps::moves(const LoadStep& step) const {
  const auto any = [](const auto& values) {
    return std::any_of(values.begin(), values.end(), [](const auto& v) { return v && *v != 0; });
  };
  return std::any_of(step.supports.begin(), step.supports.end(), [&](const Support& s) { return any(s.value_mm); }) ||
         std::any_of(step.point_supports.begin(), step.point_supports.end(),
                     [&](const PointSupport& s) { return any(s.value); });
}

/// Rigid points: a node each, and a rigid element on which the nodes of its set depend.
void NastranSteps::points(std::int64_t& number) {
  for (std::size_t p = 0; p < sets_.points.size(); ++p) {
    const RigidPoint& point = sets_.points[p];
    const std::int64_t node = point_node(static_cast<std::int32_t>(p)) + 1;
    out_ << "$ " << point.name << ": set " << point.set << " is bound to it as a rigid body\nGRID*   ";
    large(node);
    padded("", 16);
    large(point.at_mm.x);
    large(point.at_mm.y);
    out_ << "\n*       ";
    large(point.at_mm.z);
    out_ << "\nRBE2    ";
    small(++number);
    small(node);
    padded("123", 8);
    std::size_t field = 3;
    for (const std::int32_t v : nodes_of(point.set)) {
      if (field == 8) {
        out_ << "+       \n+       ";
        field = 0;
      }
      small(static_cast<std::int64_t>(v) + 1);
      ++field;
    }
    out_ << '\n';
  }
}

/// Springs along an axis are scalar ones to the ground; along other directions rods to a far node that is held.
void NastranSteps::springs(std::int64_t& number, std::int64_t& property) {
  if (sets_.springs.empty()) return;
  Vec3 low = mesh_.points[0], high = low;
  for (const Vec3 p : mesh_.points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const double far = 2 * norm(high - low);
  std::int64_t ground = point_node(static_cast<std::int32_t>(sets_.points.size())), rod_material = 0;
  for (const SpringSet& s : sets_.springs) {
    out_ << "$ " << s.name << ": N/mm, by each node's share of the area\n";
    for (const GroundSpring& g : s.springs) {
      const int axis = std::abs(g.direction.x) == 1   ? 1
                       : std::abs(g.direction.y) == 1 ? 2
                       : std::abs(g.direction.z) == 1 ? 3
                                                      : 0;
      if (axis > 0) {
        out_ << "CELAS2* ";
        large(++number);
        large(g.n_per_mm);
        large(static_cast<std::int64_t>(g.node) + 1);
        large(static_cast<std::int64_t>(axis));
        out_ << "\n*       \n";
        continue;
      }
      if (rod_material == 0) {
        rod_material = ++property;
        out_ << "MAT1*   ";
        large(rod_material);
        large(1.0);
        padded("", 16);
        large(0.0);
        out_ << "\n*       ";
        large(0.0);
        out_ << '\n';
      }
      const Vec3 p = mesh_.points[g.node] + far * g.direction;
      out_ << "GRID*   ";
      large(++ground);
      padded("", 16);
      large(p.x);
      large(p.y);
      out_ << "\n*       ";
      large(p.z);
      padded("", 16);
      padded("123456", 16);
      out_ << "\nCONROD* ";
      large(++number);
      large(static_cast<std::int64_t>(g.node) + 1);
      large(ground);
      large(rod_material);
      out_ << "\n*       ";
      large(g.n_per_mm * far);
      out_ << '\n';
    }
  }
}

/// SPC1 holds degrees of freedom; a displacement that is not 0 is an SPCD beside it.
void NastranSteps::step(std::size_t k) {
  const LoadStep& s = *steps_[k];
  const std::int64_t spc = id(k, 1), load = id(k, 2);
  for (const Support& support : s.supports) {
    const std::vector<std::int32_t>& nodes = nodes_of(support.set);
    std::string axes;
    for (int axis = 0; axis < 3; ++axis)
      if (support.value_mm[axis]) axes += static_cast<char>('1' + axis);
    hold(spc, axes, nodes);
    for (int axis = 0; axis < 3; ++axis)
      if (support.value_mm[axis] && *support.value_mm[axis] != 0)
        for (const std::int32_t v : nodes) move(load, v, axis, *support.value_mm[axis]);
  }
  for (const PointSupport& support : s.point_supports) {
    std::string axes;
    for (int axis = 0; axis < 6; ++axis)
      if (support.value[axis]) axes += static_cast<char>('1' + axis);
    hold(spc, axes, {point_node(support.point)});
    for (int axis = 0; axis < 6; ++axis)
      if (support.value[axis] && *support.value[axis] != 0)
        move(load, point_node(support.point), axis, *support.value[axis]);
  }
  if (solution() == 103) {
    out_ << "EIGRL   ";
    small(id(k, 5));
    padded("", 16);
    small(s.modes);
    out_ << '\n';
    return;
  }
  for (const auto& [node, force] : s.forces_n) vector("FORCE*  ", load, static_cast<std::int64_t>(node) + 1, force);
  for (const PointLoad& l : s.point_loads) {
    if (norm(l.force_n) > 0) vector("FORCE*  ", load, point_node(l.point) + 1, l.force_n);
    if (norm(l.moment_nmm) > 0) vector("MOMENT* ", load, point_node(l.point) + 1, l.moment_nmm);
  }
  for (const Pressure& p : s.pressures) pressure(load, p);
  if (norm(s.gravity_mm_s2) > 0) {  // of a number of its own, then both are added
    out_ << "GRAV*   ";
    large(id(k, 3));
    large(std::int64_t{0});
    large(norm(s.gravity_mm_s2));
    large(s.gravity_mm_s2.x / norm(s.gravity_mm_s2));
    out_ << "\n*       ";
    large(s.gravity_mm_s2.y / norm(s.gravity_mm_s2));
    large(s.gravity_mm_s2.z / norm(s.gravity_mm_s2));
    out_ << '\n';
    const bool others = !s.forces_n.empty() || !s.point_loads.empty() || !s.pressures.empty() || moves(s);
    out_ << "LOAD*   ";
    large(id(k, 4));
    large(1.0);
    large(1.0);
    large(id(k, 3));
    out_ << "\n*       ";
    if (others) {
      large(1.0);
      large(load);
    }
    out_ << '\n';
  }
  if (solution() == 106) {
    out_ << "NLPARM  ";
    small(id(k, 6));
    small(s.increments > 0 ? s.increments : 10);
    out_ << '\n';
  }
}

void NastranSteps::hold(std::int64_t set, const std::string& axes, const std::vector<std::int32_t>& nodes) {
  for (std::size_t i = 0; i < nodes.size(); i += 6) {
    out_ << "SPC1    ";
    small(set);
    padded(axes, 8);
    for (std::size_t n = i; n < std::min(i + 6, nodes.size()); ++n) small(static_cast<std::int64_t>(nodes[n]) + 1);
    out_ << '\n';
  }
}

void NastranSteps::move(std::int64_t set, std::int32_t node, int axis, double value) {
  out_ << "SPCD*   ";
  large(set);
  large(static_cast<std::int64_t>(node) + 1);
  large(static_cast<std::int64_t>(axis) + 1);
  large(value);
  out_ << "\n*       \n";
}

void NastranSteps::vector(const char* card, std::int64_t set, std::int64_t node, Vec3 value) {
  out_ << card;
  large(set);
  large(node);
  large(std::int64_t{0});
  large(1.0);
  out_ << "\n*       ";
  large(value.x);
  large(value.y);
  large(value.z);
  out_ << '\n';
}

/// On triangles of wedges: G1 a corner of the face; of pyramids: both corners of the base's edge, inwards. On faces of
/// tetrahedra: G1 a corner of the face, G4 the corner that is not on it. A pressure above 0 presses inwards.
void NastranSteps::pressure(std::int64_t set, const Pressure& p) {
  // Two corners of the element tell which of its faces: one on it, and the opposite one, or of a pyramid its diagonal
  // one (-1: a wedge needs the first only).
  const auto card = [&](TetFace f, std::int32_t on, std::int32_t opposite) {
    out_ << "PLOAD4* ";
    large(set);
    large(static_cast<std::int64_t>(f.tet) + 1);
    large(p.mpa);
    padded("", 16);
    out_ << "\n*       ";
    padded("", 32);
    large(static_cast<std::int64_t>(on) + 1);
    if (opposite >= 0) large(static_cast<std::int64_t>(opposite) + 1);
    out_ << '\n';
  };
  for (const FaceSet& s : sets_.surfaces) {
    if (s.name != p.set) continue;
    for (const TetFace f : s.faces) {
      if (static_cast<std::size_t>(f.tet) >= mesh_.tets.size()) {
        const auto& wedge = mesh_.wedges[static_cast<std::size_t>(f.tet) - mesh_.tets.size()];
        card(f,
             wedge[f.face == 0         ? 0
                   : is_pyramid(wedge) ? 4
                                       : 3],
             is_pyramid(wedge) ? wedge[f.face == 0 ? 1 : 3] : -1);
        continue;
      }
      const auto& tet = mesh_.tets[f.tet];
      const auto& face = kTetFaces[f.face];
      std::int32_t opposite = -1;
      for (const std::int32_t v : tet)
        if (v != tet[face[0]] && v != tet[face[1]] && v != tet[face[2]]) opposite = v;
      card(f, tet[face[0]], opposite);
    }
  }
}

}  // namespace stackmesh
