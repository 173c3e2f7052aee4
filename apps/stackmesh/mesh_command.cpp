#include <cmath>
#include <cstdio>
#include <memory>

#include "base/error.h"
#include "base/text.h"
#include "commands.h"
#include "meshio/write_mesh.h"
#include "options.h"
#include "run/mesh_run.h"
#include "slicer_module.h"

namespace stackmesh::app {
namespace {

/// Options of virtual sections and of the surface enhancement.
struct EnhanceArguments {
  std::string edge_length, interpolate = "auto";
  double deviation = 0, edge_min = 0, edge_max = 0, gradation = 1.3;
  int smooth = 5;
  bool raw = false;
  long target_tets = 0;
  bool off = false;
};

struct MeshArguments {
  InputArguments input;
  ContourArguments contours;
  TerminalArguments terminal;
  EnhanceArguments enhance;
  std::vector<std::string> outputs, reports, names;
  std::string caps = "auto", space = "lps";
  double snap_mm = 0, timeout_s = 600;
  std::string max_volume;
  std::vector<std::string> layers;
  double radius_edge = 0, dihedral = 0;
  int order = 1, refine = 0;
  std::string voids, keep_largest;
  double min_piece_mm3 = 0;
  bool strict = false, per_label = false, msh2 = false, yes = false;
  std::string return_parameters;  // of 3D Slicer
};

/// Options of virtual sections and of the surface's elements.
void add_enhance_options(CLI::App& command, EnhanceArguments& e, Target target) {
  const CLI::Validator positive = number_in(1e-12, 1e12, "a number above 0");
  command
      .add_option("--interpolate", e.interpolate,
                  "virtual sections per gap: auto or a number; 0 is the paper's direct stitch")
      ->capture_default_str();
  command
      .add_option("--deviation", e.deviation, "curvature-adapted sizing: largest distance to the curved surface, mm")
      ->check(positive);
  command.add_option("--edge-length", e.edge_length, "uniform edge length, mm; per label 5=2.0,9=1.0");
  command.add_option("--edge-min", e.edge_min, "smallest edge of --deviation, mm")->check(positive);
  command.add_option("--edge-max", e.edge_max, "largest edge of --deviation, mm")->check(positive);
  command.add_option("--gradation", e.gradation, "largest ratio of neighbouring edge lengths")
      ->check(number_in(1, 100, "a number from 1 to 100"))
      ->capture_default_str();
  command
      .add_option("--smooth", e.smooth,
                  "smoothing passes; 0 is none; each above 5 takes more of the voxels' steps away (5 is for a --band "
                  "of up to 0.5 pixel; a wider one has 2 more for each tenth of a pixel)")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  command.add_flag("--no-enhance", e.off, "the stitched surface as it is");
  if (target == Target::surface)
    command.add_flag("--raw", e.raw,
                     "the stitched surface of the pixels' own outlines, without fairing and enhancement");
}

/// Options of tetrahedra.
std::vector<CLI::Option*> add_volume_options(CLI::App& command, MeshArguments& a) {
  const CLI::Validator positive = number_in(1e-12, 1e12, "a number above 0");
  return {
      command
          .add_option("--target-tets", a.enhance.target_tets,
                      "about as many tetrahedra as the sizes by curvature are scaled for (default: at most 150,000, "
                      "and 50,000 for each further label)")
          ->check(CLI::Range(1L, 1000000000L)),
      command.add_option("--max-volume", a.max_volume, "largest tetrahedron, mm3; per label 5=2.0,9=1.0"),
      command.add_option("--radius-edge", a.radius_edge, "largest radius-edge ratio of tetrahedra; a target")
          ->check(number_in(1, 100, "a number from 1 to 100")),
      command.add_option("--dihedral", a.dihedral, "smallest dihedral angle of tetrahedra, degrees; a target")
          ->check(number_in(0, 40, "a number from 0 to 40")),
      command.add_option("--order", a.order, "of the tetrahedra: 1 linear, 2 quadratic (10 nodes)")
          ->check(CLI::Range(1, 2))
          ->capture_default_str(),
      command
          .add_option("--refine", a.refine,
                      "how often every tetrahedron is cut into eight at the end: the same surface and order, edges "
                      "half as long")
          ->check(CLI::Range(0, 4))
          ->capture_default_str(),
      command
          .add_option("--layer", a.layers,
                      "5=1.5,3: a layer of wedges under the outer faces of a label, 1.5 mm thick, three over each "
                      "other; thinner where there is no room; repeatable")
          ->type_name("LABEL=MM,COUNT")
          ->allow_extra_args(false),
      command.add_flag("--yes", a.yes, "go on when more than 10 million tetrahedra are estimated"),
      command.add_flag("--msh2", a.msh2, ".msh as Gmsh 2.2"),
      command
          .add_option("--timeout", a.timeout_s,
                      "for the volume mesher, and for each run of CalculiX with --accuracy, s")
          ->check(positive)
          ->capture_default_str()};
}

void add_options(CLI::App& command, MeshArguments& a, Target target) {
  const CLI::Validator positive = number_in(1e-12, 1e12, "a number above 0");
  a.input.add_to(command, true);
  command
      .add_option("-o,--output", a.outputs,
                  "output: " + (target == Target::volume ? volume_endings() + ", and surfaces " : std::string()) +
                      surface_endings() + "; repeatable")
      ->required()
      ->allow_extra_args(false);
  command.add_option("--report", a.reports, "report file, .json or .html; repeatable")->allow_extra_args(false);
  command
      .add_option("--names", a.names,
                  "FILE.json: written, the labels' numbers, names and colours; any other: read, a Slicer colour table "
                  "or an ITK-SNAP label description")
      ->allow_extra_args(false);
  a.contours.add_to(command);
  command.add_option("--snap", a.snap_mm, "merge tolerance between similar neighbouring contours, mm")
      ->check(number_in(0, 1e6, "a number from 0"))
      ->capture_default_str();
  command
      .add_option("--caps", a.caps,
                  "ends: auto, flat or round; per label 5=flat,9=round, per end 1:high=flat,low=round")
      ->capture_default_str();
  command
      .add_option("--void,--keep-sets", a.voids,
                  "labels that bound the others and are not filled (blood, a medullary canal), whatever --label says; "
                  "their walls are sets L_inner_V")
      ->type_name("LABEL[,LABEL]");
  command.add_option("--keep-largest", a.keep_largest, "only the largest piece of each label, or the N largest")
      ->expected(0, 1)
      ->type_name("[N]");
  command.add_option("--min-piece", a.min_piece_mm3, "no piece of a label that is smaller, mm3")->check(positive);
  command.add_option("--space", a.space, "world frame of what is written: lps or ras")->capture_default_str();
  command.add_flag("--per-label", a.per_label, "surfaces: NAME_<label>.EXT for each label");
  command.add_flag("--strict", a.strict, "a fallback or a lost detail is exit 4");
  add_enhance_options(command, a.enhance, target);
  const std::vector<CLI::Option*> of_volumes = add_volume_options(command, a);
  if (target == Target::surface)
    // accepted without effect, so that both commands take the same line
    for (CLI::Option* option : of_volumes) option->group("");
  command.add_option("--return-parameters", a.return_parameters)->group("");
  a.terminal.add_to(command);
}

std::string text_of(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", value);
  return buffer;
}

/// What was requested, or the default: more passes for a wider band, whose labels jitter from slice to slice.
int smoothing_passes(const CLI::App& command, int asked, double band_px) {
  constexpr double kForEachPixel = 20;  // measured on jittering slices (docs/fidelity.md)
  if (command.get_option("--smooth")->count() > 0) return asked;
  return asked + static_cast<int>(std::lround(kForEachPixel * std::max(0.0, band_px - 0.5)));
}

/// Which pieces of labels are kept.
void set_pieces(const CLI::App& command, const MeshArguments& a, MeshRunOptions& o) {
  if (command.get_option("--keep-largest")->count() > 0) {
    const std::string& n = a.keep_largest;
    if (n.size() > 6 || n.find_first_not_of("0123456789") != std::string::npos || n == "0")
      fail_usage("'" + n + "' is no number of pieces", "--keep-largest",
                 "write --keep-largest for one piece of each label, or --keep-largest N, after the input");
    o.mesh.pieces.keep_largest = n.empty() ? 1 : std::stoi(n);
  }
  if (a.min_piece_mm3 > 0) o.mesh.pieces.min_piece_mm3 = a.min_piece_mm3;
}

/// Label tables: the one that is read, and those that are written.
void set_label_tables(const MeshArguments& a, MeshRunOptions& o) {
  for (const std::string& path : a.names) {
    const bool is_output = path.size() > 5 && path.compare(path.size() - 5, 5, ".json") == 0;
    if (is_output) o.names_outputs.push_back(path);
    else if (o.input.names.empty()) o.input.names = path;
    else
      fail_usage("two label tables", "--names " + path, "give one table to read; files that end in .json are written");
  }
}

/// Whether the number of elements was requested.
bool asks_for_budget(const CLI::App& command) {
  return command.get_option("--target-tets")->count() > 0;
}

/// Whether sizes of elements were requested.
bool asks_for_sizes(const EnhanceArguments& e) {
  return !e.edge_length.empty() || e.deviation > 0 || e.edge_min > 0 || e.edge_max > 0;
}

/// Virtual sections, and the surface's elements.
void set_enhancement(const CLI::App& command, const EnhanceArguments& e, MeshRunOptions& o) {
  o.mesh.sections.virtual_sections = parse_interpolate(e.interpolate);
  o.mesh.enhance = !e.off && !e.raw;
  o.mesh.sections.band_asked = command.get_option("--band")->count() > 0;
  if (e.raw) {  // the voxels' own outlines
    if (o.mesh.sections.band_asked)
      fail_usage("--band has no meaning beside --raw", "--raw",
                 "leave one of them out: the raw surface follows the outlines of the pixels");
    o.mesh.sections.band_px = 0;
  }
  if (e.edge_length.empty() && e.deviation <= 0) o.mesh.enhance_up_to = 10000000;
  if (!e.edge_length.empty())
    o.label_edges_text =
        parse_sizes(e.edge_length, "--edge-length", "edge length", "mm", o.mesh.enhancement.edge_length_mm);
  if (e.deviation > 0) o.mesh.enhancement.deviation_mm = e.deviation;
  if (e.edge_min > 0) o.mesh.enhancement.edge_min_mm = e.edge_min;
  if (e.edge_max > 0) o.mesh.enhancement.edge_max_mm = e.edge_max;
  o.mesh.enhancement.gradation = e.gradation;
  o.mesh.enhancement.smooth_passes = smoothing_passes(command, e.smooth, o.mesh.sections.band_px);
  // The budget is for sizes that nobody requested, or for whoever asks for it.
  const bool budget_asked = asks_for_budget(command);
  if (budget_asked) o.mesh.enhancement.target_tets = static_cast<std::size_t>(e.target_tets);
  o.mesh.enhancement.usual_target = !budget_asked && !asks_for_sizes(e);
  if (budget_asked && (!e.edge_length.empty() || !o.mesh.enhance))
    fail_usage(std::string("--target-tets and ") + (!o.mesh.enhance ? "--no-enhance" : "--edge-length") +
                   " both say how many elements there are",
               "command line", "give one of them");
}

/// The options as the report names them.
std::vector<std::pair<std::string, std::string>> option_texts(const CLI::App& command, const MeshArguments& a,
                                                              const MeshRunOptions& o) {
  const EnhanceArguments& e = a.enhance;
  std::vector<std::pair<std::string, std::string>> texts = {
      {"label", a.input.labels.empty() ? "all" : a.input.labels},
      {"void", a.voids.empty() ? "none" : a.voids},
      {"merge", a.input.merge ? "on" : "off"},
      {"axis", a.contours.axis},
      {"simplify_px", a.contours.simplify_px >= 0 ? text_of(a.contours.simplify_px) : "default"},
      {"band_px", text_of(o.mesh.sections.band_px)},
      {"as_stored", o.mesh.sections.as_stored ? "on" : "off"},
      {"snap_mm", text_of(a.snap_mm)},
      {"caps", a.caps},
      {"keep_largest", o.mesh.pieces.keep_largest ? std::to_string(*o.mesh.pieces.keep_largest) : "all"},
      {"min_piece_mm3", o.mesh.pieces.min_piece_mm3 ? text_of(*o.mesh.pieces.min_piece_mm3) : "unset"},
      {"interpolate", e.interpolate},
      {"enhance", o.mesh.enhance ? "on" : "off"},
      {"smooth", std::to_string(o.mesh.enhancement.smooth_passes)},
      {"edge_length_mm", e.edge_length.empty() ? "unset" : e.edge_length},
      {"deviation_mm", e.deviation > 0 ? text_of(e.deviation) : "default"},
      {"edge_min_mm", e.edge_min > 0 ? text_of(e.edge_min) : "default"},
      {"edge_max_mm", e.edge_max > 0 ? text_of(e.edge_max) : "default"},
      {"gradation", text_of(e.gradation)},
      {"target_tets", asks_for_budget(command) ? std::to_string(e.target_tets)
                      : asks_for_sizes(e)      ? "unset"
                                               : "default"},
      {"space", a.space},
      {"threads", a.contours.threads > 0 ? std::to_string(a.contours.threads) : "all"},
      {"strict", a.strict ? "on" : "off"}};
  if (o.mesh.target == Target::volume) {
    texts.push_back({"order", std::to_string(a.order)});
    texts.push_back({"refine", std::to_string(a.refine)});
    std::string layers;
    for (const std::string& text : a.layers) layers += (layers.empty() ? "" : " ") + text;
    texts.push_back({"layer", layers.empty() ? "none" : layers});
    texts.push_back({"max_volume_mm3", a.max_volume.empty() ? "unset" : a.max_volume});
    texts.push_back({"radius_edge", a.radius_edge > 0 ? text_of(a.radius_edge) : "unset"});
    texts.push_back({"dihedral_deg", a.dihedral > 0 ? text_of(a.dihedral) : "unset"});
  }
  return texts;
}

MeshRunOptions to_options(const CLI::App& command, const MeshArguments& a, Target target) {
  MeshRunOptions o;
  o.mesh.target = target;
  o.command = target == Target::volume ? "mesh" : "surface";
  o.version = STACKMESH_VERSION;
  o.input = a.input.options();
  o.input.voids = a.voids;
  o.mesh.sections = a.contours.options();
  o.mesh.threads = a.contours.threads;
  o.mesh.stitch.snap_mm = a.snap_mm;
  parse_caps(a.caps, o.mesh.stitch.caps, o.label_caps_text);
  set_pieces(command, a, o);
  o.mesh.order = a.order;
  o.mesh.refine = a.refine;
  if (!a.layers.empty() && target == Target::surface)
    fail_usage("--layer is for volume meshes", "--layer", "leave it out, or use stackmesh mesh");
  o.layers = parse_layers(a.layers);
  if (!o.layers.empty() && o.mesh.refine > 0)
    fail_usage("--refine cuts tetrahedra, not wedges", "--layer",
               "leave one of them out; a smaller --edge-length and more wedges refine, too");
  o.mesh.many_tets = a.yes;
  if (!a.max_volume.empty())
    o.label_volumes_text = parse_sizes(a.max_volume, "--max-volume", "volume", "mm3", o.mesh.fill.max_volume_mm3);
  if (a.radius_edge > 0) o.mesh.fill.radius_edge = a.radius_edge;
  if (a.dihedral > 0) o.mesh.fill.dihedral_deg = a.dihedral;
  o.mesh.fill.timeout_s = a.timeout_s;
  o.space = a.space;
  o.outputs = a.outputs;
  o.reports = a.reports;
  set_label_tables(a, o);
  o.write.per_label = a.per_label;
  o.write.msh2 = a.msh2;
  o.strict = a.strict;
  set_enhancement(command, a.enhance, o);
  o.option_texts = option_texts(command, a, o);
  return o;
}

std::string layers_text(const VolumeCheck& v) {
  if (v.wedges + v.pyramids == 0) return "";
  char text[120];
  std::snprintf(text, sizeof text, ", %zu wedges, %zu pyramids (scaled Jacobian from %.2f)", v.wedges, v.pyramids,
                v.wedge_scaled_jacobian_min);
  return text;
}

void print_summary(const RunReport& r, const std::vector<std::string>& outputs) {
  std::printf("input    %zu sections, %zu labels, %zu contour vertices\n", r.input.sections, r.labels.size(),
              r.contours.vertices);
  std::printf("surface  %zu triangles, %zu open edges, %zu self-intersections (%s)\n", r.surface->triangles,
              r.surface->open_edges, r.surface->self_intersections, r.surface_level.c_str());
  if (r.volume)
    std::printf("volume   %zu tetrahedra%s, dihedral angles %.2f to %.2f degrees, closure %s\n", r.volume->tets,
                layers_text(*r.volume).c_str(), r.volume->dihedral_min_deg, r.volume->dihedral_max_deg,
                r.closure.c_str());
  for (const std::string& o : outputs) std::printf("written  %s\n", printable(o).c_str());
}

void add(CLI::App& program, const char* name, const char* description, Target target, Purpose purpose) {
  CLI::App* command = program.add_subcommand(name, description);
  auto a = std::make_shared<MeshArguments>();
  add_options(*command, *a, target);
  command->callback([a, command, target, purpose] {
    const MeshRunOptions options = to_options(*command, *a, target);
    if (purpose == Purpose::check) return;
    const auto progress = a->terminal.make_progress();
    const RunReport report = run_mesh(options, *progress);
    if (!a->return_parameters.empty())
      write_return_parameters(
          a->return_parameters,
          {{"closure", report.closure}, {"tetrahedra", std::to_string(report.volume ? report.volume->tets : 0)}});
    if (a->terminal.quiet) return;
    print_warnings(report.warnings);
    if (a->terminal.for_slicer()) return;
    print_summary(report, a->outputs);
  });
}

}  // namespace

MeshOptionSource add_mesh_options(CLI::App& command, int default_order, Target target) {
  auto a = std::make_shared<MeshArguments>();
  a->order = default_order;
  add_options(command, *a, target);
  CLI::App* const app = &command;
  return {[a, app, target] { return to_options(*app, *a, target); }, [a] { return a->terminal.make_progress(); },
          [a] { return a->terminal.quiet; }};
}

void add_mesh_command(CLI::App& program, Purpose purpose) {
  add(program, "mesh", "Label stack to a verified volume mesh (and its surface)", Target::volume, purpose);
}
void add_surface_command(CLI::App& program, Purpose purpose) {
  add(program, "surface", "Label stack to a verified surface", Target::surface, purpose);
}

}  // namespace stackmesh::app
