#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "model/geometry.h"

namespace stackmesh::volume {

/// Boxes in a regular grid of cells about as large as they are; asked for those whose cells a box touches.
class BoxGrid {
 public:
  struct Box {
    Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    void add(const Vec3& p) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    void widen(double by) { low = low - Vec3{by, by, by}, high = high + Vec3{by, by, by}; }
    bool meets(const Box& o) const {
      return low.x <= o.high.x && o.low.x <= high.x && low.y <= o.high.y && o.low.y <= high.y && low.z <= o.high.z &&
             o.low.z <= high.z;
    }
  };

  explicit BoxGrid(std::vector<Box> boxes) : boxes_(std::move(boxes)) {
    if (boxes_.empty()) return;
    double mean = 0;
    for (const Box& b : boxes_) all_.add(b.low), all_.add(b.high), mean += norm(b.high - b.low);
    const Vec3 extent = all_.high - all_.low;
    const double longest = std::max({extent.x, extent.y, extent.z, 1e-30});
    cell_ = std::max(mean / static_cast<double>(boxes_.size()), longest / 128);
    const double extents[3] = {extent.x, extent.y, extent.z};
    for (int d = 0; d < 3; ++d) size_[d] = static_cast<int>(extents[d] / cell_) + 1;
    begin_.assign(static_cast<std::size_t>(size_[0]) * size_[1] * size_[2] + 1, 0);
    for (const Box& b : boxes_) each_cell(b, [&](std::size_t c) { ++begin_[c + 1]; });
    for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
    items_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < boxes_.size(); ++i)
      each_cell(boxes_[i], [&](std::size_t c) { items_[next[c]++] = static_cast<std::int32_t>(i); });
  }

  /// The boxes that meet a box, each once, ascending.
  void near(const Box& box, std::vector<std::int32_t>& out) const {
    out.clear();
    if (boxes_.empty() || !box.meets(all_)) return;
    each_cell(box, [&](std::size_t c) {
      for (std::size_t i = begin_[c]; i < begin_[c + 1]; ++i)
        if (boxes_[items_[i]].meets(box)) out.push_back(items_[i]);
    });
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
  }

 private:
  template <class Visit>
  void each_cell(const Box& b, Visit visit) const {
    const auto range = [&](double low, double high, double from, int size, int& first, int& last) {
      first = std::clamp(static_cast<int>((low - from) / cell_), 0, size - 1);
      last = std::clamp(static_cast<int>((high - from) / cell_), 0, size - 1);
    };
    int x0, x1, y0, y1, z0, z1;
    range(std::max(b.low.x, all_.low.x), std::min(b.high.x, all_.high.x), all_.low.x, size_[0], x0, x1);
    range(std::max(b.low.y, all_.low.y), std::min(b.high.y, all_.high.y), all_.low.y, size_[1], y0, y1);
    range(std::max(b.low.z, all_.low.z), std::min(b.high.z, all_.high.z), all_.low.z, size_[2], z0, z1);
    for (int z = z0; z <= z1; ++z)
      for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) visit((static_cast<std::size_t>(z) * size_[1] + y) * size_[0] + x);
  }

  std::vector<Box> boxes_;
  Box all_;
  double cell_ = 1;
  std::array<int, 3> size_ = {1, 1, 1};
  std::vector<std::size_t> begin_;
  std::vector<std::int32_t> items_;
};

}  // namespace stackmesh::volume
