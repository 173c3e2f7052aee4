#include "sections/extract.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/parallel.h"
#include "model/slices.h"
#include "sections/arcs.h"
#include "sections/components.h"
#include "sections/section_edges.h"

namespace stackmesh {
namespace {

std::vector<Label> labels_in(const Slice& slice, const LabelVolume& volume) {
  std::set<std::uint16_t> seen(slice.pixels.begin(), slice.pixels.end());
  std::vector<Label> out;
  for (std::uint16_t s : seen)
    if (s != 0) out.push_back(volume.labels[s].number);
  return out;
}

Section make_section(const SliceArcs& traced, const LabelVolume& volume, double simplify_px, double longest_px,
                     bool free, bool middles, double z_mm) {
  std::vector<std::vector<GridPoint>> kept =
      free ? simplify_free_arcs(traced.arcs, simplify_px * kGridPerPixel, longest_px)
           : simplify_arcs(traced.arcs, simplify_px, longest_px);
  if (middles) {
    // An edge from junction to junction has no vertex that could leave the section's plane: a label above and below it
    // would touch itself.
    for (auto& arc : kept)
      if (arc.size() == 2 && arc[0] != arc[1] && (arc[0].x + arc[1].x) % 2 == 0 && (arc[0].y + arc[1].y) % 2 == 0)
        arc.insert(arc.begin() + 1, {(arc[0].x + arc[1].x) / 2, (arc[0].y + arc[1].y) / 2});
  }
  Section section;
  section.z_mm = z_mm;
  SectionEdges edges(section);
  for (std::size_t a = 0; a < traced.arcs.size(); ++a)
    edges.add(kept[a], volume.labels[traced.arcs[a].left].number, volume.labels[traced.arcs[a].right].number);
  return section;
}

}  // namespace

int stacking_axis(const LabelVolume& volume, StackAxis axis) {
  if (axis != StackAxis::automatic) return static_cast<int>(axis) - 1;
  const auto coarsest = [&](auto usable) {
    int best = -1;
    for (int a : {2, 1, 0})
      if (usable(a) && (best < 0 || volume.spacing_mm[a] > 1.01 * volume.spacing_mm[best])) best = a;
    return best;
  };
  const int best = coarsest([](int) { return true; });
  // A slab of one slice is a stack along another axis; a picture, or a slice of cubes, is refused as what it is.
  const bool is_slab =
      volume.size[best] == 1 && volume.kind != "slices" &&
      *std::min_element(volume.spacing_mm.begin(), volume.spacing_mm.end()) * 1.01 < volume.spacing_mm[best];
  const int other = is_slab ? coarsest([&](int a) { return volume.size[a] > 1; }) : -1;
  return other >= 0 ? other : best;
}

ContourResult extract_sections(const LabelVolume& volume, const ContourOptions& options, Monitor& progress,
                               const FairedLabels* faired) {
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
  const int period = options.virtual_per_gap + 1;
  stack.end_gap_mm = period * volume.spacing_mm[axes.w];
  // Stack coordinates start at the outer corner of the first pixel, in the first slice's plane.
  std::array<double, 3> corner = {0, 0, 0};
  corner[axes.u] = corner[axes.v] = -0.5;
  stack.frame.origin = volume.world(corner[0], corner[1], corner[2]);
  stack.frame.axes = {volume.axes[axes.u], volume.axes[axes.v], volume.axes[axes.w]};
  stack.frame.world = volume.space();

  const int step = slices_at_once(volume, axes, options.threads);
  const VoxelComponents components(volume, axes);

  stack.sections.resize(count);
  std::vector<std::size_t> loops(count, 0), traced_vertices(count, 0);
  std::atomic<int> done{0};
  const auto extract = [&](const Slice& slice, int k, const Slice* below, const Slice* above) {
    CornerRules rules;
    rules.same_component = [&](int xa, int ya, int xb, int yb) {
      return components.of(xa, ya, k) == components.of(xb, yb, k);
    };
    if (faired != nullptr) rules.faired = &faired->slices[k];
    if (options.simplify_px > 0 || faired != nullptr) {
      rules.part = true;
      if (below != nullptr) touching_corners(components, slice, k, *below, k - 1, rules.keep);
      if (above != nullptr) touching_corners(components, slice, k, *above, k + 1, rules.keep);
      unite(rules.keep);
    }
    // Where pieces of a label touch across slices, contours that leave their pixels could join them.
    const bool free = faired != nullptr && faired->free[k] && rules.keep.empty();
    rules.hold = !free;
    SliceArcs traced = trace_arcs(slice, rules);
    if (free) untangle(traced.arcs);
    stack.sections[k] = make_section(traced, volume, options.simplify_px, faired != nullptr ? options.longest_px : 0,
                                     free, faired != nullptr, k * volume.spacing_mm[axes.w]);
    stack.sections[k].interpolated = k % period != 0;
    loops[k] = traced.loops;
    for (const Arc& arc : traced.arcs) traced_vertices[k] += arc.chain.size() - 1;
    if (k == 0 && !volume.goes_on_low[axes.w]) stack.touches_low = labels_in(slice, volume);
    if (k == count - 1 && !volume.goes_on_high[axes.w]) stack.touches_high = labels_in(slice, volume);
    progress.advance(static_cast<double>(++done) / count);
  };
  parallel_for((count + step - 1) / step, options.threads, [&](std::size_t block) {
    const int first = static_cast<int>(block) * step, last = std::min(count, first + step);
    const int begin = std::max(0, first - 1), end = std::min(count, last + 1);  // with a neighbour on either side
    const std::vector<Slice> slices = read_slices(volume, axes, begin, end);
    for (int k = first; k < last; ++k)
      extract(slices[k - begin], k, k > begin ? &slices[k - begin - 1] : nullptr,
              k + 1 < end ? &slices[k - begin + 1] : nullptr);
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
