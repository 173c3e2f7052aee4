#include "stitch/sheet_layers.h"

#include <algorithm>

namespace stackmesh {
namespace {

using Orders = std::vector<std::pair<std::int32_t, std::int32_t>>;

void to_sets(Orders& below, DisjointSets& same) {
  for (auto& b : below) b = {same.find(b.first), same.find(b.second)};
  below.erase(std::remove_if(below.begin(), below.end(), [](const auto& b) { return b.first == b.second; }),
              below.end());
  std::sort(below.begin(), below.end());
  below.erase(std::unique(below.begin(), below.end()), below.end());
}

/// The orders left when all that nothing passes beneath, and all that passes beneath nothing, is taken away.
Orders in_cycles(Orders orders, std::size_t sheets) {
  for (std::size_t before = orders.size() + 1; orders.size() < before;) {
    before = orders.size();
    std::vector<char> has_lower(sheets, 0), has_higher(sheets, 0);
    for (const auto& w : orders) has_higher[w.first] = has_lower[w.second] = 1;
    orders.erase(std::remove_if(orders.begin(), orders.end(),
                                [&](const auto& w) { return !has_lower[w.first] || !has_higher[w.second]; }),
                 orders.end());
  }
  return orders;
}

}  // namespace

std::vector<int> sheet_layers(Orders below, DisjointSets same) {
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
