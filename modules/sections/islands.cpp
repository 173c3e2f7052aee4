#include "sections/islands.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/disjoint_sets.h"

namespace stackmesh::interpolate {
namespace {

/// The island of that label just beside a piece of its contour; -1 if the raster has none there.
std::int32_t island_beside(const BorderPiece& piece, bool left, const Pixels& slice, const Islands& islands) {
  const std::int32_t label = left ? piece.left : piece.right;
  if (label == 0) return 0;
  const double dx = piece.bx - piece.ax, dy = piece.by - piece.ay, length = std::hypot(dx, dy);
  const double side = length > 0 ? (left ? 0.3 : -0.3) / length : 0;
  for (double t : {0.5, 0.2, 0.8}) {
    const double x = piece.ax + t * dx - side * dy, y = piece.ay + t * dy + side * dx;
    const int px = static_cast<int>(std::lround(x)), py = static_cast<int>(std::lround(y));
    double nearest = 1e300;
    std::int32_t island = -1;
    for (int v = std::max(0, py - 1); v <= std::min(slice.height - 1, py + 1); ++v)
      for (int u = std::max(0, px - 1); u <= std::min(slice.width - 1, px + 1); ++u) {
        const std::size_t p = static_cast<std::size_t>(v) * slice.width + u;
        const double d = (u - x) * (u - x) + (v - y) * (v - y);
        if (slice.label[p] != label || d >= nearest) continue;
        nearest = d;
        island = islands.of[p];
      }
    if (island >= 0) return island;
  }
  return -1;
}

/// Which islands of `outer` lie over which group of the slab.
void link(const Islands& outer, const Islands& inner, const std::vector<std::int32_t>& group_of,
          std::vector<Group>& groups, std::vector<std::int32_t> Group::*links) {
  std::int32_t last_outer = 0, last_inner = 0;
  for (std::size_t p = 0; p < outer.of.size(); ++p) {
    const std::int32_t a = outer.of[p], b = inner.of[p];
    if (a == 0 || b == 0 || (a == last_outer && b == last_inner) || outer.label[a] != inner.label[b]) continue;
    (groups[group_of[b]].*links).push_back(last_outer = a);
    last_inner = b;
  }
  for (Group& g : groups) {
    std::vector<std::int32_t>& list = g.*links;
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
}

}  // namespace

void Box::add(const Box& other) {
  if (other.empty()) return;
  if (empty()) {
    *this = other;
    return;
  }
  x0 = std::min(x0, other.x0);
  y0 = std::min(y0, other.y0);
  x1 = std::max(x1, other.x1);
  y1 = std::max(y1, other.y1);
}

Box Box::grown(int pixels, int max_width, int max_height) const {
  return {std::max(0, x0 - pixels), std::max(0, y0 - pixels), std::min(max_width, x1 + pixels),
          std::min(max_height, y1 + pixels)};
}

Islands find_islands(const Pixels& slice) {
  Islands islands;
  const int width = slice.width;
  islands.of.assign(slice.label.size(), 0);
  DisjointSets sets;
  sets.add();  // background
  for (int y = 0; y < slice.height; ++y) {
    const std::uint16_t* row = slice.label.data() + static_cast<std::size_t>(y) * width;
    std::int32_t* ids = islands.of.data() + static_cast<std::size_t>(y) * width;
    for (int x = 0; x < width; ++x) {
      if (row[x] == 0) continue;
      const bool left = x > 0 && row[x - 1] == row[x], under = y > 0 && row[x - width] == row[x];
      if (left) ids[x] = ids[x - 1];
      if (under && left && ids[x] != ids[x - width]) sets.join(ids[x], ids[x - width]);
      else if (under && !left) ids[x] = ids[x - width];
      else if (!left) ids[x] = sets.add();
    }
  }
  std::vector<std::int32_t> number(sets.size(), 0);
  islands.label = {0};
  islands.box = {Box{}};
  for (int y = 0; y < slice.height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t p = static_cast<std::size_t>(y) * width + x;
      if (islands.of[p] == 0) continue;
      std::int32_t& n = number[sets.find(islands.of[p])];
      if (n == 0) {
        n = islands.count();
        islands.label.push_back(slice.label[p]);
        islands.box.push_back({x, y, x + 1, y + 1});
      }
      islands.of[p] = n;
      Box& box = islands.box[n];
      box.x0 = std::min(box.x0, x);
      box.x1 = std::max(box.x1, x + 1);
      box.y1 = y + 1;
    }
  for (const BorderPiece& piece : slice.border) {
    BorderPiece between = piece;
    between.left = island_beside(piece, true, slice, islands);
    between.right = island_beside(piece, false, slice, islands);
    if (between.left != between.right) islands.border.push_back(between);
  }
  return islands;
}

Groups group_islands(const Islands& low, const Islands& high, const Islands* before, const Islands* after) {
  DisjointSets sets;
  for (int i = 0; i < low.count() + high.count(); ++i) sets.add();
  const std::int32_t shift = low.count();  // island h of `high` is h + shift
  std::int32_t last_low = 0, last_high = 0;
  for (std::size_t p = 0; p < low.of.size(); ++p) {
    const std::int32_t a = low.of[p], b = high.of[p];
    if (a == 0 || b == 0 || (a == last_low && b == last_high) || low.label[a] != high.label[b]) continue;
    sets.join(last_low = a, (last_high = b) + shift);
  }
  Groups groups;
  groups.list.emplace_back();
  groups.of_low.assign(low.count(), 0);
  groups.of_high.assign(high.count(), 0);
  std::vector<std::int32_t> number(sets.size(), 0);
  const auto group_of = [&](std::int32_t element, std::uint16_t label) {
    std::int32_t& n = number[sets.find(element)];
    if (n == 0) {
      n = static_cast<std::int32_t>(groups.list.size());
      groups.list.emplace_back().label = label;
    }
    return n;
  };
  for (std::int32_t i = 1; i < low.count(); ++i) {
    groups.of_low[i] = group_of(i, low.label[i]);
    groups.list[groups.of_low[i]].low.add(low.box[i]);
  }
  for (std::int32_t i = 1; i < high.count(); ++i) {
    groups.of_high[i] = group_of(i + shift, high.label[i]);
    groups.list[groups.of_high[i]].high.add(high.box[i]);
  }
  if (before != nullptr) link(*before, low, groups.of_low, groups.list, &Group::before);
  if (after != nullptr) link(*after, high, groups.of_high, groups.list, &Group::after);
  return groups;
}

}  // namespace stackmesh::interpolate
