#include "meshio/febio_steps.h"

#include <algorithm>
#include <map>

namespace stackmesh {
namespace {

constexpr const char* kAxes = "xyz";
constexpr const char* kTurns = "uvw";

bool same(Vec3 a, Vec3 b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}
bool same_forces(const LoadStep& a, const LoadStep& b) {
  return a.forces_n.size() == b.forces_n.size() &&
         std::equal(a.forces_n.begin(), a.forces_n.end(), b.forces_n.begin(),
                    [](const auto& x, const auto& y) { return x.first == y.first && same(x.second, y.second); });
}

double pressure_on(const LoadStep* step, const std::string& set) {
  double sum = 0;
  if (step != nullptr)
    for (const Pressure& p : step->pressures) sum += p.set == set ? p.mpa : 0;
  return sum;
}
PointLoad load_on(const LoadStep* step, std::int32_t point) {
  if (step != nullptr)
    for (const PointLoad& l : step->point_loads)
      if (l.point == point) return l;
  return {point, {}, {}};
}

}  // namespace

FebioSteps::FebioSteps(OutputBuffer& out, const PreparedMesh& mesh) : out_(out), mesh_(mesh), sets_(mesh.sets) {
  for (const LoadStep& s : sets_.steps)
    if (s.analysis == Analysis::statics) steps_.push_back(&s);
  // Springs of one stiffness share a set; each reaches to a node of its own, far away, which is held.
  std::size_t number = mesh.points.size();
  for (const SpringSet& s : sets_.springs) {
    std::map<double, std::vector<const GroundSpring*>> alike;
    for (const GroundSpring& g : s.springs) alike[g.n_per_mm].push_back(&g);
    int n = 0;
    for (auto& [stiffness, list] : alike) {
      grounds_.push_back({s.name + "_" + std::to_string(++n), std::move(list), number + 1});
      number += grounds_.back().springs.size();
    }
  }
}

bool FebioSteps::has_friction() const {
  return std::any_of(sets_.pairs.begin(), sets_.pairs.end(),
                     [](const SurfacePair& p) { return p.contact == Contact::contact && p.friction > 0; });
}

void FebioSteps::control() {
  if (steps_.size() > 1) return;
  write_control(steps_.empty() ? LoadStep() : *steps_[0]);
}

void FebioSteps::write_control(const LoadStep& step) {
  const bool nonlinear = step.large_displacements || sets_.is_hyperelastic() || sets_.has_contact();
  const int increments = step.increments > 0 ? step.increments : nonlinear ? 10 : 1;
  out_ << "<Control>\n<analysis>STATIC</analysis>\n<time_steps>" << increments << "</time_steps>\n<step_size>"
       << 1.0 / increments << "</step_size>\n<solver type=\"solid\">\n<symmetric_stiffness>"
       << (has_friction() ? "non-symmetric" : "symmetric") << "</symmetric_stiffness>\n</solver>\n</Control>\n";
}

void FebioSteps::ground_nodes(const std::function<void(std::size_t number, Vec3 at)>& write) {
  if (grounds_.empty()) return;
  Vec3 low = mesh_.points[0], high = low;
  for (const Vec3 p : mesh_.points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const double far = 2 * norm(high - low);
  for (const Ground& g : grounds_)
    for (std::size_t i = 0; i < g.springs.size(); ++i)
      write(g.first + i, mesh_.points[g.springs[i]->node] + far * g.springs[i]->direction);
}

bool FebioSteps::has_forces() const {
  return std::any_of(steps_.begin(), steps_.end(), [](const LoadStep* s) { return !s->forces_n.empty(); });
}

/// The names of a step's node set and map: of one step alone without a number.
static std::string numbered(const char* name, std::size_t k, std::size_t steps) {
  return steps > 1 ? name + ("_" + std::to_string(k + 1)) : std::string(name);
}

void FebioSteps::node_sets(
    const std::function<void(const std::string& name, const std::vector<std::int32_t>& nodes)>& write) {
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    if (steps_[k]->forces_n.empty()) continue;
    std::vector<std::int32_t> nodes;
    for (const auto& [node, force] : steps_[k]->forces_n) nodes.push_back(node);
    write(numbered("loaded_nodes", k, steps_.size()), nodes);
  }
  if (grounds_.empty()) return;
  std::vector<std::int32_t> ground;
  for (const Ground& g : grounds_)
    for (std::size_t i = 0; i < g.springs.size(); ++i) ground.push_back(static_cast<std::int32_t>(g.first + i) - 1);
  write("springs_ground", ground);
}

void FebioSteps::discrete_sets() {
  for (const Ground& g : grounds_) {
    out_ << "<DiscreteSet name=\"" << g.set << "\">\n";
    for (std::size_t i = 0; i < g.springs.size(); ++i)
      out_ << "<delem>" << g.springs[i]->node + 1 << ',' << g.first + i << "</delem>\n";
    out_ << "</DiscreteSet>\n";
  }
}

void FebioSteps::springs() {
  if (grounds_.empty()) return;
  out_ << "<Discrete>\n";
  for (std::size_t i = 0; i < grounds_.size(); ++i)
    out_ << "<discrete_material id=\"" << i + 1 << "\" name=\"K_" << grounds_[i].set
         << "\" type=\"linear spring\">\n<E>" << grounds_[i].springs[0]->n_per_mm << "</E>\n</discrete_material>\n";
  for (std::size_t i = 0; i < grounds_.size(); ++i)
    out_ << "<discrete dmat=\"" << i + 1 << "\" discrete_set=\"" << grounds_[i].set << "\"/>\n";
  out_ << "</Discrete>\n";
}

void FebioSteps::node_data() {
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    const auto& forces = steps_[k]->forces_n;
    if (forces.empty()) continue;
    out_ << "<NodeData name=\"" << numbered("nodal_forces", k, steps_.size()) << "\" node_set=\""
         << numbered("loaded_nodes", k, steps_.size()) << "\" data_type=\"vec3\">\n";
    for (std::size_t i = 0; i < forces.size(); ++i) {
      const Vec3 f = forces[i].second;
      out_ << "<node lid=\"" << i + 1 << "\">" << f.x << ',' << f.y << ',' << f.z << "</node>\n";
    }
    out_ << "</NodeData>\n";
  }
}

/// The curve that goes from one share to another during a step; its number.
int FebioSteps::curve(std::size_t k, double from, double to) {
  const std::array<double, 4> ends = {static_cast<double>(k), from, static_cast<double>(k + 1), to};
  for (std::size_t i = 0; i < curves_.size(); ++i)
    if (curves_[i] == ends) return static_cast<int>(i) + 1;
  curves_.push_back(ends);
  return static_cast<int>(curves_.size());
}

void FebioSteps::load_curves() {
  if (curves_.empty()) return;
  out_ << "<LoadData>\n";
  for (std::size_t i = 0; i < curves_.size(); ++i)
    out_ << "<load_controller id=\"" << i + 1
         << "\" type=\"loadcurve\">\n<interpolate>LINEAR</interpolate>\n<extend>CONSTANT</extend>\n<points>\n<pt>"
         << curves_[i][0] << ',' << curves_[i][1] << "</pt>\n<pt>" << curves_[i][2] << ',' << curves_[i][3]
         << "</pt>\n</points>\n</load_controller>\n";
  out_ << "</LoadData>\n";
}

void FebioSteps::acting() {
  if (steps_.size() == 1) write_acting(0);
}

void FebioSteps::further() {
  if (steps_.size() < 2) return;
  out_ << "<Step>\n";
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    out_ << "<step id=\"" << k + 1 << "\" name=\"step_" << k + 1 << "\">\n";
    write_control(*steps_[k]);
    write_acting(k);
    out_ << "</step>\n";
  }
  out_ << "</Step>\n";
}

void FebioSteps::write_acting(std::size_t k) {
  boundary(k);
  rigid(k);
  loads(k);
}

void FebioSteps::section(const char* name, bool& open) {
  if (!open) out_ << '<' << name << ">\n";
  open = true;
}

void FebioSteps::boundary(std::size_t k) {
  bool open = false;
  const LoadStep& step = *steps_[k];
  for (const Support& s : step.supports) {
    std::array<double, 3> before{};  // where the same set was moved to
    if (k > 0)
      for (const Support& b : steps_[k - 1]->supports)
        if (b.set == s.set)
          for (int axis = 0; axis < 3; ++axis)
            if (b.value_mm[axis]) before[axis] = *b.value_mm[axis];
    const auto stays = [&](int axis) { return s.value_mm[axis] && *s.value_mm[axis] == 0 && before[axis] == 0; };
    if (stays(0) || stays(1) || stays(2)) {
      section("Boundary", open);
      out_ << "<bc name=\"fixed_" << ++bcs_ << "\" node_set=\"" << s.set << "\" type=\"zero displacement\">\n";
      for (int axis = 0; axis < 3; ++axis)
        out_ << '<' << kAxes[axis] << "_dof>" << (stays(axis) ? '1' : '0') << "</" << kAxes[axis] << "_dof>\n";
      out_ << "</bc>\n";
    }
    for (int axis = 0; axis < 3; ++axis) {
      if (!s.value_mm[axis] || stays(axis)) continue;
      const double to = *s.value_mm[axis], full = to != 0 ? to : before[axis];
      section("Boundary", open);
      out_ << "<bc name=\"moved_" << ++bcs_ << "\" node_set=\"" << s.set
           << "\" type=\"prescribed displacement\">\n<dof>" << kAxes[axis] << "</dof>\n<value lc=\""
           << curve(k, before[axis] / full, to / full) << "\">" << full << "</value>\n<relative>0</relative>\n</bc>\n";
    }
  }
  if (!grounds_.empty()) {
    section("Boundary", open);
    out_ << "<bc name=\"fixed_" << ++bcs_
         << "\" node_set=\"springs_ground\" type=\"zero "
            "displacement\">\n<x_dof>1</x_dof>\n<y_dof>1</y_dof>\n<z_dof>1</z_dof>\n</bc>\n";
  }
  for (const RigidPoint& p : sets_.points) {
    section("Boundary", open);
    out_ << "<bc name=\"bound_" << ++bcs_ << "\" node_set=\"" << p.set << "\" type=\"rigid\">\n<rb>" << p.name
         << "</rb>\n</bc>\n";
  }
  if (open) out_ << "</Boundary>\n";
}

void FebioSteps::rigid(std::size_t k) {
  bool open = false;
  const LoadStep& step = *steps_[k];
  const LoadStep* const before = k > 0 ? steps_[k - 1] : nullptr;
  for (const PointSupport& s : step.point_supports) {
    const std::string& name = sets_.points[s.point].name;
    std::array<double, 6> was{};
    if (before != nullptr)
      for (const PointSupport& b : before->point_supports)
        if (b.point == s.point)
          for (int axis = 0; axis < 6; ++axis)
            if (b.value[axis]) was[axis] = *b.value[axis];
    const auto stays = [&](int axis) { return s.value[axis] && *s.value[axis] == 0 && was[axis] == 0; };
    bool any = false;
    for (int axis = 0; axis < 6; ++axis) any = any || stays(axis);
    if (any) {
      section("Rigid", open);
      out_ << "<rigid_bc name=\"rigid_" << ++bcs_ << "\" type=\"rigid_fixed\">\n<rb>" << name << "</rb>\n";
      for (int axis = 0; axis < 6; ++axis) {
        const char letter = axis < 3 ? kAxes[axis] : kTurns[axis - 3];
        out_ << "<R" << letter << "_dof>" << (stays(axis) ? '1' : '0') << "</R" << letter << "_dof>\n";
      }
      out_ << "</rigid_bc>\n";
    }
    for (int axis = 0; axis < 6; ++axis) {
      if (!s.value[axis] || stays(axis)) continue;
      const double to = *s.value[axis], full = to != 0 ? to : was[axis];
      section("Rigid", open);
      out_ << "<rigid_bc name=\"rigid_" << ++bcs_ << "\" type=\""
           << (axis < 3 ? "rigid_displacement" : "rigid_rotation") << "\">\n<rb>" << name << "</rb>\n<dof>";
      if (axis < 3) out_ << kAxes[axis];
      else out_ << 'R' << kTurns[axis - 3];
      out_ << "</dof>\n<value lc=\"" << curve(k, was[axis] / full, to / full) << "\">" << full
           << "</value>\n<relative>0</relative>\n</rigid_bc>\n";
    }
  }
  for (std::size_t p = 0; p < sets_.points.size(); ++p) {
    const PointLoad now = load_on(&step, static_cast<std::int32_t>(p)),
                    was = load_on(before, static_cast<std::int32_t>(p));
    const double to[6] = {now.force_n.x,    now.force_n.y,    now.force_n.z,
                          now.moment_nmm.x, now.moment_nmm.y, now.moment_nmm.z};
    const double from[6] = {was.force_n.x,    was.force_n.y,    was.force_n.z,
                            was.moment_nmm.x, was.moment_nmm.y, was.moment_nmm.z};
    for (int axis = 0; axis < 6; ++axis) {
      if (to[axis] == 0 && from[axis] == 0) continue;
      const double full = to[axis] != 0 ? to[axis] : from[axis];
      section("Rigid", open);
      out_ << "<rigid_load name=\"rigid_" << ++bcs_ << "\" type=\"" << (axis < 3 ? "rigid_force" : "rigid_moment")
           << "\">\n<rb>" << sets_.points[p].name << "</rb>\n<dof>R" << (axis < 3 ? kAxes[axis] : kTurns[axis - 3])
           << "</dof>\n<value lc=\"" << curve(k, from[axis] / full, to[axis] / full) << "\">" << full
           << "</value>\n</rigid_load>\n";
    }
  }
  if (open) out_ << "</Rigid>\n";
}

void FebioSteps::loads(std::size_t k) {
  bool open = false;
  const LoadStep& step = *steps_[k];
  const LoadStep* const before = k > 0 ? steps_[k - 1] : nullptr;
  const auto forces = [&](std::size_t of, double from, double to, const char* name) {
    section("Loads", open);
    out_ << "<nodal_load name=\"" << name << "\" node_set=\"" << numbered("loaded_nodes", of, steps_.size())
         << "\" type=\"nodal_force\">\n<value lc=\"" << curve(k, from, to) << "\" type=\"map\">"
         << numbered("nodal_forces", of, steps_.size()) << "</value>\n</nodal_load>\n";
  };
  const bool stay = before != nullptr && same_forces(step, *before);
  if (!step.forces_n.empty()) forces(k, stay ? 1 : 0, 1, "load");
  if (before != nullptr && !stay && !before->forces_n.empty()) forces(k - 1, 1, 0, "load_of_before");
  std::vector<std::string> pressed;
  for (const LoadStep* s : {before, &step})
    if (s != nullptr)
      for (const Pressure& p : s->pressures)
        if (std::find(pressed.begin(), pressed.end(), p.set) == pressed.end()) pressed.push_back(p.set);
  int number = 0;
  for (const std::string& set : pressed) {
    const double from = pressure_on(before, set), to = pressure_on(&step, set), full = to != 0 ? to : from;
    if (full == 0) continue;
    section("Loads", open);
    out_ << "<surface_load name=\"pressure_" << ++number << "\" surface=\"" << set
         << "\" type=\"pressure\">\n<pressure lc=\"" << curve(k, from / full, to / full) << "\">" << full
         << "</pressure>\n<linear>0</linear>\n<symmetric_stiffness>1</symmetric_stiffness>\n</surface_load>\n";
  }
  // FEBio takes a body force with the other sign: it is the mass's resistance.
  const auto gravity = [&](Vec3 g, double from, double to) {
    section("Loads", open);
    out_ << "<body_load type=\"body force\">\n<force lc=\"" << curve(k, from, to) << "\">" << 0 - g.x << ',' << 0 - g.y
         << ',' << 0 - g.z << "</force>\n</body_load>\n";
  };
  const Vec3 was = before != nullptr ? before->gravity_mm_s2 : Vec3{};
  if (norm(step.gravity_mm_s2) > 0) gravity(step.gravity_mm_s2, same(was, step.gravity_mm_s2) ? 1 : 0, 1);
  if (norm(was) > 0 && !same(was, step.gravity_mm_s2)) gravity(was, 1, 0);
  if (open) out_ << "</Loads>\n";
}

}  // namespace stackmesh
