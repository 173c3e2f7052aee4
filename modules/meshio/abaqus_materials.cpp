#include <cmath>

#include "meshio/abaqus_cards.h"

namespace stackmesh {
namespace {

/// Numbers behind each other, eight a line.
void numbers(OutputBuffer& out, const std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    out.print20(values[i]);
    out << (i + 1 == values.size() ? "\n" : i % 8 == 7 ? ",\n" : ", ");
  }
}

void density(OutputBuffer& out, double t_mm3) {
  if (t_mm3 <= 0) return;
  out << "*DENSITY\n";
  numbers(out, {t_mm3});
}

void elastic(OutputBuffer& out, const std::string& name, double young_mpa, double poisson, double density_t_mm3) {
  out << "*MATERIAL, NAME=" << name << "\n*ELASTIC\n";
  numbers(out, {young_mpa, poisson});
  density(out, density_t_mm3);
}

void material(OutputBuffer& out, const ElementMaterial& m) {
  const std::vector<double>& c = m.constants;
  if (m.kind == MaterialKind::linear) return elastic(out, m.name, m.young_mpa, m.poisson, m.density_t_mm3);
  out << "*MATERIAL, NAME=" << m.name << '\n';
  switch (m.kind) {
    case MaterialKind::orthotropic:
      out << "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n";
      numbers(out, c);
      break;
    case MaterialKind::neo_hooke:
      out << "*HYPERELASTIC, NEO HOOKE\n";
      numbers(out, {c[0], 2 / c[1]});
      break;
    case MaterialKind::mooney_rivlin:
      out << "*HYPERELASTIC, MOONEY-RIVLIN\n";
      numbers(out, {c[0], c[1], 2 / c[2]});
      break;
    case MaterialKind::holzapfel:
      out << "** CalculiX does not read this material; Abaqus does\n*ANISOTROPIC HYPERELASTIC, HOLZAPFEL, LOCAL "
             "DIRECTIONS=2\n";
      numbers(out, {c[0], 2 / c[5], c[1], c[2], c[3]});
      break;
    case MaterialKind::linear:
      break;
  }
  density(out, m.density_t_mm3);
}

bool same(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b) {
  return norm(a[0] - b[0]) == 0 && norm(a[1] - b[1]) == 0;
}

void axes(OutputBuffer& out, const std::array<Vec3, 2>& a) {
  numbers(out, {a[0].x, a[0].y, a[0].z, a[1].x, a[1].y, a[1].z});
}

/// The axes of a material's elements: one orientation, or one an element. Returns what the section says of it.
std::string orientation(OutputBuffer& out, const PreparedMesh& mesh, const ElementMaterial& m) {
  const std::vector<std::array<Vec3, 2>>& all = mesh.sets.axes;
  if (all.empty() || norm(all[m.tets[0]][0]) == 0) return "";
  bool one = true;
  for (const std::int32_t t : m.tets) one = one && same(all[t], all[m.tets[0]]);
  const std::string name = "OR_" + m.name;
  if (!one) {
    out << "*DISTRIBUTION TABLE, NAME=T" << name << "\nCOORD3D, COORD3D\n*DISTRIBUTION, NAME=D" << name
        << ", LOCATION=ELEMENT, TABLE=T" << name << "\n, ";
    axes(out, all[m.tets[0]]);
    for (const std::int32_t t : m.tets) {
      out << t + 1 << ", ";
      axes(out, all[t]);
    }
  }
  out << "*ORIENTATION, NAME=" << name << ", SYSTEM=RECTANGULAR"
      << (m.kind == MaterialKind::holzapfel ? ", LOCAL DIRECTIONS=2" : "") << '\n';
  if (one) axes(out, all[m.tets[0]]);
  else out << 'D' << name << '\n';
  if (m.kind == MaterialKind::holzapfel) {
    const double angle = m.constants[4] * M_PI / 180;
    numbers(out, {std::cos(angle), std::sin(angle), 0});
    numbers(out, {std::cos(angle), -std::sin(angle), 0});
  }
  return ", ORIENTATION=" + name;
}

}  // namespace

void abaqus_list(OutputBuffer& out, const std::vector<std::int32_t>& from_zero) {
  for (std::size_t i = 0; i < from_zero.size(); ++i)
    out << from_zero[i] + 1 << (i + 1 == from_zero.size() ? "\n" : i % 16 == 15 ? ",\n" : ", ");
}

void abaqus_materials(OutputBuffer& out, const PreparedMesh& mesh, const std::vector<std::string>& label_sets,
                      UniqueNames& element_sets) {
  const SolverSets& sets = mesh.sets;
  if (sets.placeholder_materials) return;  // this format can be read without
  for (const ElementMaterial& m : sets.materials) {
    std::string set;
    for (std::size_t g = 0; g < mesh.labels.size(); ++g)
      if (mesh.labels[g].label == m.label && mesh.labels[g].elements() == m.tets.size()) set = label_sets[g];
    if (set.empty()) {
      set = element_sets.add("E_" + m.name);
      out << "*ELSET, ELSET=" << set << '\n';
      abaqus_list(out, m.tets);
    }
    material(out, m);
    const std::string oriented = orientation(out, mesh, m);
    out << "*SOLID SECTION, ELSET=" << set << ", MATERIAL=" << m.name << oriented << '\n';
  }
  for (const ShellSet& s : sets.shells) {
    elastic(out, "M_" + s.name, s.young_mpa, s.poisson, s.density_t_mm3);
    out << "*SHELL SECTION, ELSET=" << s.name << ", MATERIAL=M_" << s.name << '\n';
    numbers(out, {s.thickness_mm});
  }
}

}  // namespace stackmesh
