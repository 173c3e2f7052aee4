#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "base/error.h"
#include "model/corner_rule.h"
#include "model/slices.h"
#include "sections/arcs.h"
#include "sections/components.h"

namespace stackmesh {
namespace {

struct Box {
  int x0 = 1 << 30, y0 = 1 << 30, x1 = -1, y1 = -1;
  void add(int x, int y) {
    x0 = std::min(x0, x);
    y0 = std::min(y0, y);
    x1 = std::max(x1, x);
    y1 = std::max(y1, y);
  }
};

constexpr std::int32_t kQuarter = kGridPerPixel / 4;

// Steps along the cracks: +x, +y, -x, -y.
constexpr std::array<int, 4> kStepX = {1, 0, -1, 0}, kStepY = {0, 1, 0, -1};

class SliceTracer {
 public:
  SliceTracer(const Slice& slice, const CornerRules& rules) : slice_(slice), rules_(rules) {}

  SliceArcs run() {
    find_labels();
    if (labels_.empty()) return {};
    width_ = all_.x1 - all_.x0 + 2;  // corners in x
    height_ = all_.y1 - all_.y0 + 2;
    cracks_.assign(static_cast<std::size_t>(width_) * (height_ + 1) + 8, 0);  // a row of none comes first
    for (const auto& [label, extent] : labels_) trace_label(label, extent.box);
    link();
    for (const auto& [label, extent] : labels_)
      if (extent.twice_area != 2 * extent.pixels) fail_internal("contours do not enclose a label's pixels", "contours");
    return std::move(out_);
  }

 private:
  struct Extent {
    Box box;
    std::int64_t pixels = 0, twice_area = 0;  // counted in the image; enclosed by the arcs
  };

  void find_labels() {
    Extent* extent = nullptr;
    std::uint16_t of = 0;
    for (int y = 0; y < slice_.height; ++y) {
      const std::uint16_t* row = &slice_.pixels[static_cast<std::size_t>(y) * slice_.width];
      for (int x = 0, end; x < slice_.width; x = end) {
        end = run_end(row, x, slice_.width);
        const std::uint16_t label = row[x];
        if (label == 0) continue;
        if (label != of) extent = &labels_[of = label];
        extent->box.add(x, y);
        extent->box.add(end - 1, y);
        extent->pixels += end - x;
      }
    }
    for (const auto& [label, found] : labels_) {
      all_.add(found.box.x0, found.box.y0);
      all_.add(found.box.x1, found.box.y1);
    }
  }

  std::size_t corner(int x, int y) const { return static_cast<std::size_t>(y - all_.y0 + 1) * width_ + (x - all_.x0); }

  /// findContours on the mask doubled in size: each border sub-pixel (2x + a, 2y + b) stands for corner
  /// (x + a, y + b) of its own pixel, so the border is the crack contour, exactly.
  void trace_label(std::uint16_t label, const Box& box) {
    const int w = box.x1 - box.x0 + 1, h = box.y1 - box.y0 + 1;
    cv::Mat mask(2 * h + 2, 2 * w + 2, CV_8U, cv::Scalar(0));
    for (int y = 0; y < h; ++y) {
      std::uint8_t* upper = mask.ptr(2 * y + 1) + 1;
      const std::uint16_t* row = &slice_.pixels[static_cast<std::size_t>(y + box.y0) * slice_.width + box.x0];
      for (int x = 0; x < w; ++x)
        if (row[x] == label) upper[2 * x] = upper[2 * x + 1] = 255;
      std::copy(upper - 1, upper + 2 * w + 1, mask.ptr(2 * y + 2));
    }
    std::vector<std::vector<cv::Point>> borders;
    cv::findContours(mask, borders, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
    out_.loops += borders.size();
    for (const auto& border : borders) {
      const auto lattice = [&](const cv::Point& p) {
        const int sx = p.x - 1, sy = p.y - 1;
        return cv::Point(box.x0 + (sx >> 1) + (sx & 1), box.y0 + (sy >> 1) + (sy & 1));
      };
      cv::Point last = lattice(border.back());
      for (const cv::Point& p : border) {
        const cv::Point next = lattice(p);
        if (next == last) continue;
        if (next.y == last.y && std::abs(next.x - last.x) == 1)
          cracks_[corner(std::min(last.x, next.x), next.y)] |= kEast;
        else if (next.x == last.x && std::abs(next.y - last.y) == 1)
          cracks_[corner(next.x, std::min(last.y, next.y))] |= kNorth;
        else fail_internal("a traced border leaves the pixel cracks", "contours");
        last = next;
      }
    }
  }

  // A corner's byte: the cracks to its east and north, and whether an arc has them.
  static constexpr std::uint8_t kEast = 1, kNorth = 2, kUsed = 2 /* shift */;
  struct Crack {
    std::uint8_t& byte;
    std::uint8_t bit;
    bool exists() const { return (byte & bit) != 0; }
    bool used() const { return (byte & (bit << kUsed)) != 0; }
    void use() { byte = static_cast<std::uint8_t>(byte | (bit << kUsed)); }
  };
  Crack crack(int x, int y, int dir) {
    const std::size_t at = corner(x, y);
    switch (dir) {
      case 0:
        return {cracks_[at], kEast};
      case 1:
        return {cracks_[at], kNorth};
      case 2:
        return {cracks_[at - 1], kEast};
      default:
        return {cracks_[at - width_], kNorth};
    }
  }
  int degree(int x, int y) const {
    const std::size_t at = corner(x, y);
    return (cracks_[at] & 1) + ((cracks_[at] >> 1) & 1) + (cracks_[at - 1] & 1) + ((cracks_[at - width_] >> 1) & 1);
  }

  enum class Corner { pass, junction, join_rising, join_falling };  // rising: the pixels SW and NE are joined

  Corner classify(int x, int y) const {
    const int cracks = degree(x, y);
    if (cracks <= 2) return Corner::pass;
    if (cracks == 3) return Corner::junction;
    const std::uint16_t sw = slice_.at(x - 1, y - 1), se = slice_.at(x, y - 1);
    const std::uint16_t nw = slice_.at(x - 1, y), ne = slice_.at(x, y);
    switch (joined_diagonal(sw, se, nw, ne, [&](int falling) {
      return falling ? rules_.same_component(x - 1, y, x, y - 1) : rules_.same_component(x - 1, y - 1, x, y);
    })) {
      case JoinedDiagonal::rising:
        return Corner::join_rising;
      case JoinedDiagonal::falling:
        return Corner::join_falling;
      case JoinedDiagonal::none:
        break;
    }
    return Corner::junction;
  }

  /// Follows cracks from corner (x, y) in direction dir until a junction, or back to the first crack.
  void walk(int x, int y, int dir, bool closed) {
    Arc arc;
    arc.closed = closed;
    const std::uint16_t sw = slice_.at(x - 1, y - 1), se = slice_.at(x, y - 1), nw = slice_.at(x - 1, y),
                        ne = slice_.at(x, y);
    arc.left = dir == 0 ? ne : dir == 1 ? nw : dir == 2 ? sw : se;
    arc.right = dir == 0 ? se : dir == 1 ? ne : dir == 2 ? nw : sw;
    arc.chain.push_back(closed ? vertex(x, y) : end_vertex(x, y, dir));
    const int first_x = x, first_y = y, first_dir = dir;
    std::int64_t twice_area = 0;
    while (true) {
      Crack c = crack(x, y, dir);
      if (!c.exists() || c.used()) fail_internal("a pixel crack was traced by no border, or twice", "contours");
      c.use();
      twice_area += static_cast<std::int64_t>(x) * kStepY[dir] - static_cast<std::int64_t>(y) * kStepX[dir];
      x += kStepX[dir];
      y += kStepY[dir];
      const Corner kind = classify(x, y);
      arc.chain.push_back(kind == Corner::junction ? end_vertex(x, y, (dir + 2) & 3) : vertex(x, y));
      if (kind == Corner::junction) break;
      const int next = turn(x, y, dir, kind);
      if (rules_.part && kind != Corner::pass && (!arc.chain.back().keep || joined_label(x, y, kind) == 0))
        draw_apart(arc.chain.back(), dir, next);
      dir = next;
      if (closed && x == first_x && y == first_y && dir == first_dir) {
        arc.chain.front() = arc.chain.back();
        break;
      }
    }
    if (arc.left != 0) labels_[arc.left].twice_area += twice_area;
    if (arc.right != 0) labels_[arc.right].twice_area -= twice_area;
    out_.arcs.push_back(std::move(arc));
  }

  std::uint16_t joined_label(int x, int y, Corner kind) const {
    return kind == Corner::join_rising ? slice_.at(x, y) : slice_.at(x - 1, y);
  }

  /// The direction in which the contour goes on.
  int turn(int x, int y, int dir, Corner kind) {
    if (kind == Corner::pass) {
      for (int d : {dir, (dir + 1) & 3, (dir + 3) & 3})
        if (crack(x, y, d).exists()) return d;
      fail_internal("a contour ends in the open", "contours");
    }
    // Joined rising (SW-NE): contours round NW and SE, so cracks pair as (north, west) and (south, east).
    // An arrival by direction d comes through the crack opposite d.
    static constexpr std::array<int, 4> rising = {1, 0, 3, 2};   // east-bound comes from the west crack: goes north
    static constexpr std::array<int, 4> falling = {3, 2, 1, 0};  // ... goes south
    return kind == Corner::join_rising ? rising[dir] : falling[dir];
  }

  /// Draws a corner that two contours pass on the side of the pixel that this contour turns about, so that the joined
  /// label grows there: not where it would meet another of its components in the next slice.
  void draw_apart(CrackVertex& v, int arrived, int leaves) const {
    // The pixel lies between the crack it came by (opposite `arrived`) and the crack it leaves by.
    const int to_x = kStepX[leaves] - kStepX[arrived], to_y = kStepY[leaves] - kStepY[arrived];
    v.home = {v.x * kGridPerPixel + kQuarter * to_x, v.y * kGridPerPixel + kQuarter * to_y};
    if (const FairedLabels::Corner* c =
            v.keep ? nullptr : faired(v.x, v.y, to_y < 0 ? FairedLabels::Corner::south : FairedLabels::Corner::north)) {
      v.position = displaced(*c);
    } else {
      v.position = v.home;
    }
  }

  const FairedLabels::Corner* faired(int x, int y, FairedLabels::Corner::Part part) const {
    if (rules_.faired == nullptr) return nullptr;
    const auto it = std::lower_bound(
        rules_.faired->begin(), rules_.faired->end(), std::make_tuple(y, x, part),
        [](const FairedLabels::Corner& c, const auto& key) { return std::make_tuple(c.y, c.x, c.part) < key; });
    return it != rules_.faired->end() && it->x == x && it->y == y && it->part == part ? &*it : nullptr;
  }

  GridPoint displaced(const FairedLabels::Corner& c) const {
    // even at junctions: an edge between two of them has its middle on the grid
    const int unit = degree(c.x, c.y) > 2 ? 2 : 1;
    const auto units = [&](float d) {
      constexpr float most = 0.498F;
      return unit * static_cast<std::int32_t>(
                        std::lround((rules_.hold ? std::clamp(d, -most, most) : d) * (kGridPerPixel / unit)));
    };
    return {c.x * kGridPerPixel + units(c.dx), c.y * kGridPerPixel + units(c.dy)};
  }

  CrackVertex vertex(int x, int y) const {
    GridPoint home = {x * kGridPerPixel, y * kGridPerPixel};
    if (const unsigned quadrants = touching(x, y); quadrants != 0) {
      int to_x = 0, to_y = 0;  // into the pixels that touch; not where a label that touches would grow
      std::uint16_t label = 0;
      bool one = true;
      for (int q = 0; q < 4; ++q)
        if (quadrants >> q & 1) {
          const std::uint16_t at = slice_.at(x - 1 + q % 2, y - 1 + q / 2);
          one = one && (label == 0 || label == at);
          label = at;
          to_x += q & 1 ? 1 : -1, to_y += q & 2 ? 1 : -1;
        }
      if (one) home = {home.x + kQuarter * std::clamp(to_x, -1, 1), home.y + kQuarter * std::clamp(to_y, -1, 1)};
      return {x, y, home, true, home};
    }
    const FairedLabels::Corner* c = faired(x, y, FairedLabels::Corner::whole);
    return {x, y, c != nullptr ? displaced(*c) : home, false, home};
  }

  /// The quadrants of a corner that touch another component of their label (TouchingCorner).
  unsigned touching(int x, int y) const {
    if (rules_.keep.empty()) return 0;
    const TouchingCorner asked{corner_key(x, y), 0};
    const auto at = std::lower_bound(rules_.keep.begin(), rules_.keep.end(), asked);
    return at != rules_.keep.end() && at->key == asked.key ? at->quadrants : 0;
  }

  /// Which diagonal of a junction is of one label that touches itself there, while the two other labels differ.
  JoinedDiagonal parted_diagonal(int x, int y) const {
    if (!rules_.part || degree(x, y) != 4) return JoinedDiagonal::none;
    const bool rising = slice_.at(x - 1, y - 1) == slice_.at(x, y),
               falling = slice_.at(x - 1, y) == slice_.at(x, y - 1);
    if (rising == falling) return JoinedDiagonal::none;
    if ((touching(x, y) & (rising ? 2 | 4 : 1 | 8)) != 0) return JoinedDiagonal::none;  // the two others grow
    return rising ? JoinedDiagonal::rising : JoinedDiagonal::falling;
  }

  /// The vertex at which an arc ends whose crack leads from a junction in direction dir. A label that touches itself
  /// there is parted: a junction on either side of the corner.
  CrackVertex end_vertex(int x, int y, int dir) const {
    CrackVertex v = vertex(x, y);
    const JoinedDiagonal parted = parted_diagonal(x, y);
    if (parted == JoinedDiagonal::none) return v;
    const bool rising = parted == JoinedDiagonal::rising, high = dir == 0 || dir == (rising ? 1 : 3);
    const GridPoint off = {high ? kQuarter : -kQuarter, high == rising ? kQuarter : -kQuarter},
                    corner = {x * kGridPerPixel, y * kGridPerPixel};
    // apart, and off the pixels' centres
    const auto within = [](std::int32_t d) { return std::clamp(d, -kQuarter / 2, kQuarter / 2); };
    v.home = {corner.x + off.x, corner.y + off.y};
    v.position =
        v.keep ? v.home
               : GridPoint{v.home.x + within(v.position.x - corner.x), v.home.y + within(v.position.y - corner.y)};
    return v;
  }

  /// The contour between the two junctions of such a corner.
  void part(int x, int y) {
    const JoinedDiagonal parted = parted_diagonal(x, y);
    if (parted == JoinedDiagonal::none) return;
    Arc arc;  // from the junction on the low side of x to that on the high one
    arc.left = parted == JoinedDiagonal::rising ? slice_.at(x - 1, y) : slice_.at(x, y);
    arc.right = parted == JoinedDiagonal::rising ? slice_.at(x, y - 1) : slice_.at(x - 1, y - 1);
    arc.chain = {end_vertex(x, y, 2), end_vertex(x, y, 0)};
    out_.arcs.push_back(std::move(arc));
  }

  /// All arcs: first from junction to junction, then the closed loops.
  void link() {
    for_each_corner([&](int x, int y) {
      if (classify(x, y) != Corner::junction) return;
      part(x, y);
      for (int dir = 0; dir < 4; ++dir)
        if (crack(x, y, dir).exists() && !crack(x, y, dir).used()) walk(x, y, dir, false);
    });
    for_each_corner([&](int x, int y) {
      for (int dir = 0; dir < 2; ++dir)
        if (crack(x, y, dir).exists() && !crack(x, y, dir).used()) walk(x, y, dir, true);
    });
  }

  /// Visits, row by row, the corners with a crack to the east or north: all where three cracks meet are among
  /// them.
  template <class Visit>
  void for_each_corner(Visit visit) {
    const std::size_t end = static_cast<std::size_t>(width_) * (height_ + 1);
    for (std::size_t at = width_; at < end; ++at) {
      std::uint64_t eight;
      std::memcpy(&eight, &cracks_[at], sizeof eight);
      if (eight == 0) at += 7;
      else if (cracks_[at] != 0)
        visit(all_.x0 + static_cast<int>(at % width_), all_.y0 + static_cast<int>(at / width_) - 1);
    }
  }

  const Slice& slice_;
  const CornerRules& rules_;
  SliceArcs out_;
  Box all_;
  std::map<std::uint16_t, Extent> labels_;
  int width_ = 0, height_ = 0;
  std::vector<std::uint8_t> cracks_;
};

}  // namespace

SliceArcs trace_arcs(const Slice& slice, const CornerRules& rules) {
  return SliceTracer(slice, rules).run();
}

}  // namespace stackmesh
