#include "sections/components.h"

#include <algorithm>

namespace stackmesh {
namespace {

/// True if (x, y) of the slice and (x + dx, y + dy) of the other one hang together by voxels between the two.
bool joined_nearby(const Slice& slice, const Slice& other, int x, int y, int dx, int dy) {
  const std::uint16_t label = slice.at(x, y);
  const auto in = [&](const Slice& s, int sx, int sy) { return s.at(sx, sy) == label; };
  if (dx == 0 || dy == 0) return in(slice, x + dx, y + dy);
  return (in(slice, x + dx, y) && (in(other, x + dx, y) || in(slice, x + dx, y + dy))) ||
         (in(slice, x, y + dy) && (in(other, x, y + dy) || in(slice, x + dx, y + dy)));
}

/// A voxel of the slice goes on into the other slice, where its label's next component touches it by a
/// corner.
void touching_beside(const VoxelComponents& components, const Slice& slice, const Slice& other, int other_k,
                     std::vector<TouchingCorner>& corners) {
  for (int y = 0; y + 1 < other.height; ++y) {
    const std::uint16_t* low = &other.pixels[static_cast<std::size_t>(y) * other.width];
    const std::uint16_t* high = low + other.width;
    for (int x = 0; x + 1 < other.width; ++x) {
      if (x + 4 <= other.width && four_pixels(low + x) == four_pixels(high + x)) {
        x += 3;
        continue;
      }
      if (low[x] == low[x + 1] || low[x] == high[x] || low[x + 1] == high[x + 1] || high[x] == high[x + 1]) continue;
      for (int left : {0, 1}) {  // the diagonals (x, y)-(x + 1, y + 1) and (x + 1, y)-(x, y + 1)
        const int right = 1 - left;
        const std::uint16_t label = low[x + left];
        if (label == 0 || high[x + right] != label) continue;
        const int low_touches = slice.at(x + left, y) == label, high_touches = slice.at(x + right, y + 1) == label;
        if (low_touches + high_touches == 0) continue;
        if (components.of(x + left, y, other_k) != components.of(x + right, y + 1, other_k))
          corners.push_back(
              {corner_key(x + 1, y + 1), static_cast<std::uint8_t>(low_touches << left | high_touches << (right + 2))});
      }
    }
  }
}

}  // namespace

void touching_corners(const VoxelComponents& components, const Slice& slice, int k, const Slice& other, int other_k,
                      std::vector<TouchingCorner>& corners) {
  touching_beside(components, slice, other, other_k, corners);
  for (int y = 0; y < slice.height; ++y) {
    const std::uint16_t* row = &slice.pixels[static_cast<std::size_t>(y) * slice.width];
    const std::uint16_t* across = &other.pixels[static_cast<std::size_t>(y) * slice.width];
    for (int x = 0; x < slice.width; ++x) {
      if (x + 4 <= slice.width && (four_pixels(row + x) == 0 || four_pixels(row + x) == four_pixels(across + x))) {
        x += 3;
        continue;
      }
      const std::uint16_t label = row[x];
      if (label == 0 || across[x] == label) continue;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if (other.at(x + dx, y + dy) != label || joined_nearby(slice, other, x, y, dx, dy) ||
              components.of(x, y, k) == components.of(x + dx, y + dy, other_k))
            continue;
          // The corners that pixel (x, y) shares with its neighbour.
          for (int cy = std::max(0, dy); cy <= std::min(1, 1 + dy); ++cy)
            for (int cx = std::max(0, dx); cx <= std::min(1, 1 + dx); ++cx)
              corners.push_back(
                  {corner_key(x + cx, y + cy), static_cast<std::uint8_t>(1 << ((1 - cx) + 2 * (1 - cy)))});
        }
    }
  }
}

void unite(std::vector<TouchingCorner>& corners) {
  std::sort(corners.begin(), corners.end());
  std::size_t n = 0;
  for (const TouchingCorner& c : corners) {
    if (n > 0 && corners[n - 1].key == c.key) corners[n - 1].quadrants |= c.quadrants;
    else corners[n++] = c;
  }
  corners.resize(n);
}

}  // namespace stackmesh
