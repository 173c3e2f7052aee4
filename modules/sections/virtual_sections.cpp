#include "sections/virtual_sections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <vector>

#include "base/disjoint_sets.h"
#include "base/warning.h"
#include "model/edge_grid.h"
#include "sections/drawn_detail.h"
#include "sections/layer_sections.h"
#include "sections/virtual_layers.h"

namespace stackmesh {
namespace {

constexpr double kFeaturesAcross = 64;                      // of a typical contour
constexpr double kMostPoints = 5e5;                         // of the virtual sections, estimated
constexpr double kMostPixels = 1024;                        // of the raster along the longer side
constexpr double kTolerance_px = 0.1;                       // of the raster
constexpr double kSame_rel = 0.25;                          // of a feature: sections nowhere further apart are the same
constexpr double kWallPixel_rel = 0.4, kFinest_rel = 0.15;  // of a thin wall; of a feature
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

double total_length_mm(const Stack& stack, const Section& s) {
  double sum = 0;
  for (const SectionEdge& e : s.edges)
    sum += std::hypot((s.points[e.b].x - s.points[e.a].x) * stack.grid_x_mm,
                      (s.points[e.b].y - s.points[e.a].y) * stack.grid_y_mm);
  return sum;
}

std::string text_of(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.4g", value);
  return buffer;
}

double squared_distance_mm2(const Stack& stack, GridPoint p, GridPoint a, GridPoint b) {
  const double ax = (a.x - p.x) * stack.grid_x_mm, ay = (a.y - p.y) * stack.grid_y_mm;
  const double dx = (b.x - a.x) * stack.grid_x_mm, dy = (b.y - a.y) * stack.grid_y_mm, length2 = dx * dx + dy * dy;
  const double t = length2 > 0 ? std::clamp(-(ax * dx + ay * dy) / length2, 0.0, 1.0) : 0;
  return (ax + t * dx) * (ax + t * dx) + (ay + t * dy) * (ay + t * dy);
}

/// Does every point of the one section lie within `reach_mm` of an edge of the other that parts the same labels?
bool lies_along(const Stack& stack, const Section& one, const Section& other, double reach_mm) {
  if (one.edges.empty() || other.edges.empty()) return one.edges.empty() && other.edges.empty();
  std::vector<GridSegment> segments;
  for (const SectionEdge& e : other.edges) segments.push_back({other.points[e.a], other.points[e.b]});
  const EdgeGrid grid(segments);
  const std::int32_t rx = static_cast<std::int32_t>(reach_mm / stack.grid_x_mm) + 1,
                     ry = static_cast<std::int32_t>(reach_mm / stack.grid_y_mm) + 1;
  for (const SectionEdge& e : one.edges)
    for (std::int32_t v : {e.a, e.b}) {
      const GridPoint p = one.points[v];
      bool near = false;
      grid.near_box({p.x - rx, p.y - ry}, {p.x + rx, p.y + ry}, [&](std::int32_t k) {
        const SectionEdge& f = other.edges[k];
        near = near || (std::minmax(e.left, e.right) == std::minmax(f.left, f.right) &&
                        squared_distance_mm2(stack, p, segments[k].a, segments[k].b) <= reach_mm * reach_mm);
      });
      if (!near) return false;
    }
  return true;
}

/// A pixel of about that size, odd, so that pixel centres lie between grid points.
std::int32_t odd_unit(double size_mm, double grid_mm) {
  const std::int32_t unit =
      static_cast<std::int32_t>(std::min(1e7, std::max<double>(kSmallestUnit, size_mm / grid_mm)));
  return unit | 1;
}

}  // namespace

double contour_feature_mm(const Stack& stack) {
  const double extent = contour_extent_mm(stack);
  if (!(extent > 0)) return stack.pixel_mm;
  double feature = std::max(stack.pixel_mm, extent / kFeaturesAcross);
  std::vector<double> length;
  for (const Section& s : stack.sections) length.push_back(total_length_mm(stack, s));
  for (;; feature *= 1.25) {
    double points = 0;
    const std::vector<int> per_gap = virtual_sections_per_gap(stack, feature);
    for (std::size_t k = 0; k < per_gap.size(); ++k)
      points += per_gap[k] * std::max(length[k], length[k + 1]) / feature;
    if (points <= kMostPoints) return feature;
  }
}

namespace {

/// Does any contour of the section lie within another one? Each label and each hole in it counts.
bool has_nesting(const Section& s) {
  // A region's outline that touches no other one lies in something if that side of it is a label, or if it goes round a
  // hole.
  DisjointSets contours(s.points.size());
  for (const SectionEdge& e : s.edges) contours.join(e.a, e.b);
  std::vector<double> twice(s.points.size(), 0);  // of a connected contour, with its label on the left
  for (const SectionEdge& e : s.edges) {
    if (e.left != 0 && e.right != 0) return true;  // labels that touch, or one in another
    const GridPoint a = s.points[e.a], b = s.points[e.b];
    twice[contours.find(e.a)] +=
        (e.left != 0 ? 1.0 : -1.0) * (static_cast<double>(a.x) * b.y - static_cast<double>(b.x) * a.y);
  }
  return std::any_of(twice.begin(), twice.end(), [](double t) { return t < 0; });
}

/// How far beyond the first or last section its labels close round what lies within them; 0: the stitcher closes them.
double closing_mm(const Stack& stack, bool high) {
  const Section& end = high ? stack.sections.back() : stack.sections.front();
  if (!has_nesting(end)) return 0;
  double reach = 0;
  for (const SectionEdge& e : end.edges)
    for (Label l : {e.left, e.right})
      for (const DrawnEnds& both : stack.drawn_ends) {
        if (l == 0 || both.label != l) continue;
        const DrawnEnd& d = high ? both.high : both.low;
        if (d.flat || d.last_mm != end.z_mm || d.last_mm != d.contour_mm) {
          if (e.left == 0 || e.right == 0) return 0;  // the outer label ends flat
          continue;
        }
        reach = std::max(reach, (stack.slices ? 1.5 : 1.0) * d.half_gap_mm);
      }
  return reach;
}

}  // namespace

std::size_t add_virtual_sections(Stack& stack, std::optional<int> per_gap, int threads,
                                 std::vector<Warning>& warnings) {
  if (stack.sections.size() < 2) return 0;
  const std::size_t gaps = stack.sections.size() - 1;
  const double feature = contour_feature_mm(stack);
  const bool nests = std::any_of(stack.sections.begin(), stack.sections.end(), has_nesting);
  const double wall = nests ? contour_wall_mm(stack) : feature;
  VirtualLayerOptions options;
  options.threads = threads;
  options.per_gap = per_gap ? std::vector<int>(gaps, *per_gap) : virtual_sections_per_gap(stack, feature);
  options.watch.assign(gaps, 0);
  for (std::size_t k = 0; k < gaps; ++k) {
    const Section &low = stack.sections[k], &high = stack.sections[k + 1];
    const auto same = [&](double reach) {
      return lies_along(stack, low, high, reach) && lies_along(stack, high, low, reach);
    };
    // Walls between sections that are all but the same are straight as they are.
    if (!per_gap && options.per_gap[k] > 0 && same(kSame_rel * feature)) options.per_gap[k] = 0;
    options.watch[k] = nests && has_nesting(low) && has_nesting(high) &&
                       !(options.per_gap[k] == 0 && same(kSame_rel * std::min(feature, wall)));
  }
  options.low_end_mm = nests ? closing_mm(stack, false) : 0;
  options.high_end_mm = nests ? closing_mm(stack, true) : 0;
  options.end_layers =
      static_cast<int>(std::clamp(std::round(std::max(options.low_end_mm, options.high_end_mm) / feature), 3.0, 12.0));
  const bool any = options.low_end_mm > 0 || options.high_end_mm > 0 ||
                   std::count(options.watch.begin(), options.watch.end(), 0) < static_cast<std::ptrdiff_t>(gaps) ||
                   std::accumulate(options.per_gap.begin(), options.per_gap.end(), 0) > 0;
  if (!any) return 0;
  Box box;
  for (const Section& s : stack.sections)
    for (const SectionEdge& e : s.edges) box.add(s.points[e.a]);
  const double detail = nests ? std::clamp(kWallPixel_rel * wall, kFinest_rel * feature, 0.5 * feature) : 0.5 * feature;
  const double pixel = std::max(detail, extent_mm(stack, box) / kMostPixels);
  options.unit = {odd_unit(pixel, stack.grid_x_mm), odd_unit(pixel, stack.grid_y_mm)};
  std::vector<std::vector<Section>> between(gaps + 2);
  for (std::size_t k = 0; k < gaps; ++k)
    for (int j = 0; j < options.per_gap[k]; ++j) {  // a gap without contours stays empty
      const double low = stack.sections[k].z_mm, high = stack.sections[k + 1].z_mm;
      between[k + 1].emplace_back();
      between[k + 1].back().z_mm = low + (high - low) * (j + 1) / (options.per_gap[k] + 1);
      between[k + 1].back().interpolated = true;
    }
  std::vector<char> given(gaps + 2, 0);
  const std::vector<OpenGap> open = interpolate_sections(stack, options, [&](std::size_t gap, const LabelLayer& layer) {
    if (!given[gap]) between[gap].clear();
    given[gap] = 1;
    between[gap].push_back(layer_section(layer, kTolerance_px));
  });
  for (const OpenGap& g : open) {
    const std::string sections = "sections at z = " + text_of(stack.sections[g.gap].z_mm) + " and " +
                                 text_of(stack.sections[g.gap + 1].z_mm) + " mm";
    warnings.push_back({WarningCode::open_wall, sections,
                        "between the " + sections +
                            " contours that lie within others cannot be kept inside: a wall is open over about " +
                            text_of(g.area_mm2) + " mm2"});
  }
  for (std::size_t end : {std::size_t{0}, gaps + 1})  // the stitcher closes the last of them
    between[end].erase(
        std::remove_if(between[end].begin(), between[end].end(), [](const Section& s) { return s.edges.empty(); }),
        between[end].end());
  std::size_t total = 0;
  std::vector<Section> all;
  for (std::size_t k = 0; k < between.size(); ++k) {
    total += between[k].size();
    for (Section& s : between[k]) all.push_back(std::move(s));
    if (k < stack.sections.size()) all.push_back(std::move(stack.sections[k]));
  }
  stack.sections = std::move(all);
  return total;
}

}  // namespace stackmesh
