#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "model/stack.h"

namespace stackmesh {

/// A straight segment between grid points.
struct GridSegment {
  GridPoint a;  ///< where it begins
  GridPoint b;  ///< where it ends
};

/// Finds the segments near a grid point or another segment: a uniform grid of square cells, each with the
/// segments whose one-unit neighbourhood meets it.
class EdgeGrid {
 public:
  /// Keeps indices of `segments`, not the segments.
  explicit EdgeGrid(const std::vector<GridSegment>& segments);

  /// Calls visit(segment index) for a superset of the segments that pass within one unit of p.
  template <class Visit>
  void near_point(GridPoint p, Visit visit) const {
    const std::int64_t cx = (p.x - x0_) >> shift_, cy = (p.y - y0_) >> shift_;
    if (p.x < x0_ || p.y < y0_ || cx >= nx_ || cy >= ny_) return;
    const std::size_t cell = static_cast<std::size_t>(cy * nx_ + cx);
    for (std::int32_t k = start_[cell]; k < start_[cell + 1]; ++k) visit(items_[k]);
  }

  /// Calls visit(segment index) for a superset of the segments that meet s; one may be visited repeatedly.
  template <class Visit>
  void near_segment(const GridSegment& s, Visit visit) const {
    for_each_cell(s, [&](std::size_t cell) {
      for (std::int32_t k = start_[cell]; k < start_[cell + 1]; ++k) visit(items_[k]);
    });
  }

  /// Calls visit(segment index) for a superset of the segments that meet the box; one may be visited repeatedly.
  template <class Visit>
  void near_box(GridPoint low, GridPoint high, Visit visit) const {
    const auto cell = [&](std::int64_t v, std::int64_t origin, std::int64_t n) {
      return std::clamp<std::int64_t>((v - origin) >> shift_, 0, n - 1);
    };
    for (std::int64_t cy = cell(low.y, y0_, ny_); cy <= cell(high.y, y0_, ny_); ++cy)
      for (std::int64_t cx = cell(low.x, x0_, nx_); cx <= cell(high.x, x0_, nx_); ++cx)
        for (std::int32_t k = start_[cy * nx_ + cx]; k < start_[cy * nx_ + cx + 1]; ++k) visit(items_[k]);
  }

 private:
  /// Cells that the one-unit neighbourhood of s meets (clipped to the grid).
  template <class Visit>
  void for_each_cell(const GridSegment& s, Visit visit) const;

  std::int64_t x0_ = 0, y0_ = 0, nx_ = 1, ny_ = 1;
  int shift_ = 0;
  std::vector<std::int32_t> start_, items_;
};

template <class Visit>
void EdgeGrid::for_each_cell(const GridSegment& s, Visit visit) const {
  const auto clamp = [](std::int64_t v, std::int64_t n) { return v < 0 ? 0 : v >= n ? n - 1 : v; };
  const std::int64_t lox = std::min(s.a.x, s.b.x), hix = std::max(s.a.x, s.b.x);
  const std::int64_t loy = std::min(s.a.y, s.b.y), hiy = std::max(s.a.y, s.b.y);
  const std::int64_t last_x = x0_ + (nx_ << shift_), last_y = y0_ + (ny_ << shift_);
  if (hix + 1 < x0_ || hiy + 1 < y0_ || lox - 1 >= last_x || loy - 1 >= last_y) return;
  const std::int64_t cx0 = clamp((lox - 1 - x0_) >> shift_, nx_), cx1 = clamp((hix + 1 - x0_) >> shift_, nx_);
  const std::int64_t cy0 = clamp((loy - 1 - y0_) >> shift_, ny_), cy1 = clamp((hiy + 1 - y0_) >> shift_, ny_);
  const bool steep_box = (cx1 - cx0 + 1) * (cy1 - cy0 + 1) > 4;
  for (std::int64_t cy = cy0; cy <= cy1; ++cy) {
    std::int64_t from = cx0, to = cx1;
    if (steep_box && s.a.y != s.b.y) {  // the piece of the segment within this row of cells, one unit wider
      const double slope = (static_cast<double>(s.b.x) - s.a.x) / (static_cast<double>(s.b.y) - s.a.y);
      const double y_low = std::max<double>(loy, static_cast<double>(y0_ + (cy << shift_)) - 1);
      const double y_high = std::min<double>(hiy, static_cast<double>(y0_ + ((cy + 1) << shift_)) + 1);
      const double xa = s.a.x + (y_low - s.a.y) * slope, xb = s.a.x + (y_high - s.a.y) * slope;
      from = std::max(cx0, clamp((static_cast<std::int64_t>(std::min(xa, xb)) - 3 - x0_) >> shift_, nx_));
      to = std::min(cx1, clamp((static_cast<std::int64_t>(std::max(xa, xb)) + 3 - x0_) >> shift_, nx_));
    }
    for (std::int64_t cx = from; cx <= to; ++cx) visit(static_cast<std::size_t>(cy * nx_ + cx));
  }
}

/// Twice the signed area of (a, b, c); exact for |coordinates| <= 2^29.
inline std::int64_t orientation(GridPoint a, GridPoint b, GridPoint c) {
  return (static_cast<std::int64_t>(b.x) - a.x) * (static_cast<std::int64_t>(c.y) - a.y) -
         (static_cast<std::int64_t>(b.y) - a.y) * (static_cast<std::int64_t>(c.x) - a.x);
}

/// Does p lie on the closed segment? Exact.
inline bool on_segment(const GridSegment& s, GridPoint p) {
  return orientation(s.a, s.b, p) == 0 && p.x >= std::min(s.a.x, s.b.x) && p.x <= std::max(s.a.x, s.b.x) &&
         p.y >= std::min(s.a.y, s.b.y) && p.y <= std::max(s.a.y, s.b.y);
}

/// True when the interiors of the segments cross in one point; touching and overlapping do not count.
inline bool properly_cross(const GridSegment& s, const GridSegment& t) {
  if (std::max(s.a.x, s.b.x) <= std::min(t.a.x, t.b.x) || std::max(t.a.x, t.b.x) <= std::min(s.a.x, s.b.x) ||
      std::max(s.a.y, s.b.y) <= std::min(t.a.y, t.b.y) || std::max(t.a.y, t.b.y) <= std::min(s.a.y, s.b.y)) {
    // Boxes that meet in a line at most can hold a proper crossing only if one of them is itself a line.
    const bool thin = s.a.x == s.b.x || s.a.y == s.b.y || t.a.x == t.b.x || t.a.y == t.b.y;
    if (!thin) return false;
  }
  const std::int64_t a = orientation(t.a, t.b, s.a), b = orientation(t.a, t.b, s.b);
  if (a == 0 || b == 0 || (a > 0) == (b > 0)) return false;
  const std::int64_t c = orientation(s.a, s.b, t.a), d = orientation(s.a, s.b, t.b);
  return c != 0 && d != 0 && (c > 0) != (d > 0);
}

/// Do the segments meet elsewhere than in common end points?
inline bool clash(const GridSegment& s, const GridSegment& t) {
  if (properly_cross(s, t)) return true;
  for (GridPoint p : {t.a, t.b})
    if (p != s.a && p != s.b && on_segment(s, p)) return true;
  for (GridPoint p : {s.a, s.b})
    if (p != t.a && p != t.b && on_segment(t, p)) return true;
  return (s.a == t.a && s.b == t.b) || (s.a == t.b && s.b == t.a);
}

}  // namespace stackmesh
