#include "image/read_label_table.h"

#include <fstream>
#include <set>
#include <sstream>

#include "base/error.h"

namespace stackmesh {
namespace {

bool is_whole(const std::string& word) {
  return !word.empty() && word.size() < 10 && word.find_first_not_of("0123456789") == std::string::npos;
}

std::optional<std::uint8_t> colour_part(const std::string& word) {
  return is_whole(word) && std::stol(word) < 256
             ? std::optional<std::uint8_t>(static_cast<std::uint8_t>(std::stol(word)))
             : std::nullopt;
}

std::optional<std::array<std::uint8_t, 3>> colour_of(const std::vector<std::string>& words, std::size_t from) {
  if (words.size() < from + 3) return std::nullopt;
  std::array<std::uint8_t, 3> c{};
  for (int k = 0; k < 3; ++k) {
    const auto part = colour_part(words[from + k]);
    if (!part) return std::nullopt;
    c[k] = *part;
  }
  return c;
}

}  // namespace

std::vector<LabelInfo> read_label_table(const std::string& path) {
  std::ifstream file(path);
  if (!file) fail_input("the label table cannot be read", path, "check the path of --names");
  std::vector<LabelInfo> table;
  std::set<Label> seen;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const auto bad = [&](const std::string& what) {
      fail_input(what, path + ", line " + std::to_string(number),
                 "give lines of a Slicer colour table (number name R G B A) or an ITK-SNAP label description (number R "
                 "G B A V M \"name\")");
    };
    if (line.find('\0') != std::string::npos) bad("the label table is no text");
    LabelInfo info;
    const std::size_t quote = line.find('"');
    const bool snap = quote != std::string::npos;
    std::istringstream text(line.substr(0, quote));
    std::vector<std::string> words;
    for (std::string w; text >> w;) words.push_back(w);
    if (!snap && (words.empty() || words[0][0] == '#')) continue;
    if (words.empty() || words[0][0] == '#') continue;
    if (!is_whole(words[0])) bad("a line does not begin with a label's number");
    info.number = static_cast<Label>(std::stol(words[0]));
    if (snap) {
      const std::size_t end = line.find('"', quote + 1);
      if (end == std::string::npos || words.size() < 4) bad("a line holds no name in quotes behind its colour");
      info.name = line.substr(quote + 1, end - quote - 1);
      info.colour = colour_of(words, 1);
    } else {
      if (words.size() < 2) bad("a line holds no name");
      info.name = words[1];
      info.colour = colour_of(words, 2);
    }
    if (!seen.insert(info.number).second) bad("label " + words[0] + " is there twice");
    if (info.number != 0) table.push_back(info);
  }
  if (table.empty()) fail_input("the label table names no label", path, "check that it is a label table");
  return table;
}

void apply_label_table(const std::vector<LabelInfo>& table, std::vector<LabelInfo>& labels) {
  for (LabelInfo& label : labels)
    for (const LabelInfo& row : table)
      if (row.number == label.number && label.number != 0) {
        label.name = row.name;
        if (row.colour) label.colour = row.colour;
      }
}

}  // namespace stackmesh
