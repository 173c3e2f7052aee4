#pragma once
#include <cstdint>
#include <vector>

namespace stackmesh::interpolate {

/// Pixels [x0, x1) x [y0, y1).
struct Box {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool empty() const { return x0 >= x1 || y0 >= y1; }
  std::size_t area() const { return empty() ? 0 : static_cast<std::size_t>(width()) * height(); }
  void add(const Box& other);
  Box grown(int pixels, int max_width, int max_height) const;
};

/// A piece of exact contour, in pixels: (x, y) is the centre of pixel (x, y). What lies on its left and right are
/// labels or, in Islands, islands (-1: one that the raster does not show).
struct BorderPiece {
  double ax = 0, ay = 0, bx = 0, by = 0;
  std::int32_t left = 0, right = 0;
};

/// A slice, cropped; labels as indices.
struct Pixels {
  int width = 0, height = 0;
  std::vector<std::uint16_t> label;
  std::vector<BorderPiece> border;  ///< the contours that the raster stands for; none: they are the pixel cracks
};

/// The 4-connected islands of equal label of a slice.
struct Islands {
  std::vector<std::int32_t> of;      ///< per pixel; 0 is background
  std::vector<std::uint16_t> label;  ///< per island; [0] is background
  std::vector<Box> box;              ///< per island
  std::vector<BorderPiece> border;   ///< exact contours between islands, if known
  int count() const { return static_cast<int>(label.size()); }
};
Islands find_islands(const Pixels& slice);

/// The islands of two neighbouring slices, grouped by label and overlap: the 6-connected parts of the slab.
struct Group {
  std::uint16_t label = 0;
  Box low, high;  ///< of its islands in either slice; empty if it has none there
  std::vector<std::int32_t> before,
      after;  ///< islands of the slices below and above the slab that go on from it
};
struct Groups {
  std::vector<Group> list;                    ///< [0] is background
  std::vector<std::int32_t> of_low, of_high;  ///< group of an island
};
/// `before` and `after` may be null (the stack ends).
Groups group_islands(const Islands& low, const Islands& high, const Islands* before, const Islands* after);

}  // namespace stackmesh::interpolate
