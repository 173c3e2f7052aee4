#include "model/label_table.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include "base/error.h"

namespace stackmesh {
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

/// A name as it can be typed in a list: '_' for anything but letters, digits, '.', '+' and '-'.
std::string typed(std::string name) {
  for (char& c : name) {
    const auto u = static_cast<unsigned char>(c);
    if (u < 128 && !std::isalnum(u) && c != '.' && c != '+' && c != '-') c = '_';
  }
  return name;
}

/// Appends the labels that `item` names: by its exact name, else as it is typed ("Lt_Lung" for "Lt Lung"), else by
/// number or range. @return false when there is none
bool choose(const std::vector<LabelInfo>& labels, const std::string& item, std::vector<std::size_t>& chosen) {
  const auto take = [&](auto fits) {
    bool any = false;
    for (std::size_t i = 1; i < labels.size(); ++i) {
      if (!fits(labels[i])) continue;
      any = true;
      if (std::find(chosen.begin(), chosen.end(), i) == chosen.end()) chosen.push_back(i);
    }
    return any;
  };
  // A name wins over a range, so that "lung-2" can be a name.
  if (take([&](const LabelInfo& l) { return l.name == item; })) return true;
  const std::size_t dash = item.find('-');
  if (is_number(item) ||
      (dash != std::string::npos && is_number(item.substr(0, dash)) && is_number(item.substr(dash + 1)))) {
    const long low = std::stol(item.substr(0, dash));
    const long high = dash == std::string::npos ? low : std::stol(item.substr(dash + 1));
    if (high < low) fail_usage("a range of labels runs downwards", "'" + item + "'", "write the smaller number first");
    return take([&](const LabelInfo& l) { return l.number >= low && l.number <= high; });
  }
  return take([&](const LabelInfo& l) { return !l.name.empty() && typed(l.name) == typed(item); });
}

/// Indices of labels, 0 excluded.
std::vector<std::size_t> labels_in_order(const std::vector<LabelInfo>& labels, const std::string& text,
                                         const std::string& option) {
  std::vector<std::size_t> chosen;
  if (text.empty()) {
    for (std::size_t i = 1; i < labels.size(); ++i) chosen.push_back(i);
    return chosen;
  }
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string item = text.substr(begin, end - begin);
    begin = end + 1;
    if (item.empty())
      fail_usage("empty entry in a list of labels", option + " '" + text + "'", "write labels as 1,4,7-9,NAME");
    if (!choose(labels, item, chosen))
      fail_input("label '" + item + "' is not in the input", option + " " + text,
                 "choose among: " + list_labels(labels));
  }
  return chosen;
}

}  // namespace

LabelTable::LabelTable(const std::vector<LabelInfo>& labels) : rows_({{0, ""}}) {
  rows_.insert(rows_.end(), labels.begin(), labels.end());
}

LabelTable::LabelTable(const LabelVolume& volume) : rows_(volume.labels) {}

LabelTable::LabelTable(const std::vector<LabelContours>& contours) : rows_({{0, ""}}) {
  for (const LabelContours& c : contours) rows_.push_back({c.label, c.name, c.colour});
}

std::vector<std::size_t> LabelTable::in_order(const std::string& text, const std::string& option) const {
  std::vector<std::size_t> chosen = labels_in_order(rows_, text, option);
  for (std::size_t& k : chosen) --k;
  return chosen;
}

std::vector<std::size_t> LabelTable::resolve(const std::string& text, const std::string& option) const {
  std::vector<std::size_t> chosen = in_order(text, option);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

std::vector<Label> LabelTable::numbers(const std::string& text, const std::string& option) const {
  std::vector<Label> numbers;
  for (const std::size_t k : resolve(text, option)) numbers.push_back(rows_[k + 1].number);
  return numbers;
}

}  // namespace stackmesh
