#include <cstdio>
#include <memory>

#include "base/error.h"
#include "base/text.h"
#include "commands.h"
#include "fem/material_law.h"
#include "options.h"
#include "run/fem_run.h"

namespace stackmesh::app {
namespace {

struct FemArguments {
  std::string image, materials, label_array;
  std::string contact = "tie";
  std::vector<std::string> parts, skins, selections;
  std::string accuracy, result;
  int erode_px = 0;
  double sharp_deg = 50;
};

/// "NAME=TEXT" to its two sides.
std::pair<std::string, std::string> at_equals(const std::string& text, const std::string& option,
                                              const std::string& form) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos || at == 0 || at + 1 == text.size())
    fail_usage("'" + text + "' is not " + form, option, "see stackmesh fem --help");
  return {text.substr(0, at), text.substr(at + 1)};
}

void add_options(CLI::App& command, FemArguments& a) {
  std::string laws;
  for (const std::string& name : known_laws()) laws += (laws.empty() ? "" : ", ") + name;
  command.get_option("INPUT")->description("labels as for mesh, or a volume mesh: .vtu .msh .inp .vtk .mesh");
  command.add_option("--image", a.image,
                     "CT or MRI intensities for materials, any grid: .nii .nii.gz .nrrd .nhdr .mha .mhd .gipl, or a "
                     "DICOM series (folder or file)");
  command.add_option("--materials", a.materials,
                     "material law and load case, JSON (docs/fem.md); laws built in: " + laws);
  command
      .add_option("--erode", a.erode_px,
                  "voxels taken off a label's border before its intensities are used (default: the law file's, 0)")
      ->check(CLI::Range(0, 20));
  command.add_option("--parts", a.parts, "A=1,3 B=2,4: nodes are shared within a part and doubled between parts")
      ->expected(1, -1);
  command
      .add_option("--contact", a.contact,
                  "between parts, where the law file says nothing: tie (they stay joined), contact (they press and "
                  "slide), none")
      ->check(CLI::IsMember({"tie", "contact", "none"}))
      ->capture_default_str();
  command
      .add_option("--skin", a.skins, "5=0.3: shells of that thickness (mm) on the outer faces of a label; repeatable")
      ->allow_extra_args(false);
  command
      .add_option("--select", a.selections,
                  "NAME=CRITERION[&CRITERION]: box:x0,y0,z0,x1,y1,z1 sphere:x,y,z,r plane:x,y,z,nx,ny,nz[,tolerance] "
                  "normal:nx,ny,nz,degrees points:FILE.mrk.json,r of:LABEL in:SET; repeatable")
      ->allow_extra_args(false);
  command.add_option("--sharp", a.sharp_deg, "a label's outer faces are split at edges that turn by more, degrees")
      ->check(number_in(1, 180, "a number from 1 to 180"))
      ->capture_default_str();
  command.add_option("--accuracy", a.accuracy,
                     "5%: CalculiX solves the load case's first static step on the mesh and on its tetrahedra cut into "
                     "eight (twice at most), until stress and "
                     "displacement of every set change by no more; the last mesh is written");
  command.add_option("--result", a.result,
                     "CalculiX's .frd of the deck that these very options made: the page of --report R.html shows its "
                     "von Mises stress");
  command.add_option("--label-array", a.label_array, "of a given mesh: the cell array that holds its labels");
}

FemRunOptions to_options(const CLI::App& command, const FemArguments& a, MeshRunOptions mesh) {
  FemRunOptions o;
  o.mesh = std::move(mesh);
  o.mesh.command = "fem";
  o.image = a.image;
  o.materials = a.materials;
  if (command.get_option("--erode")->count() > 0) o.erode_px = a.erode_px;
  for (const std::string& text : a.parts) o.parts.push_back(at_equals(text, "--parts", "NAME=LABELS"));
  o.contact = a.contact == "tie" ? Contact::tie : a.contact == "contact" ? Contact::contact : Contact::none;
  if (a.parts.empty() && command.get_option("--contact")->count() > 0)
    fail_usage("--contact is between parts, and there are none", "command line", "give them with --parts A=1,3 B=2,4");
  for (const std::string& text : a.skins) {
    const auto [label, thickness] = at_equals(text, "--skin", "LABEL=MM");
    o.skins.push_back({label, parse_number(thickness, "--skin")});
    if (o.skins.back().second <= 0)
      fail_usage("the thickness '" + thickness + "' is not above 0", "--skin", "write --skin 5=0.3, in mm");
  }
  if (!a.accuracy.empty()) {
    const double percent =
        parse_number(a.accuracy.back() == '%' ? a.accuracy.substr(0, a.accuracy.size() - 1) : a.accuracy, "--accuracy");
    if (!(percent > 0 && percent <= 50))
      fail_usage("the accuracy '" + a.accuracy + "' is not above 0 and at most 50 %", "--accuracy",
                 "write --accuracy 5%");
    o.accuracy_rel = percent / 100;
  }
  o.result = a.result;
  o.selections = a.selections;
  o.sharp_deg = a.sharp_deg;
  o.label_array = a.label_array;
  if (o.mesh.mesh.sections.contours.axis == StackAxis::x) o.up = {1, 0, 0};
  if (o.mesh.mesh.sections.contours.axis == StackAxis::y) o.up = {0, 1, 0};
  if (!a.image.empty() && a.materials.empty())
    fail_usage("--image needs a law that turns intensities into moduli", "command line",
               "give it with --materials LAW.json");
  o.mesh.option_texts.push_back({"image", a.image.empty() ? "none" : a.image});
  o.mesh.option_texts.push_back({"materials", a.materials.empty() ? "none" : a.materials});
  return o;
}

std::string contact_text(const SurfacePair& p) {
  if (p.contact == Contact::tie) return "tied";
  if (p.contact == Contact::none) return "surfaces named, no contact";
  char text[96];
  std::snprintf(text, sizeof text, "contact, %.5g MPa/mm, friction %.3g", p.stiffness_mpa_mm, p.friction);
  return text;
}

void print_summary(const RunReport& r, const std::vector<std::string>& outputs) {
  const FemReport& f = *r.fem;
  const std::string layers =
      f.wedges > 0 ? ", " + std::to_string(f.wedges) + " wedges of " + (f.order == 2 ? "15" : "6") : "";
  std::printf("mesh      %zu nodes, %zu tetrahedra of %d nodes%s, %zu shells\n", f.nodes, f.elements - f.wedges,
              f.order == 2 ? 10 : 4, layers.c_str(), f.shells);
  for (const FemSet& s : f.sets)
    std::printf("set       %-32s %7zu nodes %7zu faces  %s\n", printable(s.name).c_str(), s.nodes, s.faces,
                printable(s.note).c_str());
  for (const SurfacePair& p : f.pairs)
    std::printf("pair      %-32s %s\n", printable(p.parts[0] + ", " + p.parts[1]).c_str(), contact_text(p).c_str());
  for (const MaterialRow& m : f.materials) {
    std::printf("material  %-32s ", printable(m.name).c_str());
    if (f.placeholder_materials) std::printf("none given\n");
    else if (m.law.empty()) std::printf("E %.5g MPa\n", m.young_mean_mpa);
    else
      std::printf(
          "E %.5g to %.5g, mean %.5g MPa (%s); set to the floor %.1f %%, to the ceiling %.1f %%; %zu bins in .inp and "
          ".bdf, off by at most %.2g %%\n",
          m.young_min_mpa, m.young_max_mpa, m.young_mean_mpa, m.law.c_str(), 100 * m.clamped_low, 100 * m.clamped_high,
          m.materials, 100 * m.bin_error_rel);
  }
  if (f.bodies.size() > 1) {
    std::printf("bodies    %zu that share no face with each other\n", f.bodies.size());
    for (std::size_t i = 1; i < f.bodies.size() && i <= 5; ++i)
      std::printf("          label %d (%s), %zu elements, %.4g mm3 at (%.4g, %.4g, %.4g)\n", f.bodies[i].label,
                  f.bodies[i].name.c_str(), f.bodies[i].tets, f.bodies[i].volume_mm3, f.bodies[i].centre.x,
                  f.bodies[i].centre.y, f.bodies[i].centre.z);
    if (f.bodies.size() > 6) std::printf("          and %zu smaller ones\n", f.bodies.size() - 6);
  }
  for (const FemStep& p : f.steps) {
    std::printf("%-9s %zu supports, ", f.steps.size() > 1 ? p.name.c_str() : "load case", p.supports);
    if (p.frequency) std::printf("natural frequencies\n");
    else
      std::printf("%zu loaded nodes, force (%.5g, %.5g, %.5g) N%s%s\n", p.loaded_nodes, p.force_n.x, p.force_n.y,
                  p.force_n.z, norm(p.gravity_mm_s2) > 0 ? ", gravity" : "",
                  p.large_displacements ? ", large displacements" : "");
  }
  if (f.accuracy) {
    const Accuracy& e = f.accuracy->estimate;
    std::printf(
        "accuracy  %.3g %% (requested %.3g %%), in set %s; energy error by Zienkiewicz and Zhu %.3g %%; solved with",
        100 * e.error_rel, 100 * f.accuracy->asked_rel, printable(e.worst_set).c_str(), 100 * e.zz_rel.back());
    for (std::size_t i = 0; i < f.accuracy->elements.size(); ++i)
      std::printf("%s %zu", i > 0 ? "," : "", f.accuracy->elements[i]);
    std::printf(" elements\n");
    for (const SetAccuracy& s : e.sets)
      std::printf("          %-32s von Mises %.4g MPa (mean square), off by %.2g %%; moves %.4g mm, off by %.2g %%%s\n",
                  printable(s.set).c_str(), s.mises_rms_mpa.back(), 100 * s.error_rel, s.displacement_max_mm.back(),
                  100 * s.displacement_error_rel, s.held ? " (held: does not count)" : "");
  }
  for (const std::string& o : outputs) std::printf("written   %s\n", printable(o).c_str());
}

}  // namespace

FemOptionSource add_fem_options(CLI::App& command) {
  const MeshOptionSource mesh = add_mesh_options(command, 2);
  auto a = std::make_shared<FemArguments>();
  add_options(command, *a);
  CLI::App* const app = &command;
  return {[a, app, mesh] { return to_options(*app, *a, mesh.options()); }, mesh.progress, mesh.quiet};
}

void add_fem_command(CLI::App& program, Purpose purpose) {
  CLI::App* command =
      program.add_subcommand("fem", "Labels, or a volume mesh, to a solver model: sets, materials, deck");
  const FemOptionSource fem = add_fem_options(*command);
  command->callback([fem, purpose] {
    const FemRunOptions options = fem.options();
    if (purpose == Purpose::check) return;
    const auto progress = fem.progress();
    const RunReport report = run_fem(options, *progress);
    if (fem.quiet()) return;
    print_warnings(report.warnings);
    print_summary(report, options.mesh.outputs);
  });
}

}  // namespace stackmesh::app
