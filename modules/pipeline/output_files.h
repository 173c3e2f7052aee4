#pragma once
#include <string>
#include <vector>

namespace stackmesh {

/// Looks at a run's output files before it begins: each can be written, no two are one file, and none is an input (a file, or
/// LABEL=FILE). What ended runs have left of them is removed. @throws Error(usage), Error(output)
void check_output_files(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs);

}  // namespace stackmesh
