#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace stackmesh {

/// Fields by lower-case name, NRRD's keys ("name:=value") with their own case and a leading '='; where the header ends.
struct TextHeader {
  std::map<std::string, std::string> fields;
  std::vector<std::string> list;  ///< NRRD, "data file: LIST": the names that follow
  std::uint64_t end = 0;
  bool ended = false;
  std::string get(const std::string& name) const {
    const auto found = fields.find(name);
    return found == fields.end() ? "" : found->second;
  }
};

constexpr std::size_t kMaxHeader = 1 << 22;

/// The beginning of a file, at most kMaxHeader bytes. @throws Error(input)
std::string read_header_text(const std::string& path);
/// The line that begins at `at`, without its end; `at` goes behind it. False at the end of the text.
bool next_line(const std::string& text, std::size_t& at, std::string& line);

/// @throws Error(input) when it is no NRRD file.
TextHeader read_nrrd_header(const std::string& path);

std::string trim(const std::string& text);
std::vector<std::string> words(const std::string& text);
/// @throws Error(input) naming the field
double to_number(const std::string& text, const std::string& field, const std::string& path);
std::vector<double> numbers(const std::string& text, const std::string& field, const std::string& path);

}  // namespace stackmesh
