#pragma once
#include <algorithm>
#include <vector>

#include "model/label_volume.h"

namespace stackmesh {

/// The labels of a page, ascending; the pictures name each by its place here, 0 being the background.
class LabelIndex {
 public:
  explicit LabelIndex(std::vector<LabelInfo> labels) : labels_(std::move(labels)) {}
  const std::vector<LabelInfo>& labels() const { return labels_; }
  std::int32_t operator()(Label number) const {
    const auto it = std::lower_bound(labels_.begin(), labels_.end(), number,
                                     [](const LabelInfo& l, Label n) { return l.number < n; });
    return static_cast<std::int32_t>(it - labels_.begin());
  }

 private:
  std::vector<LabelInfo> labels_;
};

}  // namespace stackmesh
