#include "run/layers.h"

#include "base/error.h"
#include "model/label_table.h"

namespace stackmesh {

std::map<Label, LayerSize> resolve_layers(const LayerTexts& texts, const std::vector<LabelInfo>& labels,
                                          const std::set<Label>& voids) {
  std::map<Label, LayerSize> out;
  for (const auto& [text, size] : texts)
    for (const Label label : LabelTable(labels).numbers(text, "--layer")) {
      if (voids.count(label) > 0)
        fail_usage("label " + std::to_string(label) + " is a void: it is not filled, so no layer grows in it",
                   "--layer", "name the label around it");
      if (!out.insert({label, size}).second)
        fail_usage("label " + std::to_string(label) + " has two layers", "--layer", "give it one");
    }
  return out;
}

}  // namespace stackmesh
