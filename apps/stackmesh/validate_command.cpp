#include <cstdio>
#include <memory>

#include "base/error.h"
#include "base/text.h"
#include "commands.h"
#include "options.h"
#include "report/comparison.h"
#include "run/validate_run.h"

namespace stackmesh::app {
namespace {

struct ValidateArguments {
  std::vector<std::string> meshes, reports, against;
  bool allow_outside = false;
  std::string spacing, labels, voids, axis = "auto", space = "auto", array, limits, defects;
  bool as_stored = false, merge = false, write_defects = false;
  int threads = 0;
  TerminalArguments terminal;
};

ValidateRunOptions to_options(const ValidateArguments& a) {
  ValidateRunOptions o;
  o.meshes = a.meshes;
  if (!a.against.empty()) {
    InputArguments input;
    input.paths = a.against, input.spacing = a.spacing, input.labels = a.labels, input.merge = a.merge,
    input.allow_outside = a.allow_outside;
    o.against = input.options();
    o.against->voids = a.voids;
  } else if (!a.labels.empty() || !a.voids.empty() || a.merge) {
    fail_usage("--label, --void and --merge choose labels of --against", "command line",
               "name the labels with --against");
  }
  ContourArguments contours;
  contours.axis = a.axis;
  o.axis = contours.options().contours.axis;
  o.as_stored = a.as_stored;
  o.mesh_space = a.space;
  o.read.label_array = a.array;
  if (!a.limits.empty()) o.limits = read_limits(a.limits);
  o.reports = a.reports;
  o.write_defects = a.write_defects || !a.defects.empty();
  o.defects_folder = a.defects;
  o.threads = a.threads;
  o.version = STACKMESH_VERSION;
  o.option_texts = {{"label", a.labels.empty() ? "all" : a.labels},
                    {"void", a.voids.empty() ? "none" : a.voids},
                    {"merge", a.merge ? "on" : "off"},
                    {"axis", a.axis},
                    {"as_stored", a.as_stored ? "on" : "off"},
                    {"mesh_space", a.space},
                    {"label_array", a.array.empty() ? "auto" : a.array},
                    {"limits", a.limits.empty() ? "default" : a.limits},
                    {"threads", a.threads > 0 ? std::to_string(a.threads) : "all"}};
  return o;
}

/// Exit 4 or 6 with its reason on one line.
void fail_by_verdict(const std::vector<RunReport>& reports) {
  for (const int code : {4, 6})
    for (const RunReport& r : reports) {
      if (exit_code(r.verdicts) != code) continue;
      std::string what;
      for (const Verdict& v : r.verdicts)
        if (v.status == Status::fail && (code == 6 || v.validity))
          what += (what.empty() ? "" : "; ") + v.title + ": " + v.figure;
      for (char& c : what)
        if (c == ';') c = ',';
      throw Error(code == 4 ? ErrorKind::no_result : ErrorKind::outside_limits,
                  (code == 4 ? "the mesh is invalid: " : "the mesh is valid but outside a limit: ") + what,
                  r.mesh->path,
                  code == 4 ? "mend it where the summary and the report say" : "mend it, or set other --limits");
    }
}

}  // namespace

ValidateOptionSource add_validate_options(CLI::App& command) {
  auto a = std::make_shared<ValidateArguments>();
  command
      .add_option("MESH", a->meshes,
                  "surface or volume meshes: .stl .ply .obj .off .vtp .vtk .vtu .msh .inp .mesh; several are compared")
      ->required();
  command.add_option("--against", a->against,
                     "label volume, folder or glob of slices, masks, or .cnt files that the mesh stands for");
  command.add_option("--report", a->reports, "report file, .json or .html; repeatable")->allow_extra_args(false);
  command.add_option("--label", a->labels,
                     "labels to judge: 1,4,7-9,femur_left; one label: what a mesh without labels stands for");
  command.add_option("--void,--keep-sets", a->voids, "labels that the mesh leaves empty");
  command.add_flag("--merge", a->merge, "the selected labels are one");
  command.add_option("--limits", a->limits, "JSON file with other limits than the default");
  command
      .add_option("--mesh-space,--space", a->space,
                  "frame of the meshes: lps, ras, image (indices times spacing, 0 the first voxel's centre), or auto: "
                  "their own mark, else what overlaps best")
      ->capture_default_str();
  command.add_option("--label-array", a->array, "cell array of the mesh that holds the labels");
  command.add_option("--spacing", a->spacing, "voxel size of PNG/TIFF slices, X,Y,Z in mm");
  command.add_flag("--as-stored", a->as_stored,
                   "take labels that are stored finer than they were made as they are stored");
  command.add_flag("--allow-outside", a->allow_outside,
                   "a detached header (.nhdr, .mhd) may name data files outside of its own folder");
  add_memory_option(command);
  command.add_option("--axis", a->axis, "stacking axis: auto, x, y or z")->capture_default_str();
  command.add_flag("--write-defects", a->write_defects,
                   "NAME.defects.vtp with the offending triangles, beside the report");
  command.add_option("--defects", a->defects, "the same, into this folder");
  command.add_option("--threads", a->threads, "threads; 0 is all")->check(CLI::Range(0, 4096))->capture_default_str();
  a->terminal.add_to(command);
  return {[a] { return to_options(*a); }, [a] { return a->terminal.make_progress(); },
          [a] { return a->terminal.quiet; }};
}

void add_validate_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "validate", "Judge meshes of any program, on their own and against the labels they stand for");
  const ValidateOptionSource validate = add_validate_options(*command);
  command->callback([validate] {
    const ValidateRunOptions options = validate.options();
    const auto progress = validate.progress();
    const std::vector<RunReport> reports = run_validate(options, *progress);
    if (!validate.quiet()) {
      for (std::size_t i = 0; i < reports.size(); ++i) {
        print_warnings(reports[i].warnings);
        std::printf("%s%s", i ? "\n" : "", printable_lines(text_summary(reports[i])).c_str());
      }
      if (reports.size() > 1) std::printf("\n%s", printable_lines(text_table(reports)).c_str());
    }
    std::fflush(stdout);
    fail_by_verdict(reports);
  });
}

}  // namespace stackmesh::app
