#include "stitch/stitch.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/parallel.h"
#include "stitch/merge_tolerance.h"
#include "stitch/slab.h"
#include "stitch/snap_rounding.h"

namespace stackmesh {
namespace {

/// x with its mantissa cut to 20 bits: times a grid coordinate (29 bits) it is exact.
double short_mantissa(double x) {
  int exponent = 0;
  const double m = std::frexp(x, &exponent);
  return std::ldexp(std::round(std::ldexp(m, 20)), exponent - 20);
}

/// First and last section of every label, with its areas at and beside either end.
struct Extent {
  std::size_t first = 0, last = 0;
};

class StackStitcher {
 public:
  StackStitcher(Stack& stack, const StitchOptions& options, Progress& progress)
      : stack_(stack), options_(options), progress_(progress) {}

  StitchResult run() {
    result_.snap_used_mm = merge_close_contours(stack_, options_.snap_mm, options_.threads, result_.warnings);
    const SnapRoundingReport rounding = snap_round(stack_, options_.threads);
    result_.warnings.insert(result_.warnings.end(), rounding.warnings.begin(), rounding.warnings.end());
    choose_caps();
    stitch_slabs();
    assemble();
    return std::move(result_);
  }

 private:
  std::size_t sections() const { return stack_.sections.size(); }

  void choose_caps() {
    std::map<Label, Extent> extents;
    for (std::size_t i = 0; i < sections(); ++i) {
      std::set<Label> here;
      for (const SectionEdge& e : stack_.sections[i].edges) {
        here.insert(e.left);
        here.insert(e.right);
      }
      here.erase(0);
      for (Label l : here) extents.insert({l, {i, i}}).first->second.last = i;
    }
    if (extents.empty())
      throw Error(ErrorKind::no_result, "the sections hold no label", "", "choose labels that the input has");
    for (const auto& [label, extent] : extents) {
      const bool low = is_flat(label, extent, false), high = is_flat(label, extent, true);
      result_.caps[label] = {low ? "flat" : "round", high ? "flat" : "round"};
      if (low) flat_low_.push_back({label, extent.first});
      if (high) flat_high_.push_back({label, extent.last});
      if (caps_of(label) == Caps::flat) always_flat_.insert(label);
    }
  }

  Caps caps_of(Label label) const {
    const auto it = options_.label_caps.find(label);
    return it == options_.label_caps.end() ? options_.caps : it->second;
  }

  bool is_flat(Label label, const Extent& extent, bool high) const {
    const Caps caps = caps_of(label);
    if (caps != Caps::automatic) return caps == Caps::flat;
    const std::size_t end = high ? extent.last : extent.first;
    const auto& border = high ? stack_.touches_high : stack_.touches_low;
    if (end == (high ? sections() - 1 : 0) && std::find(border.begin(), border.end(), label) != border.end()) return true;
    if (extent.first == extent.last) return false;
    std::size_t beside = high ? end - 1 : end + 1;  // the next real section
    while (stack_.sections[beside].interpolated && beside > 0 && beside + 1 < sections()) high ? --beside : ++beside;
    const double here = label_area_mm2(stack_, stack_.sections[end], label);
    return here >= options_.flat_area_rel * label_area_mm2(stack_, stack_.sections[beside], label);
  }

  /// The shapes of the ends that may occur between section k - 1 and section k (k == 0, sections(): beyond the stack).
  void set_ends(SlabInput& slab, std::size_t k) const {
    const bool beyond = k == 0 || k == sections();
    const EndShape plane = beyond && !stack_.slices ? EndShape::on_plane : EndShape::flat;
    std::set<Label> up = always_flat_, down = always_flat_;
    if (options_.caps == Caps::flat && options_.label_caps.count(0) == 0) {  // holes end flat too
      up.insert(0);
      down.insert(0);
    }
    for (const auto& f : flat_high_)
      if (f.second + 1 == k) up.insert(f.first);
    for (const auto& f : flat_low_)
      if (f.second == k) down.insert(f.first);
    for (Label l : up) slab.upward_ends.emplace_back(l, plane);
    for (Label l : down) slab.downward_ends.emplace_back(l, plane);
  }

  /// One slab between every two sections, and one to an empty section beyond either end.
  void stitch_slabs() {
    const std::size_t n = sections();
    slabs_.resize(n + 1);
    scale_x_ = 1;
    scale_y_ = short_mantissa(stack_.grid_y_mm / stack_.grid_x_mm);
    std::atomic<std::size_t> done{0};
    parallel_for(n + 1, options_.threads, [&](std::size_t k) {
      SlabInput slab;
      slab.lower = k == 0 ? &empty_ : &stack_.sections[k - 1];
      slab.upper = k == n ? &empty_ : &stack_.sections[k];
      slab.z_low_mm = k == 0 ? stack_.sections[0].z_mm - 2 * end_half_gap_mm(stack_, false) : slab.lower->z_mm;
      slab.z_high_mm = k == n ? stack_.sections[n - 1].z_mm + 2 * end_half_gap_mm(stack_, true) : slab.upper->z_mm;
      slab.scale_x = scale_x_;
      slab.scale_y = scale_y_;
      // A slice stands for half a gap; of a plane cut no more is known than that a dome of half a gap is likely.
      slab.round_holds_rel = stack_.slices ? 0.5 : 1.0 / 3;
      set_ends(slab, k);
      slabs_[k] = stitch_slab(slab);
      progress_.advance(static_cast<double>(++done) / static_cast<double>(n + 1));
    });
  }

  /// Numbers the points: sections in order, then the slabs' own; unused ones are left out.
  void assemble() {
    const std::size_t n = sections();
    std::vector<std::size_t> section_base(n + 1, 0), slab_base(n + 2, 0);
    for (std::size_t i = 0; i < n; ++i) section_base[i + 1] = section_base[i] + stack_.sections[i].points.size();
    slab_base[0] = section_base[n];
    std::size_t triangles = 0;
    for (std::size_t k = 0; k <= n; ++k) {
      slab_base[k + 1] = slab_base[k] + slabs_[k].points.size();
      triangles += slabs_[k].triangles.size();
      result_.added_points += slabs_[k].added_points;
    }
    if (slab_base[n + 1] > 0x7fffffff) throw Error(ErrorKind::no_result, "more than 2^31 points", "stitching", "simplify the contours");
    InterfaceComplex& complex = result_.complex;
    complex.triangles.reserve(triangles);
    std::vector<std::int32_t> used(slab_base[n + 1], 0);
    for (std::size_t k = 0; k <= n; ++k) {
      const std::size_t lower = k == 0 ? 0 : stack_.sections[k - 1].points.size();
      const std::size_t upper = k == n ? 0 : stack_.sections[k].points.size();
      for (const SlabSurface::Triangle& t : slabs_[k].triangles) {
        InterfaceTriangle out;
        out.below = t.below;
        out.above = t.above;
        for (int i = 0; i < 3; ++i) {
          const std::size_t v = t.v[i];
          const std::size_t id = v < lower ? section_base[k - 1] + v
                                 : v < lower + upper ? section_base[k] + (v - lower)
                                                     : slab_base[k] + (v - lower - upper);
          out.v[i] = static_cast<std::int32_t>(id);
          used[id] = 1;
        }
        complex.triangles.push_back(out);
      }
    }
    std::int32_t count = 0;
    for (std::int32_t& u : used) u = u ? count++ : -1;
    complex.points.reserve(count);
    // In the plane all points go through one monotone map, so nothing changes sides.
    const double to_mm_x = stack_.grid_x_mm / scale_x_, to_mm_y = stack_.grid_x_mm * (stack_.grid_y_mm / stack_.grid_x_mm / scale_y_);
    const auto add = [&](std::size_t id, double x, double y, double z) {
      if (used[id] >= 0) complex.points.push_back({x * to_mm_x, y * to_mm_y, z});
    };
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t v = 0; v < stack_.sections[i].points.size(); ++v) {
        const GridPoint p = stack_.sections[i].points[v];
        add(section_base[i] + v, p.x * scale_x_, p.y * scale_y_, stack_.sections[i].z_mm);
      }
    for (std::size_t k = 0; k <= n; ++k)
      for (std::size_t v = 0; v < slabs_[k].points.size(); ++v) {
        const SlabSurface::Point& p = slabs_[k].points[v];
        add(slab_base[k] + v, p.x, p.y, p.z);
      }
    for (InterfaceTriangle& t : complex.triangles)
      for (std::int32_t& v : t.v) v = used[v];
  }

  Stack& stack_;
  const StitchOptions& options_;
  Progress& progress_;
  StitchResult result_;
  const Section empty_;
  std::vector<std::pair<Label, std::size_t>> flat_low_, flat_high_;  // label, its first or last section
  std::set<Label> always_flat_;
  std::vector<SlabSurface> slabs_;
  double scale_x_ = 1, scale_y_ = 1;
};

}  // namespace

StitchResult stitch_sections(Stack& stack, const StitchOptions& options, Progress& progress) {
  return StackStitcher(stack, options, progress).run();
}

}  // namespace stackmesh
