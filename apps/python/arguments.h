#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"

namespace stackmesh::python {

/// An option of a command as a keyword argument.
struct Keyword {
  std::string name;     ///< "edge_length" for --edge-length
  std::string kind;     ///< "flag", "number", "text", "texts" (repeatable) or "optional" (with or without a value)
  std::string initial;  ///< the command line's default as text; "": none
  std::string description;
};

/// The options of `mesh`, `surface`, `fem` or `validate` that make sense in Python: all but those of a terminal and a
/// process.
std::vector<Keyword> keywords_of(const std::string& command);

/// Keyword arguments as the command line takes them: {"edge_length", "5=2.0"}; a flag has the value "".
using Arguments = std::vector<std::pair<std::string, std::string>>;

/// The command's own parsing of its own options, so that names, defaults and checks are those of the command line.
/// @throws Error(usage), Error(input)
MeshRunOptions mesh_options(const Arguments& arguments, Target target);
FemRunOptions fem_options(const Arguments& arguments);
ValidateRunOptions validate_options(const std::vector<std::string>& meshes, const Arguments& arguments);

}  // namespace stackmesh::python
