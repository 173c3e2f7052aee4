#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace stackmesh {

/// Distance in the plane from points to the nearest of a set of segments. Few segments are tried one by one;
/// many are kept in a uniform grid that is searched in growing rings.
class SegmentDistance {
 public:
  struct Segment {
    double ax, ay, bx, by;
  };
  void add(const Segment& s) { segments_.push_back(s); }
  bool empty() const { return segments_.empty(); }

  double operator()(double x, double y) {
    if (segments_.size() <= 16) {
      double best = std::numeric_limits<double>::infinity();
      for (const Segment& s : segments_) best = std::min(best, squared(s, x, y));
      return std::sqrt(best);
    }
    if (start_.empty()) build();
    return search(x, y);
  }

 private:
  static double squared(const Segment& s, double x, double y) {
    const double dx = s.bx - s.ax, dy = s.by - s.ay, px = x - s.ax, py = y - s.ay;
    const double length = dx * dx + dy * dy;
    const double t = length > 0 ? std::clamp((px * dx + py * dy) / length, 0.0, 1.0) : 0.0;
    const double ex = px - t * dx, ey = py - t * dy;
    return ex * ex + ey * ey;
  }
  int cell_x(double x) const { return std::clamp(static_cast<int>((x - x0_) / cell_), 0, nx_ - 1); }
  int cell_y(double y) const { return std::clamp(static_cast<int>((y - y0_) / cell_), 0, ny_ - 1); }

  template <class Visit>
  void for_each_cell(const Segment& s, Visit visit) const {
    const int x0 = cell_x(std::min(s.ax, s.bx)), x1 = cell_x(std::max(s.ax, s.bx));
    const int y0 = cell_y(std::min(s.ay, s.by)), y1 = cell_y(std::max(s.ay, s.by));
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) visit(y * nx_ + x);
  }

  void build() {
    double x1 = segments_[0].ax, y1 = segments_[0].ay, length = 0;
    x0_ = x1;
    y0_ = y1;
    for (const Segment& s : segments_) {
      x0_ = std::min({x0_, s.ax, s.bx});
      y0_ = std::min({y0_, s.ay, s.by});
      x1 = std::max({x1, s.ax, s.bx});
      y1 = std::max({y1, s.ay, s.by});
      length += std::max(std::abs(s.ax - s.bx), std::abs(s.ay - s.by));
    }
    const double n = static_cast<double>(segments_.size());
    cell_ = std::max({2 * length / n, std::max(x1 - x0_, y1 - y0_) / std::sqrt(8 * n), 1e-300});
    nx_ = static_cast<int>((x1 - x0_) / cell_) + 1;
    ny_ = static_cast<int>((y1 - y0_) / cell_) + 1;
    start_.assign(static_cast<std::size_t>(nx_) * ny_ + 1, 0);
    for (const Segment& s : segments_) for_each_cell(s, [&](int c) { ++start_[c + 1]; });
    for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    items_.resize(start_.back());
    std::vector<std::int32_t> next(start_.begin(), start_.end() - 1);
    for (std::size_t i = 0; i < segments_.size(); ++i)
      for_each_cell(segments_[i], [&](int c) { items_[next[c]++] = static_cast<std::int32_t>(i); });
  }

  double search(double x, double y) const {
    const int cx = cell_x(x), cy = cell_y(y);
    double best = std::numeric_limits<double>::infinity();
    for (int ring = 0; ring < std::max(nx_, ny_); ++ring) {
      for (int v = cy - ring; v <= cy + ring; ++v) {
        if (v < 0 || v >= ny_) continue;
        const int step = v == cy - ring || v == cy + ring ? 1 : std::max(1, 2 * ring);
        for (int u = cx - ring; u <= cx + ring; u += step) {
          if (u < 0 || u >= nx_) continue;
          const std::size_t c = static_cast<std::size_t>(v) * nx_ + u;
          for (std::int32_t k = start_[c]; k < start_[c + 1]; ++k)
            best = std::min(best, squared(segments_[items_[k]], x, y));
        }
      }
      // Whatever lies in further rings is at least this far from a point inside the grid.
      const double reach = std::min({x - (x0_ + (cx - ring) * cell_), x0_ + (cx + ring + 1) * cell_ - x,
                                     y - (y0_ + (cy - ring) * cell_), y0_ + (cy + ring + 1) * cell_ - y});
      if (reach > 0 && best <= reach * reach) break;
    }
    return std::sqrt(best);
  }

  std::vector<Segment> segments_;
  std::vector<std::int32_t> start_, items_;
  double x0_ = 0, y0_ = 0, cell_ = 1;
  int nx_ = 1, ny_ = 1;
};

}  // namespace stackmesh
