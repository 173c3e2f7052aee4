#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "model/contours.h"
#include "model/label_volume.h"

namespace stackmesh {

/// The labels of an input, without the background, as a user names them: by number, range or name.
/// A selection is a text such as "1,4,7-9,femur_left"; a name may be typed with '_' for a blank or another sign
/// (Lt_Lung for "Lt Lung"). An empty text selects all. Each function takes the option where the text was given, and
/// throws Error(usage) for a malformed text, Error(input) for an absent label.
class LabelTable {
 public:
  explicit LabelTable(const std::vector<LabelInfo>& labels);        ///< without the background
  explicit LabelTable(const LabelVolume& volume);                   ///< of all of its labels but the background
  explicit LabelTable(const std::vector<LabelContours>& contours);  ///< of one label each

  /// Indices of the selected labels in what the table was made of (of a volume: without labels[0]), ascending.
  std::vector<std::size_t> resolve(const std::string& text, const std::string& option = "--label") const;
  /// The same, in the order in which the text names them: the priority of labels that overlap.
  std::vector<std::size_t> in_order(const std::string& text, const std::string& option = "--label") const;
  /// The numbers of the selected labels, in the order of the table.
  std::vector<Label> numbers(const std::string& text, const std::string& option = "--label") const;

  /// Values given for selections, such as "5=2.0,9=1.0", by label; a later one wins.
  template <class Value>
  std::map<Label, Value> values(const std::vector<std::pair<std::string, Value>>& texts,
                                const std::string& option) const {
    std::map<Label, Value> out;
    for (const auto& [text, value] : texts)
      for (const Label l : numbers(text, option)) out[l] = value;
    return out;
  }

 private:
  std::vector<LabelInfo> rows_;  // the background first
};

}  // namespace stackmesh
