#include "image/text_header.h"

#include <algorithm>
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
  if (text.empty() || *end != '\0') damaged("the header is damaged: '" + text + "' in field '" + field + "'", path);
  return value;
}

std::vector<double> numbers(const std::string& text, const std::string& field, const std::string& path) {
  std::vector<double> list;
  for (const std::string& w : words(text)) list.push_back(to_number(w, field, path));
  return list;
}

std::string read_header_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) fail_input("cannot open the file", path, "check that you may read it");
  std::string text(kMaxHeader, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

bool next_line(const std::string& text, std::size_t& at, std::string& line) {
  if (at >= text.size()) return false;
  const std::size_t end = std::min(text.find('\n', at), text.size());
  line = text.substr(at, end - at);
  if (!line.empty() && line.back() == '\r') line.pop_back();
  at = std::min(end + 1, text.size());
  return true;
}

TextHeader read_nrrd_header(const std::string& path) {
  const std::string text = read_header_text(path);
  std::string line;
  std::size_t at = 0;
  if (!next_line(text, at, line)) damaged("the file is empty or cannot be read", path);
  if (line.compare(0, 7, "NRRD000") != 0) damaged("this is no NRRD file, or its header is damaged", path);
  TextHeader header;
  while (next_line(text, at, line)) {
    if (line.empty()) {
      header.ended = true;
      header.end = at;
      break;
    }
    if (line[0] == '#') continue;
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos || colon == 0) continue;
    if (line.compare(colon, 2, ":=") == 0) {
      header.fields["=" + line.substr(0, colon)] = trim(line.substr(colon + 2));
      continue;
    }
    const std::string field = lower_case(trim(line.substr(0, colon)));
    header.fields[field] = trim(line.substr(colon + 1));
    if ((field == "data file" || field == "datafile") && header.fields[field].compare(0, 4, "LIST") == 0) {
      while (next_line(text, at, line) && !trim(line).empty()) header.list.push_back(trim(line));
      break;
    }
  }
  return header;
}

}  // namespace stackmesh
