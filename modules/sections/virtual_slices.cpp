#include "sections/virtual_slices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "sections/fill_gap.h"

namespace stackmesh {
namespace {

using interpolate::Box;
using interpolate::Gap;
using interpolate::GapLayers;
using interpolate::Pixels;

constexpr int kMostPerGap = 1000;

/// The volume's slices along an axis, whatever the axis.
struct SliceView {
  int width, height, count;
  std::size_t step_x, step_y, step_slice;  // in voxels

  SliceView(const LabelVolume& volume, int axis) {
    const std::array<std::size_t, 3> step = {1, static_cast<std::size_t>(volume.size[0]),
                                             static_cast<std::size_t>(volume.size[0]) * volume.size[1]};
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    width = volume.size[u];
    height = volume.size[v];
    count = volume.size[axis];
    step_x = step[u];
    step_y = step[v];
    step_slice = step[axis];
  }
  std::size_t at(int x, int y, int slice) const { return x * step_x + y * step_y + slice * step_slice; }
};

Box tissue_box(const LabelVolume& volume, const SliceView& view, int slice) {
  Box box;
  for (int y = 0; y < view.height; ++y) {
    int first = 0, last = view.width;
    while (first < last && volume.voxels[view.at(first, y, slice)] == 0) ++first;
    while (first < last && volume.voxels[view.at(last - 1, y, slice)] == 0) --last;
    box.add({first, y, last, y + 1});
  }
  return box;
}

Pixels crop(const LabelVolume& volume, const SliceView& view, int slice, const Box& box) {
  Pixels pixels;
  pixels.width = box.width();
  pixels.height = box.height();
  pixels.label.reserve(box.area());
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x) pixels.label.push_back(volume.voxels[view.at(x, y, slice)]);
  return pixels;
}

int automatic_per_gap(double gap_mm, double pixel_mm) {
  const double ratio = gap_mm / pixel_mm;
  if (!(ratio > 1.5)) return 0;
  return static_cast<int>(std::min<double>(kMostPerGap, std::max(1.0, std::round(ratio) - 1)));
}

}  // namespace

int virtual_slices_per_gap(const LabelVolume& volume, int axis, const InterpolateOptions& options) {
  if (axis < 0 || axis > 2) fail_usage("no such stacking axis", std::to_string(axis), "give 0, 1 or 2");
  const double pixel_mm = std::min(volume.spacing_mm[(axis + 1) % 3], volume.spacing_mm[(axis + 2) % 3]);
  const int per_gap = options.per_gap ? *options.per_gap : automatic_per_gap(volume.spacing_mm[axis], pixel_mm);
  if (per_gap < 0 || per_gap > kMostPerGap)
    fail_usage("the number of virtual sections is not between 0 and " + std::to_string(kMostPerGap),
               std::to_string(per_gap), "give a smaller number, or none for the automatic choice");
  return volume.size[axis] < 2 ? 0 : per_gap;
}

InterpolatedVolume add_virtual_slices(const LabelVolume& volume, int axis, const InterpolateOptions& options) {
  if (!(options.tension >= 0 && options.tension <= 1))
    fail_usage("the tension of the spline is not between 0 and 1", std::to_string(options.tension), "leave it at 0.25");
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const std::array<double, 2> pixel_mm = {volume.spacing_mm[u], volume.spacing_mm[v]};
  InterpolatedVolume result;
  result.per_gap = virtual_slices_per_gap(volume, axis, options);
  const SliceView from(volume, axis);
  if (result.per_gap == 0) {
    result.volume = volume;
    return result;
  }
  const int stride = result.per_gap + 1;
  LabelVolume& out = result.volume = without_voxels(volume);
  out.size[axis] = (from.count - 1) * stride + 1;
  out.spacing_mm[axis] /= stride;
  out.voxels.assign(static_cast<std::size_t>(out.size[0]) * out.size[1] * out.size[2], 0);
  const SliceView to(out, axis);

  std::vector<Box> boxes(from.count);
  parallel_for(from.count, options.threads, [&](std::size_t k) {
    const int slice = static_cast<int>(k);
    boxes[k] = tissue_box(volume, from, slice);
    for (int y = boxes[k].y0; y < boxes[k].y1; ++y)
      for (int x = boxes[k].x0; x < boxes[k].x1; ++x)
        out.voxels[to.at(x, y, slice * stride)] = volume.voxels[from.at(x, y, slice)];
  });
  parallel_for(from.count - 1, options.threads, [&](std::size_t k) {
    const int first = std::max(0, static_cast<int>(k) - 1), last = std::min(from.count - 1, static_cast<int>(k) + 2);
    Box box = boxes[k];
    box.add(boxes[k + 1]);
    if (box.empty()) return;
    for (int s = first; s <= last; ++s) box.add(boxes[s]);
    box = box.grown(4, from.width, from.height);
    std::array<Pixels, 4> slices;
    for (int s = first; s <= last; ++s) slices[s + 1 - static_cast<int>(k)] = crop(volume, from, s, box);
    Gap gap;
    gap.gap_mm = volume.spacing_mm[axis];
    gap.low = &slices[1];
    gap.high = &slices[2];
    if (k > 0) gap.before = &slices[0];
    if (static_cast<int>(k) + 2 < from.count) gap.after = &slices[3];
    const GapLayers layers = interpolate::fill_gap(gap, result.per_gap, options.tension, pixel_mm);
    for (int j = 1; j <= result.per_gap; ++j) {
      const std::int32_t* group = layers.group[j].data();
      for (int y = box.y0; y < box.y1; ++y)
        for (int x = box.x0; x < box.x1; ++x, ++group)
          if (*group != 0) out.voxels[to.at(x, y, static_cast<int>(k) * stride + j)] = layers.label[*group];
    }
  });
  return result;
}

}  // namespace stackmesh
