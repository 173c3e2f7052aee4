#include "model/label_volume.h"

#include <algorithm>
#include <limits>
#include <set>

#include "base/error.h"

namespace stackmesh {

std::vector<std::size_t> count_voxels(const LabelVolume& volume) {
  std::vector<std::size_t> counts(volume.labels.size(), 0);
  for (std::uint16_t v : volume.voxels) ++counts[v];
  return counts;
}

LabelVolume select_labels(LabelVolume volume, const std::vector<std::size_t>& keep, bool merge) {
  std::vector<std::uint16_t> target(volume.labels.size(), 0);
  std::vector<LabelInfo> labels = {volume.labels[0]};
  for (std::size_t k : keep) {
    if (!merge || labels.size() == 1) labels.push_back(volume.labels[k]);
    target[k] = static_cast<std::uint16_t>(labels.size() - 1);
  }
  volume.labels = std::move(labels);
  for (std::uint16_t& v : volume.voxels) v = target[v];
  return volume;
}

namespace {

bool is_number(const std::string& text) {
  return !text.empty() && text.size() < 10 &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

std::string list_labels(const std::vector<LabelInfo>& labels) {
  std::string text;
  for (std::size_t i = 1; i < labels.size() && i <= 12; ++i) {
    text += (i > 1 ? ", " : "") + std::to_string(labels[i].number);
    if (!labels[i].name.empty()) text += " (" + labels[i].name + ")";
  }
  if (labels.size() > 13) text += ", ...";
  return text;
}

}  // namespace

std::vector<std::size_t> resolve_labels(const std::vector<LabelInfo>& labels, const std::string& text) {
  std::set<std::size_t> chosen;
  if (text.empty()) {
    for (std::size_t i = 1; i < labels.size(); ++i) chosen.insert(i);
    return {chosen.begin(), chosen.end()};
  }
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string item = text.substr(begin, end - begin);
    begin = end + 1;
    if (item.empty())
      fail_usage("empty entry in a list of labels", "'" + text + "'", "write --label 1,4,7-9,NAME");
    const std::size_t before = chosen.size();
    const std::size_t dash = item.find('-');
    // A name wins over a range, so that "lung-2" can be a name.
    for (std::size_t i = 1; i < labels.size(); ++i)
      if (labels[i].name == item) chosen.insert(i);
    bool known = chosen.size() > before || std::any_of(labels.begin() + 1, labels.end(),
                                                       [&](const LabelInfo& l) { return l.name == item; });
    if (!known && (is_number(item) || (dash != std::string::npos && is_number(item.substr(0, dash)) &&
                                       is_number(item.substr(dash + 1))))) {
      const long low = std::stol(item.substr(0, dash));
      const long high = dash == std::string::npos ? low : std::stol(item.substr(dash + 1));
      if (high < low)
        fail_usage("a range of labels runs downwards", "'" + item + "'", "write the smaller number first");
      for (std::size_t i = 1; i < labels.size(); ++i)
        if (labels[i].number >= low && labels[i].number <= high) {
          chosen.insert(i);
          known = true;
        }
    }
    if (!known)
      fail_input("label '" + item + "' is not in the input", "--label " + text,
                 "choose among: " + list_labels(labels));
  }
  return {chosen.begin(), chosen.end()};
}

}  // namespace stackmesh
