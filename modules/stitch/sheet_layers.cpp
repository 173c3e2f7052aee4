#include "stitch/sheet_layers.h"

#include <algorithm>

namespace stackmesh {
namespace {

using Wishes = std::vector<std::pair<std::int32_t, std::int32_t>>;

void to_sets(Wishes& below, DisjointSets& same) {
  for (auto& b : below) b = {same.find(b.first), same.find(b.second)};
  below.erase(std::remove_if(below.begin(), below.end(), [](const auto& b) { return b.first == b.second; }), below.end());
  std::sort(below.begin(), below.end());
  below.erase(std::unique(below.begin(), below.end()), below.end());
}

/// The wishes left when all that nothing passes beneath, and all that passes beneath nothing, is taken away.
Wishes in_cycles(Wishes wishes, std::size_t sheets) {
  for (std::size_t before = wishes.size() + 1; wishes.size() < before;) {
    before = wishes.size();
    std::vector<char> has_lower(sheets, 0), has_higher(sheets, 0);
    for (const auto& w : wishes) has_higher[w.first] = has_lower[w.second] = 1;
    wishes.erase(std::remove_if(wishes.begin(), wishes.end(), [&](const auto& w) { return !has_lower[w.first] || !has_higher[w.second]; }), wishes.end());
  }
  return wishes;
}

}  // namespace

std::vector<int> sheet_layers(Wishes below, DisjointSets same) {
  std::vector<int> layers(same.size(), 0);
  if (below.empty()) return layers;
  to_sets(below, same);
  for (const auto& b : in_cycles(below, same.size())) same.join(b.first, b.second);
  to_sets(below, same);
  for (bool rising = true; rising;) {  // longest paths
    rising = false;
    for (const auto& b : below)
      if (layers[b.second] <= layers[b.first]) {
        layers[b.second] = layers[b.first] + 1;
        rising = true;
      }
  }
  for (std::size_t s = 0; s < layers.size(); ++s) layers[s] = layers[same.find(static_cast<std::int32_t>(s))];
  return layers;
}

}  // namespace stackmesh
