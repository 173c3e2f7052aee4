#include "image/text_header.h"

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "base/error.h"
#include "base/text.h"
#include "image/file_names.h"

namespace stackmesh {
namespace {

[[noreturn]] void damaged(const std::string& what, const std::string& path) {
  fail_input(what, path, "copy or export the file again");
}

}  // namespace

std::string trim(const std::string& text) {
  const std::size_t a = text.find_first_not_of(" \t\r\n"), b = text.find_last_not_of(" \t\r\n");
  return a == std::string::npos ? "" : text.substr(a, b - a + 1);
}

std::vector<std::string> words(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> list;
  for (std::string w; stream >> w;) list.push_back(w);
  return list;
}

double to_number(const std::string& text, const std::string& field, const std::string& path) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0')
    damaged("the header is damaged: '" + text + "' in field '" + field + "'", path);
  return value;
}

std::vector<double> numbers(const std::string& text, const std::string& field, const std::string& path) {
  std::vector<double> list;
  for (const std::string& w : words(text)) list.push_back(to_number(w, field, path));
  return list;
}

TextHeader read_nrrd_header(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string line;
  if (!file || !std::getline(file, line)) damaged("the file is empty or cannot be read", path);
  if (line.compare(0, 7, "NRRD000") != 0) damaged("this is no NRRD file, or its header is damaged", path);
  TextHeader header;
  while (static_cast<std::size_t>(file.tellg()) < kMaxHeader && std::getline(file, line)) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty()) {
      header.ended = true;
      header.end = static_cast<std::uint64_t>(file.tellg());
      break;
    }
    if (line[0] == '#') continue;
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) continue;
    if (line.compare(colon, 2, ":=") == 0)
      header.fields["=" + line.substr(0, colon)] = trim(line.substr(colon + 2));
    else
      header.fields[lower_case(trim(line.substr(0, colon)))] = trim(line.substr(colon + 1));
  }
  return header;
}

}  // namespace stackmesh
