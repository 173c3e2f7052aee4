#pragma once
#include <string>
#include <vector>

#include "report/run_report.h"

namespace stackmesh {

/// Digests of the input's files (a file; a folder's or glob's files; LABEL=FILE pairs; the detached data of .nhdr and
/// .mhd), and the program and the machine. No host or user name, and nothing that stands inside the input. Files that
/// cannot be read are left out.
Provenance find_provenance(const std::vector<std::string>& input_paths);

}  // namespace stackmesh
