#include "run/fem_summary.h"

#include <cmath>
#include <set>

#include "base/error.h"
#include "fem/check_supports.h"
#include "fem/load_case.h"
#include "meshio/read_frd.h"

namespace stackmesh {
namespace {

FemStep step_of(const SolverModel& model, const LoadStep& s) {
  FemStep out;
  out.name = s.name;
  out.frequency = s.analysis == Analysis::frequency;
  out.large_displacements = s.large_displacements || model.sets.is_hyperelastic();
  out.supports = s.supports.size() + s.point_supports.size();
  std::set<std::int32_t> loaded;
  for (const auto& [node, force] : s.forces_n) {
    loaded.insert(node);
    out.force_n = out.force_n + force;
  }
  for (const PointLoad& l : s.point_loads) out.force_n = out.force_n + l.force_n;
  for (const Pressure& p : s.pressures) {
    out.force_n = out.force_n + force_of(model, p);
    for (const NodeSet& set : model.sets.node_sets)
      if (set.name == p.set) loaded.insert(set.nodes.begin(), set.nodes.end());
  }
  out.loaded_nodes = loaded.size() + s.point_loads.size();
  out.pressures = s.pressures.size();
  out.gravity_mm_s2 = s.gravity_mm_s2;
  return out;
}

}  // namespace

FemReport summary_of(const SolverModel& model, const MaterialReport& materials, const std::string& image,
                     const std::string& materials_path) {
  FemReport f;
  f.order = model.mesh.mid.empty() ? 1 : 2;
  f.nodes = model.mesh.points.size();
  f.elements = model.mesh.elements();
  f.wedges = model.mesh.wedges.size();
  f.image = image;
  f.materials_path = materials_path;
  f.placeholder_materials = model.sets.placeholder_materials;
  for (const NodeSet& s : model.sets.node_sets) {
    FemSet row{s.name, s.note, s.nodes.size(), 0};
    for (const FaceSet& faces : model.sets.surfaces)
      if (faces.name == s.name) row.faces = faces.faces.size();
    f.sets.push_back(row);
  }
  f.pairs = model.sets.pairs;
  f.materials = materials.labels;
  for (const ShellSet& s : model.sets.shells) {
    f.skins.push_back({s.name, s.thickness_mm});
    f.shells += s.faces.size();
  }
  f.bodies = bodies_of(model);
  for (const LoadStep& s : model.sets.steps) f.steps.push_back(step_of(model, s));
  if (!f.steps.empty()) {
    f.supports = f.steps[0].supports;
    f.loaded_nodes = f.steps[0].loaded_nodes;
    f.force_n = f.steps[0].force_n;
  }
  return f;
}

std::vector<double> mises_of(const SolverModel& model, const std::string& result_path) {
  const FrdResult result = read_frd(result_path);
  const auto stress = result.fields.find("STRESS");
  if (stress == result.fields.end())
    fail_input("the result has no stress", result_path,
               "ask for it in the deck: *EL FILE and S, as decks with a load case do");
  std::vector<double> mises(model.mesh.points.size(), 0);
  for (std::size_t i = 0; i < result.numbers.size(); ++i) {
    const std::int64_t node = result.numbers[i] - 1;
    if (node < 0 || node >= static_cast<std::int64_t>(mises.size())) continue;  // of rigid points and springs
    const Vec3 p = model.mesh.points[node];
    if (norm(result.points[i] - p) > 1e-3 + 1e-4 * norm(p))
      fail_input("the result is of another mesh: its node " + std::to_string(node + 1) + " lies elsewhere", result_path,
                 "give the result of this input with these very options");
    const auto& s = stress->second[i];
    const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
    mises[node] = std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
  }
  return mises;
}

}  // namespace stackmesh
