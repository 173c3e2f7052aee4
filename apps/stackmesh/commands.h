#pragma once
#include <CLI/CLI.hpp>
#include <functional>
#include <memory>

#include "base/monitor.h"
#include "pipeline/fem_run.h"
#include "pipeline/mesh_run.h"
#include "pipeline/validate_run.h"

namespace stackmesh::app {

/// Each adds its command to the program; the command runs when it is parsed.
void add_mesh_command(CLI::App& program);
void add_surface_command(CLI::App& program);
void add_contours_command(CLI::App& program);
void add_info_command(CLI::App& program);
void add_validate_command(CLI::App& program);
void add_fem_command(CLI::App& program);

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
