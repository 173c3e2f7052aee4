#pragma once
#include <string>

namespace stackmesh {

/// The text of a JSON file, looked at before a parser is: lists and objects at most 64 deep (parsers and copies call
/// themselves), numbers that a double holds. Whether it is JSON at all is the parser's to say.
/// @param path of the file; only a regular file is read
/// @param what the file is, for an error: "the material law"
/// @param mend what the user may do where it cannot be read or is nested too deep, for an error: "check the path"
/// @throws Error(input)
std::string read_json_text(const std::string& path, const std::string& what, const std::string& mend);

}  // namespace stackmesh
