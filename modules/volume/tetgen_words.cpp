#include "volume/tetgen_words.h"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <set>

namespace stackmesh::volume {

std::string complaint(const std::string& text) {
  static const char* const signs[] = {"intersect",       "Invalid PLC",   "duplicated", "nearly overlap",
                                      "identical verts", "is replaced",   "trivial",    "needs at least",
                                      "rror:",           "internal error"};
  std::vector<std::string> told;
  std::string line;
  for (std::size_t at = 0; at <= text.size(); ++at) {
    if (at < text.size() && text[at] != '\n') {
      if (static_cast<unsigned char>(text[at]) >= ' ') line += text[at];
      continue;
    }
    const std::size_t assertion = line.find("Assertion");
    const bool matters = std::any_of(std::begin(signs), std::end(signs),
                                     [&](const char* s) { return line.find(s) != std::string::npos; });
    if (assertion != std::string::npos) {
      told.push_back(line.substr(assertion, 120));
    } else if (matters && line.find('[') == std::string::npos) {
      line.erase(0, line.find_first_not_of(' '));
      line.erase(line.find_last_not_of(" .") + 1);
      told.push_back(line.substr(0, 120));
    }
    line.clear();
  }
  return told.empty() ? "" : told.back();  // the last one is what stopped it
}

std::vector<std::int32_t> named_triangles(const std::string& text, const Compact& input) {
  std::set<std::set<std::int32_t>> named;
  for (std::size_t at = 0; (at = text.find_first_of("[(", at)) != std::string::npos; ++at) {
    int a = -1, b = -1, c = -1;
    if (std::sscanf(text.c_str() + at + 1, "%d , %d , %d", &a, &b, &c) == 3) {
      named.insert({a, b, c});
    } else if (std::sscanf(text.c_str() + at + 1, "%d , %d", &a, &b) == 2) {
      named.insert({a, b});
    }
  }
  std::vector<std::int32_t> out;
  if (named.empty()) return out;
  for (std::size_t i = 0; 3 * i < input.corners.size(); ++i) {
    const std::int32_t* c = input.corners.data() + 3 * i;
    if (named.count({c[0], c[1], c[2]}) || named.count({c[0], c[1]}) || named.count({c[1], c[2]}) ||
        named.count({c[2], c[0]}))
      out.push_back(static_cast<std::int32_t>(i));
  }
  return out;
}

}  // namespace stackmesh::volume
