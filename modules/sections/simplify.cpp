#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "model/edge_grid.h"
#include "sections/arcs.h"

namespace stackmesh {
namespace {

constexpr double kSmallest_px = 0.02;   // below this tolerance every vertex is kept
constexpr double kSmallest_rel = 0.04;  // the same for free arcs, as a share of the tolerance requested

/// A chord that stands for the vertices [from, to] of an arc's chain.
struct Chord {
  std::int32_t arc, from, to;
  double tolerance_px;  // by which it was found
};

class ArcSimplifier {
 public:
  /// @param centres pixel centres keep their labels: vertices lie on pixel corners
  /// @param longest_px of a chord; 0: no limit
  ArcSimplifier(const std::vector<Arc>& arcs, double tolerance_px, bool centres, double longest_px)
      : arcs_(arcs), tolerance_(tolerance_px), centres_(centres), longest_(longest_px * kGridPerPixel) {}

  std::vector<std::vector<GridPoint>> run() {
    for (std::size_t a = 0; a < arcs_.size(); ++a) {
      const std::int32_t last = static_cast<std::int32_t>(arcs_[a].chain.size()) - 1;
      const std::int32_t arc = static_cast<std::int32_t>(a);
      // A loop is anchored at its start and at the vertex furthest from it; any arc at the vertices to keep.
      const bool loop = arcs_[a].chain.front().position == arcs_[a].chain.back().position;
      const std::int32_t far = loop ? furthest(arcs_[a].chain) : last;
      std::int32_t from = 0;
      for (std::int32_t i = 1; i <= last; ++i)
        if (i == last || i == far || arcs_[a].chain[i].keep) {
          add(arc, from, i, tolerance_, chords_);
          from = i;
        }
    }
    while (refine_crossings()) {
    }
    std::vector<std::vector<GridPoint>> out(arcs_.size());
    for (const Chord& c : chords_) {
      if (out[c.arc].empty()) out[c.arc].push_back(arcs_[c.arc].chain[c.from].position);
      out[c.arc].push_back(arcs_[c.arc].chain[c.to].position);
    }
    return out;
  }

 private:
  static std::int32_t furthest(const std::vector<CrackVertex>& chain) {
    std::int64_t best = -1;
    std::int32_t at = 0;
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const std::int64_t dx = chain[i].x - chain[0].x, dy = chain[i].y - chain[0].y;
      if (dx * dx + dy * dy > best) {
        best = dx * dx + dy * dy;
        at = static_cast<std::int32_t>(i);
      }
    }
    return at;
  }

  /// Appends the chords for chain[from..to]: approxPolyDP, then halved locally where a chord relabels a pixel
  /// centre.
  void add(std::int32_t arc, std::int32_t from, std::int32_t to, double tolerance, std::vector<Chord>& out) const {
    const std::vector<CrackVertex>& chain = arcs_[arc].chain;
    if (to - from == 1) {
      out.push_back({arc, from, to, tolerance});
      return;
    }
    if (tolerance < (centres_ ? kSmallest_px : kSmallest_rel * tolerance_)) {
      for (std::int32_t i = from; i < to; ++i) out.push_back({arc, i, i + 1, tolerance});
      return;
    }
    std::vector<cv::Point2f> curve, kept;
    curve.reserve(to - from + 1);
    for (std::int32_t i = from; i <= to; ++i)  // relative to the start: floats stay exact
      curve.emplace_back(static_cast<float>(chain[i].position.x - chain[from].position.x) / kGridPerPixel,
                         static_cast<float>(chain[i].position.y - chain[from].position.y) / kGridPerPixel);
    cv::approxPolyDP(curve, kept, tolerance, false);
    std::int32_t i = from;
    for (std::size_t k = 1; k < kept.size(); ++k) {
      std::int32_t j = i + 1;
      while (j < to && curve[j - from] != kept[k]) ++j;
      if (k + 1 == kept.size()) j = to;
      if (!centres_ || keeps_centres(chain, i, j)) add_pieces({arc, i, j, tolerance}, out);
      else add(arc, i, j, tolerance / 2, out);
      i = j;
      if (i == to) break;
    }
    if (i != to) add(arc, i, to, tolerance / 2, out);
  }

  /// A chord, halved at its chain's vertices until no piece is too long: between far vertices a strip of the stitched
  /// surface would hang on its ends alone.
  void add_pieces(const Chord& c, std::vector<Chord>& out) const {
    const std::vector<CrackVertex>& chain = arcs_[c.arc].chain;
    const GridPoint p = chain[c.from].position, q = chain[c.to].position;
    if (longest_ <= 0 || c.to - c.from == 1 || std::hypot(q.x - p.x, q.y - p.y) <= longest_) {
      out.push_back(c);
      return;
    }
    std::int32_t middle = c.from + 1;  // the vertex that is the most evenly between the ends
    double best = -1;
    for (std::int32_t i = c.from + 1; i < c.to; ++i) {
      const GridPoint m = chain[i].position;
      const double uneven = std::abs(std::hypot(m.x - p.x, m.y - p.y) - std::hypot(q.x - m.x, q.y - m.y));
      if (best < 0 || uneven < best) {
        best = uneven;
        middle = i;
      }
    }
    for (const Chord& half :
         {Chord{c.arc, c.from, middle, c.tolerance_px}, Chord{c.arc, middle, c.to, c.tolerance_px}}) {
      if (!centres_ || keeps_centres(chain, half.from, half.to)) add_pieces(half, out);
      else add(c.arc, half.from, half.to, c.tolerance_px / 2, out);
    }
  }

  /// Every row of pixel centres must see the chord between the same two centres as the cracks it replaces.
  static bool keeps_centres(const std::vector<CrackVertex>& chain, std::int32_t from, std::int32_t to) {
    if (to - from == 1) return true;
    const GridPoint p = chain[from].position, q = chain[to].position;
    const std::int64_t dx = static_cast<std::int64_t>(q.x) - p.x, dy = static_cast<std::int64_t>(q.y) - p.y;
    int direction = 0;
    for (std::int32_t i = from; i < to; ++i) {
      const int step = chain[i + 1].y - chain[i].y;
      if (step == 0) continue;
      if (direction != 0 && step != direction)
        return false;  // it would cross a row of centres more often than the chord
      direction = step;
      const std::int64_t row =
          static_cast<std::int64_t>(std::min(chain[i].y, chain[i + 1].y)) * kGridPerPixel + kGridPerPixel / 2;
      if ((row - p.y) * (dy > 0 ? 1 : -1) <= 0 || (q.y - row) * (dy > 0 ? 1 : -1) <= 0) return false;
      const std::int64_t off = (row - p.y) * dx - (static_cast<std::int64_t>(chain[i].x) * kGridPerPixel - p.x) * dy;
      if (std::abs(off) >= kGridPerPixel / 2 * std::abs(dy)) return false;
    }
    return true;
  }

  GridSegment segment(const Chord& c) const {
    return {arcs_[c.arc].chain[c.from].position, arcs_[c.arc].chain[c.to].position};
  }

  /// Halves the tolerance of chords that clash; false when none does.
  bool refine_crossings() {
    std::vector<GridSegment> segments;
    segments.reserve(chords_.size());
    for (const Chord& c : chords_) segments.push_back(segment(c));
    const EdgeGrid grid(segments);
    std::vector<char> bad(chords_.size(), 0);
    bool any = false;
    for (std::size_t i = 0; i < chords_.size(); ++i)
      grid.near_segment(segments[i], [&](std::int32_t k) {
        if (static_cast<std::size_t>(k) >= i || (bad[i] && bad[k]) || !clash(segments[i], segments[k])) return;
        for (std::size_t c : {i, static_cast<std::size_t>(k)})
          if (chords_[c].to - chords_[c].from > 1) bad[c] = any = true;
      });
    if (!any) return false;
    std::vector<Chord> next;
    next.reserve(chords_.size() + 16);
    for (std::size_t i = 0; i < chords_.size(); ++i) {
      const Chord& c = chords_[i];
      if (bad[i]) add(c.arc, c.from, c.to, c.tolerance_px / 2, next);
      else next.push_back(c);
    }
    chords_.swap(next);
    return true;
  }

  const std::vector<Arc>& arcs_;
  const double tolerance_;
  const bool centres_;
  const double longest_;  // in grid units
  std::vector<Chord> chords_;
};

std::vector<std::vector<GridPoint>> all_vertices(const std::vector<Arc>& arcs) {
  std::vector<std::vector<GridPoint>> out(arcs.size());
  for (std::size_t a = 0; a < arcs.size(); ++a)
    for (const CrackVertex& v : arcs[a].chain) out[a].push_back(v.position);
  return out;
}

}  // namespace

std::vector<std::vector<GridPoint>> simplify_arcs(const std::vector<Arc>& arcs, double tolerance_px,
                                                  double longest_px) {
  if (tolerance_px > 0) return ArcSimplifier(arcs, tolerance_px, true, longest_px).run();
  return all_vertices(arcs);
}

std::vector<std::vector<GridPoint>> simplify_free_arcs(const std::vector<Arc>& arcs, double tolerance,
                                                       double longest_px) {
  if (tolerance > 0) return ArcSimplifier(arcs, tolerance / kGridPerPixel, false, longest_px).run();
  return all_vertices(arcs);
}

}  // namespace stackmesh
