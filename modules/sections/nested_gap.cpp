#include "sections/nested_gap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "base/disjoint_sets.h"

namespace stackmesh::interpolate {
namespace {

constexpr float kFar = 8;              // pixels: distances are known up to that
constexpr double kWallKept = 0.6;      // share of the thinnest drawn wall that is kept between slices
constexpr double kLeastWall_px = 1.1;  // less would not show in the raster
constexpr double kMostWall_px = 4;
constexpr double kOpens_rel = 0.5;       // of an enclosed part under the open: it is not enclosed any more there
constexpr std::uint16_t kHole = 0xffff;  // stands for background that a label encloses

/// A region of one label or of background.
struct Region {
  std::uint16_t label = 0;
  std::int32_t round = -1;  // the region that encloses it most closely; -1: none
  int level = 0;
  bool outside = false;
  std::size_t pixels = 0;
};

/// The regions of a slice and which lies within which.
class Nesting {
 public:
  explicit Nesting(const Pixels& slice) : slice_(slice) {
    find_regions();
    find_enclosers();
  }

  const Pixels& slice() const { return slice_; }
  std::vector<Region> regions;
  std::vector<std::int32_t> of;  // per pixel

  /// The region at a level that holds that region; -1: it lies further out. Level 0 is nothing round it.
  std::int32_t at_level(std::int32_t r, int level) const {
    if (r < 0 || regions[r].outside) return -1;
    while (regions[r].level > level) {
      if (regions[r].round < 0) return -1;
      r = regions[r].round;
    }
    return regions[r].level == level ? r : -1;
  }

  /// Of a side of a contour: the region beside it; -1: the raster does not show it.
  std::int32_t beside(const BorderPiece& piece, bool left) const {
    const std::int32_t label = left ? piece.left : piece.right;
    const double dx = piece.bx - piece.ax, dy = piece.by - piece.ay, length = std::hypot(dx, dy);
    const double side = length > 0 ? (left ? 0.3 : -0.3) / length : 0;
    for (double t : {0.5, 0.2, 0.8}) {
      const double x = piece.ax + t * dx - side * dy, y = piece.ay + t * dy + side * dx;
      const int px = static_cast<int>(std::lround(x)), py = static_cast<int>(std::lround(y));
      double nearest = std::numeric_limits<double>::infinity();
      std::int32_t region = -1;
      for (int v = std::max(0, py - 1); v <= std::min(slice_.height - 1, py + 1); ++v)
        for (int u = std::max(0, px - 1); u <= std::min(slice_.width - 1, px + 1); ++u) {
          const std::size_t p = static_cast<std::size_t>(v) * slice_.width + u;
          const double d = (u - x) * (u - x) + (v - y) * (v - y);
          if (slice_.label[p] != label || d >= nearest) continue;
          nearest = d;
          region = of[p];
        }
      if (region >= 0) return region;
    }
    return -1;
  }

  void set_levels() {
    // The enclosing region of a region has been reached earlier from the outside: depth by following.
    for (Region& r : regions) r.level = -1;
    for (std::size_t i = 0; i < regions.size(); ++i) level_of(static_cast<std::int32_t>(i));
  }

 private:
  int level_of(std::int32_t i) {
    Region& r = regions[i];
    if (r.level >= 0) return r.level;
    r.level = 0;
    if (r.outside) return 0;
    const int out = r.round < 0 ? -1 : level_of(r.round);
    const bool in_the_open = r.round >= 0 && out == 0 && regions[r.round].label == 0;
    return regions[i].level = in_the_open ? 0 : out + 1;
  }

  void find_regions() {
    const int width = slice_.width, height = slice_.height;
    DisjointSets sets(slice_.label.size());
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const std::int32_t p = y * width + x;
        if (x > 0 && slice_.label[p - 1] == slice_.label[p]) sets.join(p - 1, p);
        if (y > 0 && slice_.label[p - width] == slice_.label[p]) sets.join(p - width, p);
      }
    of.assign(slice_.label.size(), -1);
    for (std::size_t p = 0; p < of.size(); ++p) {
      const std::int32_t root = sets.find(static_cast<std::int32_t>(p));
      if (of[root] < 0) {
        of[root] = static_cast<std::int32_t>(regions.size());
        regions.emplace_back();
        regions.back().label = slice_.label[p];
      }
      of[p] = of[root];
      ++regions[of[p]].pixels;
      const int x = static_cast<int>(p) % width, y = static_cast<int>(p) / width;
      if (slice_.label[p] == 0 && (x == 0 || y == 0 || x + 1 == width || y + 1 == height))
        regions[of[p]].outside = true;
    }
  }

  void find_enclosers() {
    const std::size_t n = regions.size();
    std::vector<std::set<std::int32_t>> beside(n);
    const int width = slice_.width;
    for (std::size_t p = 0; p < of.size(); ++p) {
      const auto meet = [&](std::int32_t a, std::int32_t b) {
        if (a == b) return;
        beside[a].insert(b);
        beside[b].insert(a);
      };
      if ((p + 1) % width != 0) meet(of[p], of[p + 1]);
      if (p + width < of.size()) meet(of[p], of[p + width]);
    }
    std::vector<int> enclosers(n, 0), best(n, -1);
    std::vector<std::vector<std::int32_t>> within(n);
    for (std::size_t h = 0; h < n; ++h) {
      if (regions[h].outside || beside[h].size() < 2) continue;
      std::vector<char> seen(n, 0);
      std::vector<std::int32_t> front;
      for (std::size_t i = 0; i < n; ++i)
        if (regions[i].outside) {
          seen[i] = 1;
          front.push_back(static_cast<std::int32_t>(i));
        }
      while (!front.empty()) {
        const std::int32_t i = front.back();
        front.pop_back();
        for (std::int32_t j : beside[i])
          if (!seen[j] && static_cast<std::size_t>(j) != h) {
            seen[j] = 1;
            front.push_back(j);
          }
      }
      for (std::size_t i = 0; i < n; ++i)
        if (!seen[i] && i != h) {
          ++enclosers[i];
          within[i].push_back(static_cast<std::int32_t>(h));
        }
    }
    // The closest encloser is itself enclosed by all others.
    for (std::size_t i = 0; i < n; ++i)
      for (std::int32_t h : within[i])
        if (enclosers[h] > best[i]) {
          best[i] = enclosers[h];
          regions[i].round = h;
        }
  }

  const Pixels& slice_;
};

class NestedFiller {
 public:
  NestedFiller(const Gap& gap, const NestedOptions& options)
      : gap_(gap), o_(options), low_(*gap.low), high_(*gap.high) {}

  NestedLayers run() {
    open_where_not_met(low_, high_);
    open_where_not_met(high_, low_);
    low_.set_levels();
    high_.set_levels();
    int levels = count_levels();
    if (levels > 1 && !agree()) {
      levels = 1;
    }
    flat_ = levels == 1;
    out_.nested = levels > 1;
    if (!flat_ && o_.per_gap > 0) {
      if (gap_.before != nullptr) before_.emplace(*gap_.before).set_levels();
      if (gap_.after != nullptr) after_.emplace(*gap_.after).set_levels();
    }
    out_.label = {0};
    out_.layer.resize(o_.per_gap);
    for (NestedLayers::Layer& l : out_.layer) {
      l.part.assign(gap_.low->label.size(), 0);
      l.level.assign(gap_.low->label.size(), -1);
    }
    if (o_.per_gap > 0)
      for (int d = 0; d < levels; ++d) add_level(d);
    if (levels > 1) out_.breaks = count_breaks();
    return std::move(out_);
  }

 private:
  int count_levels() const {
    int levels = 1;
    for (const Nesting* n : {&low_, &high_})
      for (const Region& r : n->regions)
        if (!r.outside) levels = std::max(levels, r.level + 1);
    return levels;
  }

  /// A region that is enclosed here, but has no enclosed counterpart there and lies under the open or meets its label:
  /// it opens.
  static void open_where_not_met(Nesting& here, const Nesting& there) {
    for (std::size_t i = 0; i < here.regions.size(); ++i) {
      Region& r = here.regions[i];
      if (r.outside || r.round < 0) continue;
      const std::uint16_t host = here.regions[r.round].label;
      bool met = false, host_goes_on = false;
      for (const Region& s : there.regions) {
        met = met || (!s.outside && s.round >= 0 && s.label == r.label && there.regions[s.round].label == host);
        host_goes_on = host_goes_on || (!s.outside && s.label == host);
      }
      if (met) continue;
      std::size_t open = 0;
      bool meets = false;
      for (std::size_t p = 0; p < here.of.size(); ++p)
        if (here.of[p] == static_cast<std::int32_t>(i)) {
          const Region& s = there.regions[there.of[p]];
          open += s.outside;
          meets = meets || (r.label != 0 && s.label == r.label);
        }
      if (meets || (host_goes_on && static_cast<double>(open) > kOpens_rel * static_cast<double>(r.pixels)))
        r.round = here.regions[r.round].round;
    }
  }

  /// The label of each level of nesting, if each is a single region; else nothing.
  static std::vector<std::uint16_t> chain(const Nesting& n) {
    std::vector<std::uint16_t> out;
    std::size_t inside = 0;
    for (const Region& r : n.regions) {
      if (r.outside) continue;
      ++inside;
      if (r.level >= static_cast<int>(out.size())) out.resize(static_cast<std::size_t>(r.level) + 1, kHole);
      out[static_cast<std::size_t>(r.level)] = r.label;
    }
    return inside == out.size() ? out : std::vector<std::uint16_t>();
  }

  /// A part that meets its label in the other slice must meet it at its own level of nesting, too; unless the two
  /// slices are the same single nest, one of which has grown or moved by more than its walls: then the levels tell what
  /// goes on in what.
  bool agree() const {
    if (const std::vector<std::uint16_t> nest = chain(low_); !nest.empty() && nest == chain(high_)) return true;
    // 1: at another level, 2: at its own
    std::vector<std::uint8_t> low(low_.regions.size(), 0), high(high_.regions.size(), 0);
    for (std::size_t p = 0; p < low_.of.size(); ++p) {
      const Region &a = low_.regions[low_.of[p]], &b = high_.regions[high_.of[p]];
      if (a.label == 0 || a.label != b.label) continue;
      low[low_.of[p]] |= a.level == b.level ? 2 : 1;
      high[high_.of[p]] |= a.level == b.level ? 2 : 1;
    }
    const auto strays = [](std::uint8_t m) { return m == 1; };
    return std::none_of(low.begin(), low.end(), strays) && std::none_of(high.begin(), high.end(), strays);
  }

  static std::uint16_t shown(const Nesting& n, std::int32_t region) {
    if (region < 0) return 0;
    const Region& r = n.regions[region];
    return r.outside || (r.label == 0 && r.level == 0) ? 0 : r.label == 0 ? kHole : r.label;
  }

  /// A slice as level d sees it: what lies further out is background, what lies deeper belongs to what encloses it.
  Pixels seen_at(const Nesting& n, int d) const {
    if (flat_) return n.slice();
    Pixels out;
    out.width = n.slice().width;
    out.height = n.slice().height;
    std::vector<std::uint16_t> label(n.regions.size());
    for (std::size_t r = 0; r < n.regions.size(); ++r) label[r] = shown(n, n.at_level(static_cast<std::int32_t>(r), d));
    out.label.resize(n.of.size());
    for (std::size_t p = 0; p < n.of.size(); ++p) out.label[p] = label[n.of[p]];
    for (BorderPiece piece : n.slice().border) {
      const auto side = [&](bool left) -> std::int32_t {
        const std::int32_t given = left ? piece.left : piece.right, r = n.beside(piece, left);
        if (r < 0) return d == 0 ? given : 0;
        return label[r];
      };
      const std::int32_t l = side(true), r = side(false);
      piece.left = l;
      piece.right = r;
      if (l != r) out.border.push_back(piece);
    }
    return out;
  }

  static std::vector<BorderPiece> outline(const Pixels& slice) {
    std::vector<BorderPiece> out;
    for (const BorderPiece& b : slice.border)
      if ((b.left == 0) != (b.right == 0)) out.push_back(b);
    return out;
  }

  static double squared(double px, double py, const BorderPiece& s) {
    const double dx = s.bx - s.ax, dy = s.by - s.ay, length2 = dx * dx + dy * dy;
    const double t = length2 > 0 ? std::clamp(((px - s.ax) * dx + (py - s.ay) * dy) / length2, 0.0, 1.0) : 0;
    return (px - s.ax - t * dx) * (px - s.ax - t * dx) + (py - s.ay - t * dy) * (py - s.ay - t * dy);
  }

  /// The smallest distance between two outlines, pixels, up to 2 * kMostWall_px / kWallKept; that if one is empty.
  static double wall(const Pixels& outer, const Pixels& inner) {
    const double most = 2 * kMostWall_px / kWallKept;
    double least = most * most;
    const std::vector<BorderPiece> a = outline(outer);
    std::vector<BorderPiece> b = outline(inner);
    const auto by_x = [](const BorderPiece& u, const BorderPiece& v) {
      return std::min(u.ax, u.bx) < std::min(v.ax, v.bx);
    };
    std::sort(b.begin(), b.end(), by_x);
    double widest = 0;
    for (const BorderPiece& s : b) widest = std::max(widest, std::abs(s.ax - s.bx));
    for (const BorderPiece& s : a) {
      const double x0 = std::min(s.ax, s.bx), x1 = std::max(s.ax, s.bx);
      auto it = std::lower_bound(b.begin(), b.end(), x0 - most - widest,
                                 [](const BorderPiece& u, double x) { return std::min(u.ax, u.bx) < x; });
      for (; it != b.end() && std::min(it->ax, it->bx) < x1 + most; ++it)
        least = std::min({least, squared(s.ax, s.ay, *it), squared(s.bx, s.by, *it), squared(it->ax, it->ay, s),
                          squared(it->bx, it->by, s)});
    }
    return std::sqrt(least);
  }

  static bool is_empty(const Pixels& slice) {
    return std::all_of(slice.label.begin(), slice.label.end(), [](std::uint16_t l) { return l == 0; });
  }

  void add_level(int d) {
    std::array<Pixels, 4> seen;
    Gap level = gap_;
    const auto look = [&](const Pixels* from, const Nesting* known, Pixels& to) -> const Pixels* {
      if (from == nullptr) return nullptr;
      to = known != nullptr ? seen_at(*known, d) : *from;
      return &to;
    };
    level.before = look(gap_.before, before_ ? &*before_ : nullptr, seen[0]);
    level.low = look(gap_.low, &low_, seen[1]);
    level.high = look(gap_.high, &high_, seen[2]);
    level.after = look(gap_.after, after_ ? &*after_ : nullptr, seen[3]);
    const bool ends = is_empty(seen[1]) || is_empty(seen[2]);
    level.end_at = o_.end_at * (ends && outer_ends_ && d > 0 ? std::pow(o_.inner_end_rel, d) : 1.0);
    outer_ends_ = outer_ends_ && ends;
    std::vector<LayerDepth> depth;
    const GapLayers layers = fill_gap(level, o_.per_gap, o_.tension, o_.pixel_mm, &depth);
    const std::int32_t first = static_cast<std::int32_t>(out_.label.size()) - 1;  // parts are numbered on
    for (std::size_t g = 1; g < layers.label.size(); ++g)
      out_.label.push_back(layers.label[g] == kHole ? 0 : layers.label[g]);
    const double wall_low = d > 0 ? wall(outer_[0], seen[1]) : 0, wall_high = d > 0 ? wall(outer_[1], seen[2]) : 0;
    for (int j = 0; j < o_.per_gap; ++j) {
      NestedLayers::Layer& out = out_.layer[j];
      const double t = static_cast<double>(j + 1) / (o_.per_gap + 1);
      const float keep =
          static_cast<float>(std::clamp(kWallKept * ((1 - t) * wall_low + t * wall_high), kLeastWall_px, kMostWall_px));
      std::vector<float> inside(out.part.size());
      for (std::size_t p = 0; p < inside.size(); ++p) {
        const std::int32_t group = layers.group[j + 1][p];
        inside[p] = group != 0 ? depth[j].tissue[p] : -depth[j].tissue[p];
        if (d > 0 && out.inside[d - 1][p] < kFar) inside[p] = std::min(inside[p], out.inside[d - 1][p] - keep);
        if (group == 0 || (d > 0 && !(inside[p] > 0 && out.level[p] == d - 1))) {
          inside[p] = std::min(inside[p], 0.0f);
          continue;
        }
        const bool hole = layers.label[group] == kHole;
        out.part[p] = hole ? 0 : first + group;
        out.level[p] = static_cast<std::int8_t>(d);
      }
      out.inside.push_back(std::move(inside));
      out.label_depth.push_back(std::move(depth[j].label));
    }
    outer_ = {std::move(seen[1]), std::move(seen[2])};
  }

  std::vector<std::int8_t> levels_of(const Nesting& n) const {
    std::vector<std::int8_t> out(n.of.size());
    for (std::size_t p = 0; p < out.size(); ++p) {
      const Region& r = n.regions[n.of[p]];
      out[p] = static_cast<std::int8_t>(r.outside || (r.label == 0 && r.level == 0) ? -1 : r.level);
    }
    return out;
  }

  /// Pixels that skip a level of nesting from one layer to the next, there or beside.
  std::size_t count_breaks() const {
    const std::size_t width = gap_.low->width, size = gap_.low->label.size();
    std::vector<std::int8_t> below = levels_of(low_);
    std::size_t count = 0;
    for (int j = 0; j <= o_.per_gap; ++j) {
      const std::vector<std::int8_t> above = j < o_.per_gap ? out_.layer[j].level : levels_of(high_);
      for (std::size_t p = width + 1; p + width + 1 < size; ++p) {
        if (below[p] == above[p] && below[p] == above[p - 1] && below[p] == above[p + width]) continue;
        bool skips = false;
        for (std::size_t q : {p, p - 1, p + 1, p - width, p + width})
          skips = skips || std::abs(below[p] - above[q]) > 1;
        count += skips;
      }
      below = above;
    }
    return count;
  }

  const Gap& gap_;
  const NestedOptions& o_;
  Nesting low_, high_;
  std::optional<Nesting> before_, after_;
  NestedLayers out_;
  std::array<Pixels, 2> outer_;  // the level before
  bool flat_ = false, outer_ends_ = true;
};

}  // namespace

NestedLayers fill_nested_gap(const Gap& gap, const NestedOptions& options) {
  return NestedFiller(gap, options).run();
}

}  // namespace stackmesh::interpolate
