#include "sections/virtual_layers.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "sections/nested_gap.h"
#include "sections/section_raster.h"

namespace stackmesh {
namespace {

using namespace interpolate;

constexpr int kMostPerGap = 1000;
constexpr int kMostForNesting = 63, kMostBeyond = 31;
constexpr int kMargin = 6;                          // pixels round the contours
constexpr float kNearest = 0.1f, kFurthest = 0.9f;  // a border keeps this far from pixel centres

struct Extent {
  std::int32_t x0 = 0, y0 = 0, x1 = -1, y1 = -1;
  bool empty() const { return x1 < x0; }
  void add(GridPoint p) {
    if (empty()) *this = {p.x, p.y, p.x, p.y};
    x0 = std::min(x0, p.x);
    y0 = std::min(y0, p.y);
    x1 = std::max(x1, p.x);
    y1 = std::max(y1, p.y);
  }
};

class LayerMaker {
 public:
  LayerMaker(const Stack& stack, const VirtualLayerOptions& options) : stack_(stack), o_(options) {
    std::uint16_t next = 0;
    for (const LabelInfo& l : stack.labels) index_of_[l.number] = next++;
  }

  /// Gap k lies beneath section k; 0 and the number of sections are those beyond the stack. @return how much of it is
  /// open
  double gap(std::size_t k, const std::function<void(std::size_t, const LabelLayer&)>& take) const {
    const std::size_t n = stack_.sections.size();
    const bool beyond = k == 0 || k == n;
    int count = beyond ? o_.end_layers : o_.per_gap[k - 1];
    const std::size_t first = k > 1 ? k - 2 : 0, last = std::min(n - 1, k + 1);
    Extent own, all;
    for (std::size_t s = first; s <= last; ++s)
      for (const SectionEdge& e : stack_.sections[s].edges)
        for (std::int32_t v : {e.a, e.b}) {
          all.add(stack_.sections[s].points[v]);
          if (s + 1 == k || s == k) own.add(stack_.sections[s].points[v]);
        }
    if (own.empty()) return 0;
    const Raster raster = raster_over(all);
    std::array<Pixels, 4> slices;
    for (std::size_t s = first; s <= last; ++s) slices[s + 2 - k] = rasterise(stack_.sections[s], raster, index_of_);
    for (int end : {1, 2})
      if (slices[end].label.empty()) {
        slices[end] = slices[3 - end];
        slices[end].label.assign(slices[end].label.size(), 0);
        slices[end].border.clear();
      }
    end_flat(k, slices);
    NestedOptions options;
    options.tension = o_.tension;
    options.pixel_mm = {o_.unit[0] * stack_.grid_x_mm, o_.unit[1] * stack_.grid_y_mm};
    Gap gap;
    gap.low = &slices[1];
    gap.high = &slices[2];
    const auto z = [&](std::size_t s) { return stack_.sections[s].z_mm; };
    const double low = k == 0 ? z(0) - o_.low_end_mm : z(k - 1), high = k == n ? z(n - 1) + o_.high_end_mm : z(k);
    const double height = high - low;
    options.end_at = beyond ? 1 : closes_at(low, high);
    if (k > 1 && first + 2 == k) {
      gap.before = &slices[0];
      gap.neighbours_rel[0] = (low - z(k - 2)) / height;
    }
    if (k + 1 < n && k > 0) {
      gap.after = &slices[3];
      gap.neighbours_rel[1] = (z(k + 1) - high) / height;
    } else if (k == 0 && n > 1) {
      gap.after = &slices[3];
      gap.neighbours_rel[1] = (z(1) - high) / height;
    }
    const bool watch = beyond || o_.watch.empty() || o_.watch[k - 1] != 0;
    NestedLayers layers;
    while (true) {
      options.per_gap = count;
      layers = fill_nested_gap(gap, options);
      if (!watch || layers.breaks == 0 || 2 * count + 1 > (beyond ? kMostBeyond : kMostForNesting)) break;
      count = 2 * count + 1;
    }
    for (int j = 1; j <= count; ++j) {
      LabelLayer layer;
      layer.z_mm = low + height * j / (count + 1);
      layer.x0 = raster.x0;
      layer.y0 = raster.y0;
      layer.unit = raster.unit;
      layer.width = raster.width;
      layer.height = raster.height;
      for (std::uint16_t l : layers.label) layer.label.push_back(stack_.labels[l].number);
      place_borders(layers.layer[j - 1], layer);
      layer.part = std::move(layers.layer[j - 1].part);
      take(k, layer);
    }
    return beyond ? 0 : static_cast<double>(layers.breaks) * options.pixel_mm[0] * options.pixel_mm[1];
  }

 private:
  /// Over the contours and a margin; pixels of all gaps lie on one lattice.
  Raster raster_over(const Extent& extent) const {
    Raster raster;
    raster.unit = o_.unit;
    const auto along = [](std::int32_t low, std::int32_t high, std::int32_t unit, double& start) {
      const double first = std::floor(static_cast<double>(low) / unit) - kMargin;
      start = first * unit + unit / 2 + 0.5;
      return static_cast<int>(std::ceil(static_cast<double>(high) / unit) - first) + kMargin;
    };
    raster.width = along(extent.x0, extent.x1, raster.unit[0], raster.x0);
    raster.height = along(extent.y0, extent.y1, raster.unit[1], raster.y0);
    return raster;
  }

  static float share(float here, float there) {
    return here + there > 0 ? std::clamp(here / (here + there), kNearest, kFurthest) : 0.5f;
  }

  /// Where in a gap a part closes that goes no further, as a share: half way for plane cuts, three quarters for slices
  /// (as stitched), and for labels that end here as far as their own gap says.
  double closes_at(double low, double high) const {
    const double peak = stack_.slices && !stack_.drawn_ends.empty() ? 1.5 : 1;  // of half a gap
    double at = 0;
    for (const DrawnEnds& both : stack_.drawn_ends)
      for (bool upward : {true, false}) {
        const DrawnEnd& e = upward ? both.high : both.low;
        if (e.flat || e.last_mm != (upward ? low : high) || !(e.half_gap_mm > 0)) continue;
        const double tip =
            upward ? e.contour_mm + peak * e.half_gap_mm - low : high - e.contour_mm + peak * e.half_gap_mm;
        at = std::max(at, tip / (high - low));
      }
    return at > 0 ? std::clamp(at, 0.05, 1.0) : 0.5 * peak;
  }

  /// A label that ends flat on a section is no more beyond it: what is there then lies under it, too.
  void end_flat(std::size_t k, std::array<Pixels, 4>& slices) const {
    if (k == 0 || k == stack_.sections.size()) return;
    for (bool upward : {true, false}) {
      Pixels &ended = slices[upward ? 1 : 2], &goes_on = slices[upward ? 2 : 1];
      const double z_mm = stack_.sections[upward ? k - 1 : k].z_mm;
      for (const DrawnEnds& both : stack_.drawn_ends) {
        const DrawnEnd& e = upward ? both.high : both.low;
        const auto index = index_of_.find(both.label);
        if (!e.flat || !e.on_section || e.last_mm != z_mm || index == index_of_.end()) continue;
        const std::uint16_t label = index->second;
        if (std::find(ended.label.begin(), ended.label.end(), label) == ended.label.end()) continue;
        std::vector<char> given(ended.label.size(), 0);
        for (std::size_t p = 0; p < ended.label.size(); ++p)
          if (ended.label[p] == label) {
            ended.label[p] = goes_on.label[p];
            given[p] = 1;
          }
        std::vector<BorderPiece> kept;
        for (BorderPiece piece : ended.border) {
          const int x = std::clamp(static_cast<int>(std::lround(0.5 * (piece.ax + piece.bx))), 0, ended.width - 1);
          const int y = std::clamp(static_cast<int>(std::lround(0.5 * (piece.ay + piece.by))), 0, ended.height - 1);
          const std::int32_t beyond = goes_on.label[static_cast<std::size_t>(y) * ended.width + x];
          if (piece.left == label) piece.left = beyond;
          if (piece.right == label) piece.right = beyond;
          if (piece.left != piece.right) kept.push_back(piece);
        }
        // Where the label beyond has its own contour under this one, that is the border now.
        for (const BorderPiece& piece : goes_on.border) {
          const int x = std::clamp(static_cast<int>(std::lround(0.5 * (piece.ax + piece.bx))), 0, ended.width - 1);
          const int y = std::clamp(static_cast<int>(std::lround(0.5 * (piece.ay + piece.by))), 0, ended.height - 1);
          if (given[static_cast<std::size_t>(y) * ended.width + x]) kept.push_back(piece);
        }
        ended.border = std::move(kept);
      }
    }
  }

  /// Where borders run: across levels of nesting, at the outline of the deeper one; within a level, where its labels
  /// are equal.
  static void place_borders(const NestedLayers::Layer& from, LabelLayer& layer) {
    const std::size_t size = from.part.size(), width = layer.width;
    layer.right.assign(size, 0.5f);
    layer.up.assign(size, 0.5f);
    const auto between = [&](std::size_t p, std::size_t q) {
      if (layer.label[from.part[p]] == layer.label[from.part[q]]) return 0.5f;
      const int deeper = std::max(from.level[p], from.level[q]);
      if (deeper < 0) return 0.5f;
      if (from.level[p] == from.level[q]) return share(from.label_depth[deeper][p], from.label_depth[deeper][q]);
      return share(std::abs(from.inside[deeper][p]), std::abs(from.inside[deeper][q]));
    };
    for (std::size_t p = 0; p + 1 < size; ++p) {
      if ((p + 1) % width != 0) layer.right[p] = between(p, p + 1);
      if (p + width < size) layer.up[p] = between(p, p + width);
    }
  }

  const Stack& stack_;
  const VirtualLayerOptions& o_;
  std::map<Label, std::uint16_t> index_of_;
};

}  // namespace

std::vector<int> virtual_sections_per_gap(const Stack& stack, double feature_mm) {
  std::vector<int> out;
  for (std::size_t k = 0; k + 1 < stack.sections.size(); ++k) {
    const double ratio = (stack.sections[k + 1].z_mm - stack.sections[k].z_mm) / feature_mm;
    out.push_back(ratio > 1.5 ? static_cast<int>(std::min<double>(kMostPerGap, std::max(1.0, std::round(ratio) - 1)))
                              : 0);
  }
  return out;
}

std::vector<OpenGap> interpolate_sections(const Stack& stack, const VirtualLayerOptions& options,
                                          const std::function<void(std::size_t, const LabelLayer&)>& take) {
  if (!(options.tension >= 0 && options.tension <= 1))
    fail_usage("the tension of the spline is not between 0 and 1", std::to_string(options.tension), "leave it at 0.25");
  if (options.per_gap.size() + 1 != stack.sections.size())
    fail_usage("the numbers of virtual sections do not fit the gaps", std::to_string(options.per_gap.size()),
               "give one for each gap");
  for (int count : options.per_gap)
    if (count < 0 || count > kMostPerGap)
      fail_usage("the number of virtual sections is not between 0 and " + std::to_string(kMostPerGap),
                 std::to_string(count), "give a smaller number");
  if (options.unit[0] < 64 || options.unit[1] < 64)
    fail_usage("the raster of virtual sections is too fine for the stack's grid", std::to_string(options.unit[0]),
               "give larger pixels");
  const LayerMaker maker(stack, options);
  const std::size_t n = stack.sections.size();
  std::vector<double> open(n + 1, 0);
  parallel_for(n + 1, options.threads, [&](std::size_t k) {
    const bool wanted = k == 0   ? options.low_end_mm > 0 && options.end_layers > 0
                        : k == n ? options.high_end_mm > 0 && options.end_layers > 0
                                 : options.per_gap[k - 1] > 0 || (!options.watch.empty() && options.watch[k - 1] != 0);
    if (wanted) open[k] = maker.gap(k, take);
  });
  std::vector<OpenGap> gaps;
  for (std::size_t k = 1; k < n; ++k)
    if (open[k] > 0) gaps.push_back({k - 1, open[k]});
  return gaps;
}

}  // namespace stackmesh
