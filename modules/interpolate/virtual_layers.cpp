#include "interpolate/virtual_layers.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "interpolate/fill_gap.h"
#include "interpolate/section_raster.h"

namespace stackmesh {
namespace {

using namespace interpolate;

constexpr int kMostPerGap = 1000;
constexpr int kMargin = 6;                           // pixels round the contours
constexpr float kNearest = 0.1f, kFurthest = 0.9f;   // a border keeps this far from pixel centres

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

  void gap(std::size_t k, const std::function<void(std::size_t, int, const LabelLayer&)>& take) const {
    const int count = o_.per_gap[k];
    const std::size_t n = stack_.sections.size();
    const std::size_t first = k > 0 ? k - 1 : 0, last = std::min(n - 1, k + 2);
    Extent own, all;
    for (std::size_t s = first; s <= last; ++s)
      for (const SectionEdge& e : stack_.sections[s].edges)
        for (std::int32_t v : {e.a, e.b}) {
          all.add(stack_.sections[s].points[v]);
          if (s == k || s == k + 1) own.add(stack_.sections[s].points[v]);
        }
    if (own.empty()) return;
    const Raster raster = raster_over(all);
    std::array<Pixels, 4> slices;
    for (std::size_t s = first; s <= last; ++s) slices[s + 1 - k] = rasterise(stack_.sections[s], raster, index_of_);
    Gap gap;
    gap.low = &slices[1];
    gap.high = &slices[2];
    const auto z = [&](std::size_t s) { return stack_.sections[s].z_mm; };
    const double height = z(k + 1) - z(k);
    if (k > 0) {
      gap.before = &slices[0];
      gap.neighbours_rel[0] = (z(k) - z(k - 1)) / height;
    }
    if (k + 2 < n) {
      gap.after = &slices[3];
      gap.neighbours_rel[1] = (z(k + 2) - z(k + 1)) / height;
    }
    std::vector<LayerDepth> depth;
    const std::array<double, 2> pixel_mm = {o_.unit[0] * stack_.grid_x_mm, o_.unit[1] * stack_.grid_y_mm};
    GapLayers layers = fill_gap(gap, count, o_.tension, pixel_mm, &depth);
    for (int j = 1; j <= count; ++j) {
      LabelLayer layer;
      layer.z_mm = z(k) + height * j / (count + 1);
      layer.x0 = raster.x0;
      layer.y0 = raster.y0;
      layer.unit = raster.unit;
      layer.width = raster.width;
      layer.height = raster.height;
      layer.part = std::move(layers.group[j]);
      for (std::uint16_t l : layers.label) layer.label.push_back(stack_.labels[l].number);
      place_borders(depth[j - 1], layer);
      take(k, j - 1, layer);
    }
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

  static void place_borders(const LayerDepth& depth, LabelLayer& layer) {
    const std::size_t size = layer.part.size(), width = layer.width;
    layer.right.assign(size, 0.5f);
    layer.up.assign(size, 0.5f);
    const auto between = [&](std::size_t p, std::size_t q) {
      const Label a = layer.label[layer.part[p]], b = layer.label[layer.part[q]];
      if (a == b) return 0.5f;
      const std::vector<float>& d = a == 0 || b == 0 ? depth.tissue : depth.label;
      return share(d[p], d[q]);
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
    out.push_back(ratio > 1.5 ? static_cast<int>(std::min<double>(kMostPerGap, std::max(1.0, std::round(ratio) - 1))) : 0);
  }
  return out;
}

void interpolate_sections(const Stack& stack, const VirtualLayerOptions& options,
                          const std::function<void(std::size_t, int, const LabelLayer&)>& take) {
  if (!(options.tension >= 0 && options.tension <= 1))
    fail_usage("the tension of the spline is not between 0 and 1", std::to_string(options.tension), "leave it at 0.25");
  if (options.per_gap.size() + 1 != stack.sections.size())
    fail_usage("the numbers of virtual sections do not fit the gaps", std::to_string(options.per_gap.size()), "give one for each gap");
  for (int count : options.per_gap)
    if (count < 0 || count > kMostPerGap)
      fail_usage("the number of virtual sections is not between 0 and " + std::to_string(kMostPerGap), std::to_string(count),
                 "give a smaller number");
  if (options.unit[0] < 64 || options.unit[1] < 64)
    fail_usage("the raster of virtual sections is too fine for the stack's grid", std::to_string(options.unit[0]), "give larger pixels");
  const LayerMaker maker(stack, options);
  parallel_for(options.per_gap.size(), options.threads, [&](std::size_t k) {
    if (options.per_gap[k] > 0) maker.gap(k, take);
  });
}

}  // namespace stackmesh
