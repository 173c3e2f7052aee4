#include "pipeline/virtual_sections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "contour/layer_sections.h"
#include "interpolate/virtual_layers.h"

namespace stackmesh {
namespace {

constexpr double kFeaturesAcross = 64;     // of a typical contour
constexpr double kMostPoints = 5e5;        // of the virtual sections, estimated
constexpr double kMostPixels = 1024;       // of the raster along the longer side
constexpr double kTolerance_px = 0.1;      // of the raster
constexpr std::int32_t kSmallestUnit = 64;

struct Box {
  std::int32_t x0 = 1 << 30, y0 = 1 << 30, x1 = -(1 << 30), y1 = -(1 << 30);
  void add(GridPoint p) {
    x0 = std::min(x0, p.x);
    y0 = std::min(y0, p.y);
    x1 = std::max(x1, p.x);
    y1 = std::max(y1, p.y);
  }
};

double extent_mm(const Stack& stack, const Box& box) {
  return std::max((box.x1 - box.x0) * stack.grid_x_mm, (box.y1 - box.y0) * stack.grid_y_mm);
}

/// The size of the connected contours, one entry an edge.
std::vector<double> contour_extents_mm(const Stack& stack) {
  std::vector<double> out;
  for (const Section& s : stack.sections) {
    std::vector<std::int32_t> parent(s.points.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto find = [&](std::int32_t v) {
      while (parent[v] != v) v = parent[v] = parent[parent[v]];
      return v;
    };
    for (const SectionEdge& e : s.edges) parent[find(e.a)] = find(e.b);
    std::vector<Box> box(s.points.size());
    for (const SectionEdge& e : s.edges) {
      box[find(e.a)].add(s.points[e.a]);
      box[find(e.a)].add(s.points[e.b]);
    }
    for (const SectionEdge& e : s.edges) out.push_back(extent_mm(stack, box[find(e.a)]));
  }
  return out;
}

double total_length_mm(const Stack& stack, const Section& s) {
  double sum = 0;
  for (const SectionEdge& e : s.edges)
    sum += std::hypot((s.points[e.b].x - s.points[e.a].x) * stack.grid_x_mm, (s.points[e.b].y - s.points[e.a].y) * stack.grid_y_mm);
  return sum;
}

/// A pixel of about that size, odd, so that pixel centres lie between grid points.
std::int32_t odd_unit(double size_mm, double grid_mm) {
  const std::int32_t unit = static_cast<std::int32_t>(std::min(1e7, std::max<double>(kSmallestUnit, size_mm / grid_mm)));
  return unit | 1;
}

}  // namespace

double contour_feature_mm(const Stack& stack) {
  std::vector<double> extents = contour_extents_mm(stack);
  if (extents.empty()) return stack.pixel_mm;
  std::nth_element(extents.begin(), extents.begin() + extents.size() / 2, extents.end());
  double feature = std::max(stack.pixel_mm, extents[extents.size() / 2] / kFeaturesAcross);
  std::vector<double> length;
  for (const Section& s : stack.sections) length.push_back(total_length_mm(stack, s));
  for (;; feature *= 1.25) {
    double points = 0;
    const std::vector<int> per_gap = virtual_sections_per_gap(stack, feature);
    for (std::size_t k = 0; k < per_gap.size(); ++k) points += per_gap[k] * std::max(length[k], length[k + 1]) / feature;
    if (points <= kMostPoints) return feature;
  }
}

std::size_t add_virtual_sections(Stack& stack, std::optional<int> per_gap, int threads) {
  if (stack.sections.size() < 2 || (per_gap && *per_gap == 0)) return 0;
  const double feature = contour_feature_mm(stack);
  VirtualLayerOptions options;
  options.threads = threads;
  options.per_gap = per_gap ? std::vector<int>(stack.sections.size() - 1, *per_gap) : virtual_sections_per_gap(stack, feature);
  const int total = std::accumulate(options.per_gap.begin(), options.per_gap.end(), 0);
  if (total == 0) return 0;
  Box box;
  for (const Section& s : stack.sections)
    for (const SectionEdge& e : s.edges) box.add(s.points[e.a]);
  const double pixel = std::max(0.5 * feature, extent_mm(stack, box) / kMostPixels);
  options.unit = {odd_unit(pixel, stack.grid_x_mm), odd_unit(pixel, stack.grid_y_mm)};
  std::vector<std::vector<Section>> between(options.per_gap.size());
  for (std::size_t k = 0; k < between.size(); ++k) {
    between[k].resize(options.per_gap[k]);
    for (int j = 0; j < options.per_gap[k]; ++j) {  // a gap without contours stays empty
      const double low = stack.sections[k].z_mm, high = stack.sections[k + 1].z_mm;
      between[k][j].z_mm = low + (high - low) * (j + 1) / (options.per_gap[k] + 1);
      between[k][j].interpolated = true;
    }
  }
  interpolate_sections(stack, options, [&](std::size_t gap, int index, const LabelLayer& layer) {
    between[gap][index] = layer_section(layer, kTolerance_px);
  });
  std::vector<Section> all;
  for (std::size_t k = 0; k < stack.sections.size(); ++k) {
    all.push_back(std::move(stack.sections[k]));
    if (k < between.size())
      for (Section& s : between[k]) all.push_back(std::move(s));
  }
  stack.sections = std::move(all);
  return static_cast<std::size_t>(total);
}

}  // namespace stackmesh
