#include "model/slices.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"

namespace stackmesh {
namespace {

constexpr int kTile = 32;  // voxels in a cache line

std::array<std::size_t, 3> strides(const LabelVolume& volume) {
  return {1, static_cast<std::size_t>(volume.size[0]), static_cast<std::size_t>(volume.size[0]) * volume.size[1]};
}

}  // namespace

StackAxes axes_for(int stacking_axis) {
  return {(stacking_axis + 1) % 3, (stacking_axis + 2) % 3, stacking_axis};
}

std::vector<Slice> read_slices(const LabelVolume& volume, const StackAxes& axes, int first, int last) {
  const std::array<std::size_t, 3> stride = strides(volume);
  const std::size_t su = stride[axes.u], sv = stride[axes.v], sw = stride[axes.w];
  std::vector<Slice> slices(static_cast<std::size_t>(last - first));
  for (Slice& slice : slices) {
    slice.width = volume.size[axes.u];
    slice.height = volume.size[axes.v];
    slice.pixels.resize(static_cast<std::size_t>(slice.width) * slice.height);
  }
  const std::uint16_t* from = volume.voxels.data() + static_cast<std::size_t>(first) * sw;
  if (axes.w == 2) {
    for (std::size_t k = 0; k < slices.size(); ++k)
      std::copy_n(from + k * sw, slices[k].pixels.size(), slices[k].pixels.begin());
    return slices;
  }
  // In tiles, so that a cache line is used up before it is dropped: it runs along the slices (axis x) or
  // along in-plane y (axis y).
  const int width = volume.size[axes.u], height = volume.size[axes.v], tall = axes.w == 0 ? 1 : kTile;
  for (int y0 = 0; y0 < height; y0 += tall)
    for (int x0 = 0; x0 < width; x0 += kTile) {
      const int y1 = std::min(height, y0 + tall), x1 = std::min(width, x0 + kTile);
      for (std::size_t k = 0; k < slices.size(); ++k)
        for (int y = y0; y < y1; ++y) {
          const std::uint16_t* source = from + k * sw + y * sv;
          std::uint16_t* row = &slices[k].pixels[static_cast<std::size_t>(y) * width];
          for (int x = x0; x < x1; ++x) row[x] = source[x * su];
        }
    }
  return slices;
}

int slices_at_once(const LabelVolume& volume, const StackAxes& axes, int threads) {
  return std::clamp(volume.size[axes.w] / (4 * thread_count(threads)), 1, axes.w == 0 ? kTile : 8);
}

}  // namespace stackmesh
