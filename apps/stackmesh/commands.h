#pragma once
#include <CLI/CLI.hpp>
#include <functional>
#include <memory>

#include "base/monitor.h"
#include "pipeline/mesh_run.h"

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
MeshOptionSource add_mesh_options(CLI::App& command, int default_order);

}  // namespace stackmesh::app
