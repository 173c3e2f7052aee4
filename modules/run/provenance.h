#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "report/run_report.h"

namespace stackmesh {

/// Digest of an input's files: of a file its own; of several that of the lines "digest  name" in order of name.
struct InputDigest {
  std::string sha256;  ///< empty where there is no file
  std::size_t files = 0;
};
InputDigest digest_of_input(const std::vector<std::string>& input_paths);

/// Digests of the input's files (a file; a folder's or glob's files; LABEL=FILE pairs; the detached data of .nhdr and
/// .mhd), and the program and the machine. No host or user name, and nothing that stands inside the input. Files that
/// cannot be read are left out.
Provenance find_provenance(const std::vector<std::string>& input_paths);

}  // namespace stackmesh
