#include "validate/box_tree.h"

#include <cmath>
#include <utility>

namespace stackmesh {
namespace {

float round_down(double v) {
  const float f = static_cast<float>(v);
  return f > v ? std::nextafter(f, -Box::kInf) : f;
}

float round_up(double v) {
  const float f = static_cast<float>(v);
  return f < v ? std::nextafter(f, Box::kInf) : f;
}

/// Spreads the low 21 bits of v to every third bit.
std::uint64_t spread(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffff;
  v = (v | v << 16) & 0x1f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  return (v | v << 2) & 0x1249249249249249;
}

}  // namespace

void Box::add(const Vec3& p) {
  const double v[3] = {p.x, p.y, p.z};
  for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], round_down(v[k])), high[k] = std::max(high[k], round_up(v[k]));
}

BoxTree::BoxTree(const std::vector<Box>& boxes) {
  Box all;
  for (const Box& b : boxes) all.add(b);
  double extent = 0;
  for (int k = 0; k < 3; ++k) extent = std::max(extent, static_cast<double>(all.high[k]) - all.low[k]);
  const double scale = extent > 0 ? 2097151.0 / extent : 0;
  std::vector<std::pair<std::uint64_t, std::int32_t>> order(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    std::uint64_t code = 0;
    for (int k = 0; k < 3; ++k) {
      const double middle = 0.5 * (static_cast<double>(boxes[i].low[k]) + boxes[i].high[k]) - all.low[k];
      code |= spread(static_cast<std::uint64_t>(std::clamp(middle * scale, 0.0, 2097151.0))) << k;
    }
    order[i] = {code, static_cast<std::int32_t>(i)};
  }
  std::sort(order.begin(), order.end());
  items_.reserve(boxes.size());
  boxes_.reserve(boxes.size());
  for (const auto& o : order) {
    items_.push_back(o.second);
    boxes_.push_back(boxes[o.second]);
  }
  used_leaves_ = (items_.size() + kLeafItems - 1) / kLeafItems;
  while (width_ < used_leaves_) width_ *= 2, ++depth_;
  nodes_.resize(2 * width_);
  for (std::size_t i = 0; i < boxes_.size(); ++i) nodes_[width_ + i / kLeafItems].add(boxes_[i]);
  for (std::size_t n = width_; n-- > 1;) {
    nodes_[n] = nodes_[2 * n];
    nodes_[n].add(nodes_[2 * n + 1]);
  }
}

}  // namespace stackmesh
