#include <algorithm>
#include <cstdio>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "commands.h"
#include "meshio/write_sections.h"
#include "options.h"
#include "run/output_files.h"

namespace stackmesh::app {
namespace {

struct ContoursArguments {
  InputArguments input;
  ContourArguments contours;
  TerminalArguments terminal;
  std::string output;
};

/// A .cnt file holds one label: several go to NAME_<label>.cnt.
std::string written_name(const std::string& output, const Stack& stack) {
  std::set<Label> labels;
  for (const Section& s : stack.sections)
    for (const SectionEdge& e : s.edges) labels.insert({e.left, e.right});
  labels.erase(0);
  const std::size_t dot = output.rfind('.');
  const bool one_file = labels.size() < 2 || output.substr(dot + 1).find_first_of("cC") != 0;
  return one_file ? output : output.substr(0, dot) + "_<label>" + output.substr(dot);
}

void run(const ContoursArguments& a) {
  if (!is_section_format(a.output)) fail_usage("unknown ending of an output", a.output, "choose .json, .svg or .cnt");
  check_output_files({a.output}, a.input.paths);
  const auto progress = a.terminal.make_progress();
  const SectionOptions options = a.contours.options();
  Input input = read_input(a.input.options());
  check_stack_axis(input, options.contours.axis);
  if (input.volume && !options.as_stored && options.band_px > 0) reduce_to_true_grid(input, options.contours.threads);
  Stack stack =
      !input.volume ? drawn_sections(input) : volume_sections(*input.volume, options, *progress).contours.stack;
  stack.sections.erase(
      std::remove_if(stack.sections.begin(), stack.sections.end(), [](const Section& s) { return s.interpolated; }),
      stack.sections.end());
  AtomicFiles files;
  write_sections(files, a.output, stack);
  files.commit();
  if (a.terminal.quiet) return;
  print_warnings(input.warnings);
  std::size_t vertices = 0, edges = 0;
  for (const Section& s : stack.sections) {
    vertices += s.points.size();
    edges += s.edges.size();
  }
  std::printf("%zu sections, %zu vertices, %zu edges: %s\n", stack.sections.size(), vertices, edges,
              printable(written_name(a.output, stack)).c_str());
}

}  // namespace

void add_contours_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("contours", "The simplified sections as .json, .svg or .cnt");
  auto a = std::make_shared<ContoursArguments>();
  a->input.add_to(*command, true);
  command->add_option("-o,--output", a->output, "output file: .json, .svg or .cnt")->required();
  a->contours.add_to(*command);
  a->terminal.add_to(*command);
  command->callback([a] { run(*a); });
}

}  // namespace stackmesh::app
