#pragma once
#include <CLI/CLI.hpp>
#include <functional>
#include <memory>

#include "base/monitor.h"
#include "run/fem_run.h"
#include "run/mesh_run.h"
#include "run/validate_run.h"

namespace stackmesh::app {

/// Each adds its command to the program; the command runs when it is parsed.
/// With Purpose::check the commands that make meshes only tell whether they understand their options. @throws
/// Error(usage) where not
enum class Purpose { run, check };
void add_mesh_command(CLI::App& program, Purpose purpose = Purpose::run);
void add_surface_command(CLI::App& program, Purpose purpose = Purpose::run);
void add_contours_command(CLI::App& program);
void add_info_command(CLI::App& program);
void add_validate_command(CLI::App& program);
void add_fem_command(CLI::App& program, Purpose purpose = Purpose::run);
/// @param case_words what stood behind "--" on the command line: the options of each case
void add_batch_command(CLI::App& program, const std::vector<std::string>& case_words);
void add_collect_command(CLI::App& program);

/// Takes the words from "--" on out of a call of `batch`, without the "--".
std::vector<std::string> take_case_words(std::vector<std::string>& arguments);

/// The options of `mesh`, on another command that takes them all; to be asked once the command line is parsed.
struct MeshOptionSource {
  std::function<MeshRunOptions()> options;  ///< @throws Error(usage)
  std::function<std::unique_ptr<Monitor>()> progress;
  std::function<bool()> quiet;
};
MeshOptionSource add_mesh_options(CLI::App& command, int default_order, Target target = Target::volume);

/// All options of `fem`, those of `mesh` among them.
struct FemOptionSource {
  std::function<FemRunOptions()> options;  ///< @throws Error(usage)
  std::function<std::unique_ptr<Monitor>()> progress;
  std::function<bool()> quiet;
};
FemOptionSource add_fem_options(CLI::App& command);

/// All options of `validate`.
struct ValidateOptionSource {
  std::function<ValidateRunOptions()> options;  ///< @throws Error(usage), Error(input)
  std::function<std::unique_ptr<Monitor>()> progress;
  std::function<bool()> quiet;
};
ValidateOptionSource add_validate_options(CLI::App& command);

/// What `info --json` prints of an input. @throws Error(input), Error(usage)
std::string info_json(const InputOptions& input);

}  // namespace stackmesh::app
