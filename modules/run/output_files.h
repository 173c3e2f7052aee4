#pragma once
#include <string>
#include <vector>

namespace stackmesh {

struct MeshRunOptions;

/// Looks at a run's output files before it begins: each can be written, no two are one file, and none is an input (a
/// file, or LABEL=FILE). What ended runs have left of them is removed. @throws Error(usage), Error(output)
void check_output_files(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs);

/// The same for all that run_mesh() writes and reads; and each output's ending must be one of a format that holds it,
/// the space be known.
void check_mesh_outputs(const MeshRunOptions& options);

}  // namespace stackmesh
