#include "stitch/stitch.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/parallel.h"
#include "planar/snap_rounding.h"
#include "stitch/merge_tolerance.h"
#include "stitch/slab.h"

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
  StackStitcher(Stack& stack, const StitchOptions& options, Monitor& progress)
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
      ends_[label] = extent;
      if (caps_of(label, false) == Caps::flat) flat_downward_.insert(label);
      if (caps_of(label, true) == Caps::flat) flat_upward_.insert(label);
    }
  }

  Caps caps_of(Label label, bool high) const {
    const auto it = options_.label_caps.find(label);
    return it == options_.label_caps.end() ? options_.caps : high ? it->second.high : it->second.low;
  }

  /// Null for labels of a volume.
  const DrawnEnd* drawn_end(Label label, bool high) const {
    for (const DrawnEnds& e : stack_.drawn_ends)
      if (e.label == label) return high ? &e.high : &e.low;
    return nullptr;
  }

  bool is_flat(Label label, const Extent& extent, bool high) const {
    const Caps caps = caps_of(label, high);
    if (caps != Caps::automatic) return caps == Caps::flat;
    if (const DrawnEnd* drawn = drawn_end(label, high)) return drawn->area_rel >= options_.flat_area_rel;
    const std::size_t end = high ? extent.last : extent.first;
    const auto& border = high ? stack_.touches_high : stack_.touches_low;
    if (end == (high ? sections() - 1 : 0) && std::find(border.begin(), border.end(), label) != border.end())
      return true;
    if (extent.first == extent.last) return false;
    // By real sections: those between them are interpolated, and shrink before an end.
    const auto towards_inside = [&](std::size_t i) {
      const std::size_t other_end = high ? extent.first : extent.last;
      do {
        if (i == other_end) return i;
        high ? --i : ++i;
      } while (stack_.sections[i].interpolated);
      return i;
    };
    const std::size_t last = stack_.sections[end].interpolated ? towards_inside(end) : end,
                      beside = towards_inside(last);
    if (last == beside || stack_.sections[beside].interpolated) return false;     // one real section
    const double here = enclosed_area_mm2(stack_, stack_.sections[last], label);  // a wall ends as what lies in it does
    return here >= options_.flat_area_rel * enclosed_area_mm2(stack_, stack_.sections[beside], label);
  }

  /// The shapes of the ends that may occur between section k - 1 and section k (k == 0, sections(): beyond the stack).
  void set_ends(SlabInput& slab, std::size_t k) const {
    const bool beyond = k == 0 || k == sections();
    const EndShape plane = beyond && !stack_.slices ? EndShape::on_plane : EndShape::flat;
    for (bool up : {true, false}) {
      std::map<Label, SlabEnd> ends;
      for (Label l : up ? flat_upward_ : flat_downward_) ends[l] = {l, plane, 1};
      // holes end flat too
      if (options_.caps == Caps::flat && options_.label_caps.count(0) == 0) ends[0] = {0, plane, 1};
      for (const auto& [l, extent] : ends_) {
        if (up ? extent.last + 1 != k : extent.first != k) continue;
        const auto& flat = up ? flat_high_ : flat_low_;
        const DrawnEnd* drawn = drawn_end(l, up);
        if (std::find(flat.begin(), flat.end(), std::make_pair(l, up ? extent.last : extent.first)) != flat.end())
          ends[l] = {l, drawn != nullptr && drawn->on_section ? EndShape::on_plane : plane, 1};
        else if (drawn != nullptr && drawn->half_gap_mm > 0)
          ends[l] = {l, EndShape::round, round_scale(*drawn, slab, up)};
      }
      for (const auto& [l, end] : ends) (up ? slab.upward_ends : slab.downward_ends).push_back(end);
    }
  }

  /// How high a round end is in this slab, against one that stands for the whole slab.
  double round_scale(const DrawnEnd& end, const SlabInput& slab, bool up) const {
    const double peak = (stack_.slices ? 1.5 : 1.0) * end.half_gap_mm;  // above its last contour
    const double tip = end.contour_mm + (up ? peak : -peak);
    const double rise = (up ? tip - slab.z_low_mm : slab.z_high_mm - tip) / (slab.z_high_mm - slab.z_low_mm);
    return std::clamp(rise / (stack_.slices ? 0.75 : 0.5), 0.05, 1.25);
  }

  /// How far the slab beyond the first or last section reaches: for the label with the widest gap that ends there.
  double reach_beyond(bool high) const {
    double reach = 0;
    for (const auto& [l, extent] : ends_) {
      if (high ? extent.last + 1 != sections() : extent.first != 0) continue;
      const DrawnEnd* drawn = drawn_end(l, high);
      if (drawn == nullptr || !(drawn->half_gap_mm > 0)) return 2 * end_half_gap_mm(stack_, high);
      reach = std::max(reach, 2 * drawn->half_gap_mm);
    }
    return reach > 0 ? reach : 2 * end_half_gap_mm(stack_, high);
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
      slab.z_low_mm = k == 0 ? stack_.sections[0].z_mm - reach_beyond(false) : slab.lower->z_mm;
      slab.z_high_mm = k == n ? stack_.sections[n - 1].z_mm + reach_beyond(true) : slab.upper->z_mm;
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
    if (slab_base[n + 1] > 0x7fffffff)
      throw Error(ErrorKind::no_result, "more than 2^31 points", "stitching", "simplify the contours");
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
          const std::size_t id = v < lower           ? section_base[k - 1] + v
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
    const double to_mm_x = stack_.grid_x_mm / scale_x_,
                 to_mm_y = stack_.grid_x_mm * (stack_.grid_y_mm / stack_.grid_x_mm / scale_y_);
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
  Monitor& progress_;
  StitchResult result_;
  const Section empty_;
  std::vector<std::pair<Label, std::size_t>> flat_low_, flat_high_;  // label, its first or last section
  std::set<Label> flat_downward_, flat_upward_;                      // whatever ends there: requested
  std::map<Label, Extent> ends_;
  std::vector<SlabSurface> slabs_;
  double scale_x_ = 1, scale_y_ = 1;
};

}  // namespace

StitchResult stitch_sections(Stack stack, const StitchOptions& options, Monitor& progress) {
  StitchResult result = StackStitcher(stack, options, progress).run();
  result.stack = std::move(stack);
  return result;
}

}  // namespace stackmesh
