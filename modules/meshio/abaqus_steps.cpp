#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "meshio/abaqus_cards.h"

namespace stackmesh {
namespace {

/// A card that appears with its first line; from the second step on it takes away what the steps before said.
class Card {
 public:
  Card(OutputBuffer& out, const std::string& name, bool later) : out_(out), name_(name), later_(later) {
    if (later_) begin();
  }
  OutputBuffer& line() {
    begin();
    return out_;
  }

 private:
  void begin() {
    if (!begun_) out_ << name_ << (later_ ? ", OP=NEW\n" : "\n");
    begun_ = true;
  }
  OutputBuffer& out_;
  const std::string name_;
  const bool later_;
  bool begun_ = false;
};

class Steps {
 public:
  Steps(OutputBuffer& out, const PreparedMesh& mesh) : out_(out), mesh_(mesh), sets_(mesh.sets) {}

  void write() {
    for (std::size_t i = 0; i < sets_.steps.size(); ++i) step(sets_.steps[i], i > 0);
  }

 private:
  std::size_t point_number(std::int32_t point) const {
    return mesh_.points.size() + 1 + static_cast<std::size_t>(point);
  }

  void step(const LoadStep& s, bool later) {
    if (sets_.steps.size() > 1) out_ << "** " << s.name << '\n';
    if (s.analysis == Analysis::frequency) {
      out_ << (later ? "*STEP, PERTURBATION\n*FREQUENCY\n" : "*STEP\n*FREQUENCY\n") << s.modes << '\n';
    } else {
      const bool nonlinear = s.large_displacements || sets_.is_hyperelastic();
      const int increments = s.increments > 0 ? s.increments : nonlinear || sets_.has_contact() ? 10 : 1;
      if (nonlinear) out_ << "*STEP, NLGEOM, INC=1000\n*STATIC\n";
      else
        out_ << (increments > 100 ? "*STEP, INC=" + std::to_string(10 * increments) : std::string("*STEP"))
             << "\n*STATIC\n";
      if (increments > 1) {
        out_.print20(1.0 / increments);
        out_ << ", 1., 1e-05, 1.\n";
      }
    }
    boundary(s, later);
    if (s.analysis == Analysis::statics) loads(s, later);
    if (s.analysis == Analysis::statics)
      for (const RigidPoint& p : sets_.points) out_ << "*NODE PRINT, NSET=" << p.name << ", FREQUENCY=1000\nU, RF\n";
    out_ << "*NODE FILE\n"
         << (s.analysis == Analysis::frequency ? "U\n*END STEP\n" : "U, RF\n*EL FILE\nS, E\n*END STEP\n");
  }

  void boundary(const LoadStep& s, bool later) {
    Card card(out_, "*BOUNDARY", later);
    const auto line = [&](const std::string& what, int dof, double value) {
      card.line() << what << ", " << dof << ", " << dof << ", ";
      out_.print20(value);
      out_ << '\n';
    };
    for (const Support& h : s.supports)
      for (int axis = 0; axis < 3; ++axis)
        if (h.value_mm[axis]) line(h.set, axis + 1, *h.value_mm[axis]);
    for (const PointSupport& h : s.point_supports)
      for (int axis = 0; axis < 6; ++axis)
        if (h.value[axis]) line(sets_.points[h.point].name, axis + 1, *h.value[axis]);
    if (springs_have_ground()) line("SPRINGS_GROUND", 1, 0), line("SPRINGS_GROUND", 2, 0), line("SPRINGS_GROUND", 3, 0);
  }

  bool springs_have_ground() const {
    for (const SpringSet& s : sets_.springs)
      for (const GroundSpring& g : s.springs)
        if (!is_along_an_axis(g)) return true;
    return false;
  }

  void loads(const LoadStep& s, bool later) {
    {
      Card card(out_, "*CLOAD", later);
      const auto line = [&](std::size_t node, int dof, double value) {
        if (value == 0) return;
        card.line() << node << ", " << dof << ", ";
        out_.print20(value);
        out_ << '\n';
      };
      for (const auto& [node, force] : s.forces_n) {
        const double part[3] = {force.x, force.y, force.z};
        for (int axis = 0; axis < 3; ++axis) line(static_cast<std::size_t>(node) + 1, axis + 1, part[axis]);
      }
      for (const PointLoad& l : s.point_loads) {
        const double part[6] = {l.force_n.x, l.force_n.y, l.force_n.z, l.moment_nmm.x, l.moment_nmm.y, l.moment_nmm.z};
        for (int axis = 0; axis < 6; ++axis) line(point_number(l.point), axis + 1, part[axis]);
      }
    }
    {
      Card card(out_, "*DLOAD", later);
      const double g = norm(s.gravity_mm_s2);
      if (g > 0) {
        const Vec3 d = (1 / g) * s.gravity_mm_s2;
        std::vector<std::string> bodies = {"EALL"};
        for (const ShellSet& shell : sets_.shells)
          if (shell.density_t_mm3 > 0) bodies.push_back(shell.name);
        for (const std::string& body : bodies) {
          card.line() << body << ", GRAV, ";
          for (const double v : {g, d.x, d.y}) {
            out_.print20(v);
            out_ << ", ";
          }
          out_.print20(d.z);
          out_ << '\n';
        }
      }
    }
    Card card(out_, "*DSLOAD", later && any_pressure());
    for (const Pressure& p : s.pressures) {
      card.line() << p.set << ", P, ";
      out_.print20(p.mpa);
      out_ << '\n';
    }
  }
  bool any_pressure() const {
    return std::any_of(sets_.steps.begin(), sets_.steps.end(), [](const LoadStep& s) { return !s.pressures.empty(); });
  }

 public:
  static bool is_along_an_axis(const GroundSpring& g) {
    return std::max({std::abs(g.direction.x), std::abs(g.direction.y), std::abs(g.direction.z)}) == 1;
  }

 private:
  OutputBuffer& out_;
  const PreparedMesh& mesh_;
  const SolverSets& sets_;
};

/// Twelve digits and a point: CalculiX's *SPRING does not read a whole number as a stiffness.
std::string stiffness_text(double n_per_mm) {
  char text[40];
  std::snprintf(text, sizeof text, "%.12g", n_per_mm);
  const std::string number = text;
  if (number.find('.') != std::string::npos) return number;
  const std::size_t e = number.find('e');
  return e == std::string::npos ? number + "." : number.substr(0, e) + "." + number.substr(e);
}

/// Twice the diagonal of the mesh's box: how far away a spring's ground lies, so that its direction stays.
double far_away(const PreparedMesh& mesh) {
  Vec3 low = mesh.points[0], high = low;
  for (const Vec3 p : mesh.points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return 2 * norm(high - low);
}

}  // namespace

void abaqus_points_and_springs(OutputBuffer& out, const PreparedMesh& mesh, std::size_t& number) {
  const SolverSets& sets = mesh.sets;
  std::size_t node = mesh.points.size();
  const auto place = [&](Vec3 p) {
    for (const double v : {p.x, p.y}) {
      out.print20(v);
      out << ", ";
    }
    out.print20(p.z);
    out << '\n';
  };
  for (const RigidPoint& p : sets.points) {
    out << "** a point to which set " << p.set << " is bound as a rigid body\n*NODE, NSET=" << p.name << '\n'
        << ++node << ", ";
    place(p.at_mm);
    out << "*COUPLING, REF NODE=" << node << ", SURFACE=" << p.set << ", CONSTRAINT NAME=C_" << p.name
        << "\n*KINEMATIC\n1, 3\n";
  }
  // Springs of one stiffness along one axis share a set; those along other directions reach to a ground far away.
  const double distance = sets.springs.empty() ? 0 : far_away(mesh);
  for (const SpringSet& s : sets.springs) {
    out << "** " << s.name << ": N/mm, by each node's share of the area\n";
    std::map<std::pair<int, std::string>, std::vector<const GroundSpring*>> alike;  // axis (0: none of them), stiffness
    for (const GroundSpring& g : s.springs) {
      const int axis = !Steps::is_along_an_axis(g) ? 0 : g.direction.x != 0 ? 1 : g.direction.y != 0 ? 2 : 3;
      alike[{axis, stiffness_text(g.n_per_mm)}].push_back(&g);
    }
    int set = 0;
    for (const auto& [kind, list] : alike) {
      const auto& [axis, stiffness] = kind;
      const std::size_t first = node;
      if (axis == 0) {
        out << "*NODE, NSET=SPRINGS_GROUND\n";
        for (const GroundSpring* g : list) {
          out << ++node << ", ";
          place(mesh.points[g->node] + distance * g->direction);
        }
      }
      const std::string name = s.name + "_" + std::to_string(++set);
      out << "*ELEMENT, TYPE=" << (axis == 0 ? "SPRINGA" : "SPRING1") << ", ELSET=" << name << '\n';
      for (std::size_t i = 0; i < list.size(); ++i) {
        out << ++number << ", " << list[i]->node + 1;
        if (axis == 0) out << ", " << first + i + 1;
        out << '\n';
      }
      out << "*SPRING, ELSET=" << name << '\n';
      if (axis > 0) out << axis;
      out << '\n' << stiffness << '\n';
    }
  }
}

void abaqus_steps(OutputBuffer& out, const PreparedMesh& mesh) {
  Steps(out, mesh).write();
}

}  // namespace stackmesh
