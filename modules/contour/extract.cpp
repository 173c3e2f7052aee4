#include "contour/extract.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>
#include <unordered_map>

#include "base/error.h"
#include "base/parallel.h"
#include "contour/arcs.h"
#include "contour/components.h"

namespace stackmesh {
namespace {

/// The volume's axes as the stack has them: in-plane x, in-plane y, stacking axis; always a cyclic permutation.
struct StackAxes {
  int u, v, w;
};

StackAxes axes_for(int axis) { return {(axis + 1) % 3, (axis + 2) % 3, axis}; }

Slice slice_of(const LabelVolume& volume, const StackAxes& axes, int k) {
  const std::array<std::size_t, 3> stride = {1, static_cast<std::size_t>(volume.size[0]),
                                             static_cast<std::size_t>(volume.size[0]) * volume.size[1]};
  Slice slice;
  slice.width = volume.size[axes.u];
  slice.height = volume.size[axes.v];
  slice.pixels.resize(static_cast<std::size_t>(slice.width) * slice.height);
  const std::uint16_t* from = volume.voxels.data() + static_cast<std::size_t>(k) * stride[axes.w];
  if (axes.w == 2) {
    std::copy(from, from + slice.pixels.size(), slice.pixels.begin());
    return slice;
  }
  for (int y = 0; y < slice.height; ++y)
    for (int x = 0; x < slice.width; ++x)
      slice.pixels[static_cast<std::size_t>(y) * slice.width + x] = from[x * stride[axes.u] + y * stride[axes.v]];
  return slice;
}

std::vector<Label> labels_in(const Slice& slice, const LabelVolume& volume) {
  std::set<std::uint16_t> seen(slice.pixels.begin(), slice.pixels.end());
  std::vector<Label> out;
  for (std::uint16_t s : seen)
    if (s != 0) out.push_back(volume.labels[s].number);
  return out;
}

Section make_section(const SliceArcs& traced, const LabelVolume& volume, double simplify_px, double z_mm) {
  const std::vector<std::vector<GridPoint>> kept = simplify_arcs(traced.arcs, simplify_px);
  Section section;
  section.z_mm = z_mm;
  std::unordered_map<std::uint64_t, std::int32_t> ids;
  const auto id_of = [&](GridPoint p) {
    const std::uint64_t key = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(p.x)) << 32) | static_cast<std::uint32_t>(p.y);
    const auto [it, fresh] = ids.emplace(key, static_cast<std::int32_t>(section.points.size()));
    if (fresh) section.points.push_back(p);
    return it->second;
  };
  for (std::size_t a = 0; a < traced.arcs.size(); ++a) {
    const Label left = volume.labels[traced.arcs[a].left].number, right = volume.labels[traced.arcs[a].right].number;
    for (std::size_t i = 0; i + 1 < kept[a].size(); ++i)
      section.edges.push_back({id_of(kept[a][i]), id_of(kept[a][i + 1]), left, right});
  }
  return section;
}

}  // namespace

int stacking_axis(const LabelVolume& volume, StackAxis axis) {
  if (axis != StackAxis::automatic) return static_cast<int>(axis) - 1;
  int best = 2;
  for (int a : {1, 0})
    if (volume.spacing_mm[a] > 1.01 * volume.spacing_mm[best]) best = a;
  return best;
}

ContourResult extract_sections(const LabelVolume& volume, const ContourOptions& options, Progress& progress) {
  ContourResult result;
  result.axis = stacking_axis(volume, options.axis);
  const StackAxes axes = axes_for(result.axis);
  const int count = volume.size[axes.w];
  if (count < 2)
    fail_input("only one slice along the stacking axis", std::string("axis ") + "xyz"[result.axis],
               "give a stack of at least two slices, or choose another --axis");
  Stack& stack = result.stack;
  stack.labels = volume.labels;
  stack.grid_x_mm = volume.spacing_mm[axes.u] / kGridPerPixel;
  stack.grid_y_mm = volume.spacing_mm[axes.v] / kGridPerPixel;
  stack.pixel_mm = std::min(volume.spacing_mm[axes.u], volume.spacing_mm[axes.v]);
  // Stack coordinates start at the outer corner of the first pixel, in the first slice's plane.
  std::array<double, 3> corner = {0, 0, 0};
  corner[axes.u] = corner[axes.v] = -0.5;
  stack.frame.origin = volume.world(corner[0], corner[1], corner[2]);
  stack.frame.axes = {volume.axes[axes.u], volume.axes[axes.v], volume.axes[axes.w]};

  std::atomic<bool> touching{false};
  parallel_for(count, options.threads, [&](std::size_t k) {
    if (!touching && has_touching_labels(slice_of(volume, axes, static_cast<int>(k)))) touching = true;
  });
  VoxelComponents components;
  if (touching)
    for (int k = 0; k < count; ++k) components.add(slice_of(volume, axes, k));

  stack.sections.resize(count);
  std::vector<std::size_t> loops(count, 0), traced_vertices(count, 0);
  std::atomic<int> done{0};
  parallel_for(count, options.threads, [&](std::size_t i) {
    const int k = static_cast<int>(i);
    const Slice slice = slice_of(volume, axes, k);
    const SameComponent same = [&](int xa, int ya, int xb, int yb) { return components.of(xa, ya, k) == components.of(xb, yb, k); };
    const SliceArcs traced = trace_arcs(slice, same, options.simplify_px > 0);
    stack.sections[k] = make_section(traced, volume, options.simplify_px, k * volume.spacing_mm[axes.w]);
    loops[k] = traced.loops;
    for (const Arc& arc : traced.arcs) traced_vertices[k] += arc.chain.size() - 1;
    if (k == 0) stack.touches_low = labels_in(slice, volume);
    if (k == count - 1) stack.touches_high = labels_in(slice, volume);
    progress.advance(static_cast<double>(++done) / count);
  });
  for (int k = 0; k < count; ++k) {
    result.loops += loops[k];
    result.vertices_traced += traced_vertices[k];
    result.vertices += stack.sections[k].points.size();
  }
  if (result.loops == 0) fail_input("no non-zero label in the volume", "", "check the input or --label");
  return result;
}

}  // namespace stackmesh
