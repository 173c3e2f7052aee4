#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <map>

#include "base/error.h"
#include "contour/arcs.h"

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

// Steps along the cracks: +x, +y, -x, -y.
constexpr std::array<int, 4> kStepX = {1, 0, -1, 0}, kStepY = {0, 1, 0, -1};

class SliceTracer {
 public:
  SliceTracer(const Slice& slice, const SameComponent& same, bool part) : slice_(slice), same_(same), part_(part) {}

  SliceArcs run() {
    std::map<std::uint16_t, Box> boxes;
    for (int y = 0; y < slice_.height; ++y) {
      const std::uint16_t* row = &slice_.pixels[static_cast<std::size_t>(y) * slice_.width];
      for (int x = 0; x < slice_.width;) {
        const std::uint16_t label = row[x];
        const int start = x;
        while (x < slice_.width && row[x] == label) ++x;
        if (label == 0) continue;
        Box& box = boxes[label];
        box.add(start, y);
        box.add(x - 1, y);
        all_.add(start, y);
        all_.add(x - 1, y);
      }
    }
    if (boxes.empty()) return {};
    width_ = all_.x1 - all_.x0 + 2;  // corners in x
    height_ = all_.y1 - all_.y0 + 2;
    horizontal_.assign(static_cast<std::size_t>(width_) * height_, 0);
    vertical_.assign(static_cast<std::size_t>(width_) * height_, 0);
    for (const auto& [label, box] : boxes) trace_label(label, box);
    link();
    return std::move(out_);
  }

 private:
  std::size_t corner(int x, int y) const { return static_cast<std::size_t>(y - all_.y0) * width_ + (x - all_.x0); }

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
        if (next.y == last.y && std::abs(next.x - last.x) == 1) horizontal_[corner(std::min(last.x, next.x), next.y)] = 1;
        else if (next.x == last.x && std::abs(next.y - last.y) == 1) vertical_[corner(next.x, std::min(last.y, next.y))] = 1;
        else fail_internal("a traced border leaves the pixel cracks", "contours");
        last = next;
      }
    }
  }

  std::uint8_t& crack(int x, int y, int dir) {
    switch (dir) {
      case 0: return horizontal_[corner(x, y)];
      case 1: return vertical_[corner(x, y)];
      case 2: return horizontal_[corner(x - 1, y)];
      default: return vertical_[corner(x, y - 1)];
    }
  }
  bool has_crack(int x, int y, int dir) const {  // the four labels around the corner tell
    const std::uint16_t sw = slice_.at(x - 1, y - 1), se = slice_.at(x, y - 1), nw = slice_.at(x - 1, y), ne = slice_.at(x, y);
    return dir == 0 ? ne != se : dir == 1 ? nw != ne : dir == 2 ? nw != sw : sw != se;
  }

  enum class Corner { pass, junction, join_rising, join_falling };  // rising: the pixels SW and NE are joined

  Corner classify(int x, int y) const {
    const std::uint16_t sw = slice_.at(x - 1, y - 1), se = slice_.at(x, y - 1), nw = slice_.at(x - 1, y), ne = slice_.at(x, y);
    const int degree = (ne != se) + (nw != ne) + (nw != sw) + (sw != se);
    if (degree <= 2) return Corner::pass;
    if (degree == 3) return Corner::junction;
    const bool rising = sw == ne, falling = nw == se;
    if (rising && sw == 0) return Corner::join_rising;
    if (falling && nw == 0) return Corner::join_falling;
    if (rising && same_(x - 1, y - 1, x, y)) return Corner::join_rising;
    if (falling && same_(x - 1, y, x, y - 1)) return Corner::join_falling;
    return Corner::junction;
  }

  /// Follows cracks from corner (x, y) in direction dir until a junction, or back to the first crack.
  void walk(int x, int y, int dir, bool closed) {
    Arc arc;
    arc.closed = closed;
    const std::uint16_t sw = slice_.at(x - 1, y - 1), se = slice_.at(x, y - 1), nw = slice_.at(x - 1, y), ne = slice_.at(x, y);
    arc.left = dir == 0 ? ne : dir == 1 ? nw : dir == 2 ? sw : se;
    arc.right = dir == 0 ? se : dir == 1 ? ne : dir == 2 ? nw : sw;
    arc.chain.push_back(vertex(x, y));
    const int first_x = x, first_y = y, first_dir = dir;
    while (true) {
      std::uint8_t& c = crack(x, y, dir);
      if (c != 1) fail_internal("a pixel crack was traced by no border, or twice", "contours");
      c = 2;
      x += kStepX[dir];
      y += kStepY[dir];
      arc.chain.push_back(vertex(x, y));
      const Corner kind = classify(x, y);
      if (kind == Corner::junction) break;
      const int next = turn(x, y, dir, kind);
      if (part_ && kind != Corner::pass) draw_apart(arc.chain.back(), dir, next);
      dir = next;
      if (closed && x == first_x && y == first_y && dir == first_dir) {
        arc.chain.front() = arc.chain.back();
        break;
      }
    }
    out_.arcs.push_back(std::move(arc));
  }

  /// The direction in which the contour goes on.
  int turn(int x, int y, int dir, Corner kind) const {
    if (kind == Corner::pass) {
      for (int d : {dir, (dir + 1) & 3, (dir + 3) & 3})
        if (has_crack(x, y, d)) return d;
      fail_internal("a contour ends in the open", "contours");
    }
    // Joined rising (SW-NE): contours round NW and SE, so cracks pair as (north, west) and (south, east).
    // An arrival by direction d comes through the crack opposite d.
    static constexpr std::array<int, 4> rising = {1, 0, 3, 2};   // east-bound comes from the west crack: goes north
    static constexpr std::array<int, 4> falling = {3, 2, 1, 0};  // ... goes south
    return kind == Corner::join_rising ? rising[dir] : falling[dir];
  }

  /// Moves a corner that two contours pass a quarter pixel into the pixel that this contour turns about.
  static void draw_apart(CrackVertex& v, int arrived, int leaves) {
    // The pixel lies between the crack it came by (opposite `arrived`) and the crack it leaves by.
    const int quarter = kGridPerPixel / 4;
    v.position.x += quarter * (kStepX[leaves] - kStepX[arrived]);
    v.position.y += quarter * (kStepY[leaves] - kStepY[arrived]);
  }

  static CrackVertex vertex(int x, int y) { return {x, y, {x * kGridPerPixel, y * kGridPerPixel}}; }

  /// All arcs: first from junction to junction, then the closed loops.
  void link() {
    for (int y = all_.y0; y <= all_.y1 + 1; ++y)
      for (int x = all_.x0; x <= all_.x1 + 1; ++x) {
        if (classify(x, y) != Corner::junction) continue;
        for (int dir = 0; dir < 4; ++dir)
          if (has_crack(x, y, dir) && crack(x, y, dir) != 2) walk(x, y, dir, false);
      }
    for (int y = all_.y0; y <= all_.y1 + 1; ++y)
      for (int x = all_.x0; x <= all_.x1 + 1; ++x)
        for (int dir = 0; dir < 2; ++dir)
          if (has_crack(x, y, dir) && crack(x, y, dir) != 2) walk(x, y, dir, true);
  }

  const Slice& slice_;
  const SameComponent& same_;
  const bool part_;
  SliceArcs out_;
  Box all_;
  int width_ = 0, height_ = 0;
  std::vector<std::uint8_t> horizontal_, vertical_;  // 1: traced by a border, 2: in an arc
};

}  // namespace

SliceArcs trace_arcs(const Slice& slice, const SameComponent& same_component, bool part_corners) {
  return SliceTracer(slice, same_component, part_corners).run();
}

bool has_touching_labels(const Slice& slice) {
  for (int y = 1; y < slice.height; ++y) {
    const std::uint16_t* low = &slice.pixels[static_cast<std::size_t>(y - 1) * slice.width];
    const std::uint16_t* high = low + slice.width;
    for (int x = 1; x < slice.width; ++x) {
      const std::uint16_t sw = low[x - 1], se = low[x], nw = high[x - 1], ne = high[x];
      if (sw == se || nw == ne || sw == nw || se == ne) continue;
      if ((sw == ne && sw == 0) || (nw == se && nw == 0)) continue;
      if (sw == ne || nw == se) return true;
    }
  }
  return false;
}

}  // namespace stackmesh
