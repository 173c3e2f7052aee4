#include "cohort/cohort_case.h"

#include <algorithm>
#include <map>

#include "base/text.h"
#include "cohort/cohort_folder.h"

namespace stackmesh {

std::vector<std::string> words_of(const std::vector<OptionValue>& options) {
  std::vector<std::string> words;
  for (const OptionValue& o : options) {
    if (o.values.empty()) words.push_back("--" + o.name);
    for (const std::string& value : o.values) words.push_back("--" + o.name + "=" + value);
  }
  return words;
}

std::vector<OptionValue> merged(const std::vector<OptionValue>& of_all, const std::vector<OptionValue>& own) {
  std::map<std::string, OptionValue> by_name;
  for (const OptionValue& o : of_all) by_name[o.name] = o;
  for (const OptionValue& o : own) by_name[o.name] = o;
  std::vector<OptionValue> all;
  for (const auto& [name, option] : by_name) all.push_back(option);
  return all;
}

std::string fault_of_id(const std::string& id) {
  constexpr std::size_t kLongest = 180;  // with what is put before and behind it, below the 255 bytes of a name
  if (id.empty()) return "is empty";
  if (id.find('/') != std::string::npos) return "holds a slash";
  if (id.find(',') != std::string::npos) return "holds a comma";
  if (id == "failed") return "has a meaning of its own for --only";
  if (id.find("..") != std::string::npos) return "holds '..'";
  if (id[0] == '.' || id[0] == '-') return std::string("begins with '") + id[0] + "'";
  if (id.size() > kLongest) return "is longer than " + std::to_string(kLongest) + " bytes";
  if (printable(id) != id || id.find_first_of("\n\r\t") != std::string::npos) return "holds control characters";
  if (id.back() == ' ' || id.front() == ' ') return "begins or ends with a blank";
  if (ends_with(id, kFailedEnding)) return std::string("ends in '") + kFailedEnding + "', which marks a failed case";
  if (id == kThumbnailFolder || id.rfind("cohort.", 0) == 0) return "is a name of the cohort's own files";
  return "";
}

}  // namespace stackmesh
