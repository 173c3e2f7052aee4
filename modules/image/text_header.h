#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace stackmesh {

/// Fields by lower-case name, NRRD's keys ("name:=value") with their own case and a leading '='; where the header ends.
struct TextHeader {
  std::map<std::string, std::string> fields;
  std::uint64_t end = 0;
  bool ended = false;
  std::string get(const std::string& name) const {
    const auto found = fields.find(name);
    return found == fields.end() ? "" : found->second;
  }
};

constexpr std::size_t kMaxHeader = 1 << 22;

/// @throws Error(input) when it is no NRRD file.
TextHeader read_nrrd_header(const std::string& path);

std::string trim(const std::string& text);
std::vector<std::string> words(const std::string& text);
/// @throws Error(input) naming the field
double to_number(const std::string& text, const std::string& field, const std::string& path);
std::vector<double> numbers(const std::string& text, const std::string& field, const std::string& path);

}  // namespace stackmesh
