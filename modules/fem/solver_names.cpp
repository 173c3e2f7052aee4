#include "fem/solver_names.h"

#include <set>

#include "base/text.h"

namespace stackmesh {

std::string sanitised_name(const std::string& text) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  std::string name = text;
  for (char& c : name)
    if (!letter(c) && !(c >= '0' && c <= '9')) c = '_';
  return name.empty() || !letter(name[0]) ? "L_" + name : name;
}

std::vector<LabelInfo> solver_names(std::vector<LabelInfo> labels) {
  constexpr std::size_t longest = 40;
  std::set<std::string> taken = {"nall", "eall", "background"};
  for (LabelInfo& label : labels) {
    const std::string name =
        (label.name.empty() ? "label_" + std::to_string(label.number) : sanitised_name(label.name)).substr(0, longest);
    label.name = name;
    for (int n = 2; !taken.insert(lower_case(label.name)).second; ++n) {
      const std::string tail = "_" + std::to_string(n);
      label.name = name.substr(0, longest - tail.size()) + tail;
    }
  }
  return labels;
}

}  // namespace stackmesh
