#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "model/geometry.h"

namespace stackmesh {

/// An axis-parallel box; floats, rounded outwards. The default is empty.
struct Box {
  float low[3] = {kInf, kInf, kInf}, high[3] = {-kInf, -kInf, -kInf};
  static constexpr float kInf = std::numeric_limits<float>::infinity();

  void add(const Vec3& p);
  void add(const Box& b) {
    for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], b.low[k]), high[k] = std::max(high[k], b.high[k]);
  }
  bool meets(const Box& b) const {
    return low[0] <= b.high[0] && b.low[0] <= high[0] && low[1] <= b.high[1] && b.low[1] <= high[1] &&
           low[2] <= b.high[2] && b.low[2] <= high[2];
  }
  /// Squared distance to p, 0 inside; infinite for an empty box.
  double distance2(const Vec3& p) const {
    const double x = std::max({0.0, low[0] - p.x, p.x - high[0]}), y = std::max({0.0, low[1] - p.y, p.y - high[1]}),
                 z = std::max({0.0, low[2] - p.z, p.z - high[2]});
    return x * x + y * y + z * z;
  }
};

/// A binary tree of boxes over items in Morton order; it serves boxes of any size and shape.
class BoxTree {
 public:
  explicit BoxTree(const std::vector<Box>& boxes);

  std::size_t leaves() const { return used_leaves_; }

  /// Calls visit(i, j) for the pairs of items with meeting boxes, i in the given leaf, j in it or a later
  /// one: over all leaves, each pair once.
  template <class Visit>
  void pairs_of_leaf(std::size_t leaf, Visit visit) const;

  /// Calls visit(item, &reach) for items whose box the ray from + t * along, 0 <= t <= reach, may meet; visit may
  /// shorten the reach. Boxes nearer along the ray come first, roughly.
  template <class Visit>
  void along_ray(const Vec3& from, const Vec3& along, double reach, Visit visit) const;

  /// The item nearest to p: distance2(item) must be no less than the squared distance to its box. `hint` is
  /// an item to try first (-1: none). Returns -1 when there is none.
  template <class Distance2>
  std::int32_t nearest(const Vec3& p, std::int32_t hint, Distance2 distance2, double* best2) const;

 private:
  static constexpr std::size_t kLeafItems = 4;
  std::size_t width_ = 1, used_leaves_ = 0;  // leaves of the full tree, leaves that hold items
  int depth_ = 0;
  std::vector<Box> nodes_;  // children of n: 2n and 2n + 1; root 1
  std::vector<Box> boxes_;  // of items, in order
  std::vector<std::int32_t> items_;
};

template <class Visit>
void BoxTree::pairs_of_leaf(std::size_t leaf, Visit visit) const {
  const std::size_t begin = leaf * kLeafItems, end = std::min(begin + kLeafItems, items_.size());
  for (std::size_t i = begin; i < end; ++i)
    for (std::size_t j = i + 1; j < end; ++j)
      if (boxes_[i].meets(boxes_[j])) visit(items_[i], items_[j]);
  const Box& own = nodes_[width_ + leaf];
  struct Entry {
    std::size_t node;
    int level;
  } stack[128];
  int top = 0;
  stack[top++] = {1, 0};
  while (top > 0) {
    const Entry e = stack[--top];
    const std::size_t last = ((e.node + 1) << (depth_ - e.level)) - 1 - width_;
    if (last <= leaf || !nodes_[e.node].meets(own)) continue;
    if (e.level < depth_) {
      stack[top++] = {2 * e.node + 1, e.level + 1};
      stack[top++] = {2 * e.node, e.level + 1};
      continue;
    }
    const std::size_t from = last * kLeafItems, to = std::min(from + kLeafItems, items_.size());
    for (std::size_t i = begin; i < end; ++i) {
      if (!boxes_[i].meets(nodes_[e.node])) continue;
      for (std::size_t j = from; j < to; ++j)
        if (boxes_[i].meets(boxes_[j])) visit(items_[i], items_[j]);
    }
  }
}

template <class Visit>
void BoxTree::along_ray(const Vec3& from, const Vec3& along, double reach, Visit visit) const {
  const double o[3] = {from.x, from.y, from.z}, d[3] = {along.x, along.y, along.z};
  const auto enters = [&](const Box& b) {  // where the ray comes in; NaN: not within reach
    if (b.low[0] > b.high[0]) return std::numeric_limits<double>::quiet_NaN();  // empty: a leaf without items
    double low = 0, high = reach;
    for (int k = 0; k < 3; ++k) {
      if (d[k] == 0) {
        if (o[k] < b.low[k] || o[k] > b.high[k]) return std::numeric_limits<double>::quiet_NaN();
        continue;
      }
      const double p = (b.low[k] - o[k]) / d[k], q = (b.high[k] - o[k]) / d[k];
      low = std::max(low, std::min(p, q)), high = std::min(high, std::max(p, q));
    }
    return low <= high ? low : std::numeric_limits<double>::quiet_NaN();
  };
  std::size_t stack[128];
  int top = 0;
  stack[top++] = 1;
  while (top > 0) {
    const std::size_t node = stack[--top];
    if (!(enters(nodes_[node]) <= reach)) continue;
    if (node >= width_) {
      const std::size_t first = (node - width_) * kLeafItems, last = std::min(first + kLeafItems, items_.size());
      for (std::size_t i = first; i < last; ++i)
        if (enters(boxes_[i]) <= reach) visit(items_[i], &reach);
      continue;
    }
    const double left = enters(nodes_[2 * node]), right = enters(nodes_[2 * node + 1]);
    const bool left_first = left <= right || right != right;
    stack[top++] = left_first ? 2 * node + 1 : 2 * node;
    stack[top++] = left_first ? 2 * node : 2 * node + 1;
  }
}

template <class Distance2>
std::int32_t BoxTree::nearest(const Vec3& p, std::int32_t hint, Distance2 distance2, double* best2) const {
  std::int32_t best = hint;
  double bound = hint >= 0 ? distance2(hint) : std::numeric_limits<double>::infinity();
  struct Entry {
    std::size_t node;
    double d2;
  } stack[128];
  int top = 0;
  stack[top++] = {1, nodes_[1].distance2(p)};
  while (top > 0) {
    const Entry e = stack[--top];
    if (!(e.d2 < bound)) continue;
    if (e.node >= width_) {
      const std::size_t from = (e.node - width_) * kLeafItems, to = std::min(from + kLeafItems, items_.size());
      for (std::size_t i = from; i < to; ++i) {
        if (!(boxes_[i].distance2(p) < bound)) continue;
        const double d2 = distance2(items_[i]);
        if (d2 < bound) bound = d2, best = items_[i];
      }
      continue;
    }
    Entry near = {2 * e.node, nodes_[2 * e.node].distance2(p)},
          far = {2 * e.node + 1, nodes_[2 * e.node + 1].distance2(p)};
    if (far.d2 < near.d2) std::swap(near, far);
    stack[top++] = far;
    stack[top++] = near;
  }
  *best2 = bound;
  return best;
}

}  // namespace stackmesh
