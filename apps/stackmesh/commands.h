#pragma once
#include <CLI/CLI.hpp>
#include <functional>

namespace stackmesh::app {

/// Each adds its command to the program; the command runs when it is parsed.
void add_mesh_command(CLI::App& program);
void add_surface_command(CLI::App& program);
void add_contours_command(CLI::App& program);
void add_info_command(CLI::App& program);
void add_validate_command(CLI::App& program);

}  // namespace stackmesh::app
