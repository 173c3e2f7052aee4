#pragma once
#include <cstdint>
#include <cstring>
#include <vector>

#include "model/label_volume.h"

namespace stackmesh {

/// A slice of palette indices, rows along y.
struct Slice {
  int width = 0;                      ///< pixels along x
  int height = 0;                     ///< pixels along y
  std::vector<std::uint16_t> pixels;  ///< width * height indices of LabelVolume::labels, x fastest
  /// The index of a pixel; outside of the slice the background.
  std::uint16_t at(int x, int y) const {
    return x < 0 || y < 0 || x >= width || y >= height ? 0 : pixels[static_cast<std::size_t>(y) * width + x];
  }
};

/// The volume's axes as the stack has them: in-plane x, in-plane y, stacking axis; always a cyclic
/// permutation.
struct StackAxes {
  int u;  ///< in-plane x: 0, 1, 2 for x, y, z of the volume
  int v;  ///< in-plane y
  int w;  ///< stacking axis
};
StackAxes axes_for(int stacking_axis);

/// The slices [first, last) along the stacking axis.
std::vector<Slice> read_slices(const LabelVolume& volume, const StackAxes& axes, int first, int last);

/// How many slices are best read at once: along x, neighbours share cache lines; each is needed by its
/// neighbours.
int slices_at_once(const LabelVolume& volume, const StackAxes& axes, int threads);

/// Four pixels as one number, to compare or skip at once.
inline std::uint64_t four_pixels(const std::uint16_t* pixels) {
  std::uint64_t four;
  std::memcpy(&four, pixels, sizeof four);
  return four;
}

/// The end of the run of equal pixels of a row that begins at x.
inline int run_end(const std::uint16_t* row, int x, int width) {
  const std::uint16_t label = row[x];
  const std::uint64_t four = label * std::uint64_t{0x0001000100010001};
  while (x + 4 <= width && four_pixels(row + x) == four) x += 4;
  while (x < width && row[x] == label) ++x;
  return x;
}

}  // namespace stackmesh
