#include "arguments.h"

#include <algorithm>
#include <set>

#include "base/error.h"

namespace stackmesh::python {
namespace {

/// What has no meaning here: a terminal's progress, limits of a whole process, 3D Slicer's file, and the functions' own
/// arguments.
const std::set<std::string> kNotHere = {"help", "progress", "quiet", "verbose", "max-memory", "return-parameters"};

void require_nothing(CLI::App& command) {
  for (CLI::Option* option : command.get_options([](const CLI::Option*) { return true; })) option->required(false);
}

void parse(CLI::App& command, const Arguments& arguments) {
  require_nothing(command);
  std::vector<std::string> words;
  for (const auto& [name, value] : arguments) {
    std::string option = "--" + name;
    std::replace(option.begin(), option.end(), '_', '-');
    words.push_back(value.empty() ? option : option + "=" + value);
  }
  std::reverse(words.begin(), words.end());  // as CLI11 takes a vector
  try {
    command.parse(words);
  } catch (const CLI::ParseError& e) {
    fail_usage(e.what(), "keyword arguments", "see help(stackmesh)");
  }
}

std::string kind_of(const CLI::Option& o) {
  if (o.get_items_expected_max() == 0) return "flag";
  if (o.get_items_expected_min() == 0) return "optional";
  if (o.get_items_expected_max() > 1) return "texts";
  const std::string type = o.get_type_name();
  return type.find("FLOAT") != std::string::npos || type.find("INT") != std::string::npos ? "number" : "text";
}

/// Every name that Python may use for an option; the first is the one that is shown.
std::vector<std::string> names_of(const CLI::Option& o) {
  std::vector<std::string> names = o.get_lnames();
  for (std::string& n : names) std::replace(n.begin(), n.end(), '-', '_');
  return names;
}

}  // namespace

std::vector<Keyword> keywords_of(const std::string& name) {
  CLI::App command;
  if (name == "fem") app::add_fem_options(command);
  else if (name == "validate") app::add_validate_options(command);
  else app::add_mesh_options(command, 1, name == "surface" ? Target::surface : Target::volume);
  std::vector<Keyword> keywords;
  for (const CLI::Option* o : command.get_options([](const CLI::Option*) { return true; })) {
    if (o->get_lnames().empty() || kNotHere.count(o->get_lnames()[0]) > 0) continue;
    const bool hidden = o->get_group().empty();  // accepted without effect
    const std::vector<std::string> names = names_of(*o);
    for (std::size_t i = 0; i < names.size(); ++i)
      keywords.push_back({names[i], kind_of(*o), o->get_default_str(),
                          hidden   ? "accepted without effect, as the command line does"
                          : i == 0 ? o->get_description()
                                   : "the same as " + names[0]});
  }
  return keywords;
}

MeshRunOptions mesh_options(const Arguments& arguments, Target target) {
  CLI::App command;
  const app::MeshOptionSource source = app::add_mesh_options(command, 1, target);
  parse(command, arguments);
  return source.options();
}

FemRunOptions fem_options(const Arguments& arguments) {
  CLI::App command;
  const app::FemOptionSource source = app::add_fem_options(command);
  parse(command, arguments);
  return source.options();
}

ValidateRunOptions validate_options(const std::vector<std::string>& meshes, const Arguments& arguments) {
  CLI::App command;
  const app::ValidateOptionSource source = app::add_validate_options(command);
  parse(command, arguments);
  ValidateRunOptions options = source.options();
  options.meshes = meshes;
  return options;
}

}  // namespace stackmesh::python
