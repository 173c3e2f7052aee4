#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/monitor.h"

namespace stackmesh::app {

/// The description of `mesh` that 3D Slicer asks for with --xml (Slicer execution model).
std::string slicer_description();

/// True for a command line as 3D Slicer builds it from that description: no command, but flags and then input and
/// output.
bool is_slicer_call(int argc, char** argv);

/// The same call as a command line of `mesh`: "mesh INPUT -o OUTPUT --progress slicer --edge-length 2 ...". @throws
/// Error(usage)
std::vector<std::string> translate_slicer_call(int argc, char** argv);

/// Monitor as Slicer reads it from stdout: <filter-start>, <filter-progress> of the whole run, <filter-end> for each
/// stage.
std::unique_ptr<Monitor> make_slicer_progress();

/// Writes "name = value" lines, as Slicer reads them back. @throws Error(output)
void write_return_parameters(const std::string& path, const std::vector<std::pair<std::string, std::string>>& values);

}  // namespace stackmesh::app
