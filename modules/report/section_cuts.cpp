#include "report/section_cuts.h"

#include <algorithm>

#include "base/parallel.h"
#include "report/polylines.h"

namespace stackmesh {
namespace {

std::uint64_t edge_name(std::int32_t a, std::int32_t b) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(std::min(a, b))) << 32 |
         static_cast<std::uint32_t>(std::max(a, b));
}

/// Where the plane meets an edge; the same for both triangles at it.
std::array<double, 2> crossing(const std::vector<Vec3>& points, std::int32_t a, std::int32_t b, double height) {
  const Vec3 &p = points[std::min(a, b)], &q = points[std::max(a, b)];
  const double s = (height - p.z) / (q.z - p.z);
  return {p.x + s * (q.x - p.x), p.y + s * (q.y - p.y)};
}

struct SliceStrides {
  std::size_t u, v, w;
  int width, height, count;
};

SliceStrides strides_of(const LabelVolume& volume, int stack_axis) {
  const std::size_t stride[3] = {1, static_cast<std::size_t>(volume.size[0]),
                                 static_cast<std::size_t>(volume.size[0]) * volume.size[1]};
  const int u = (stack_axis + 1) % 3, v = (stack_axis + 2) % 3;
  return {stride[u], stride[v], stride[stack_axis], volume.size[u], volume.size[v], volume.size[stack_axis]};
}

}  // namespace

std::vector<std::string> cut_complex(const InterfaceComplex& complex, const Frame& frame,
                                     const std::vector<double>& heights, const LabelIndex& index,
                                     const CurveDrawing& drawing) {
  std::vector<Vec3> points(complex.points.size());
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = frame.to_stack(complex.points[i]);
  const bool mirrored = frame.mirrors();

  // The planes that cut a triangle follow each other: [first, last).
  const std::size_t planes = heights.size();
  std::vector<std::array<std::int32_t, 2>> range(complex.triangles.size());
  std::vector<std::size_t> start(planes + 1, 0);
  for (std::size_t t = 0; t < complex.triangles.size(); ++t) {
    const auto& v = complex.triangles[t].v;
    const auto [low, high] = std::minmax({points[v[0]].z, points[v[1]].z, points[v[2]].z});
    const auto first = std::upper_bound(heights.begin(), heights.end(), low),
               last = std::upper_bound(first, heights.end(), high);
    range[t] = {static_cast<std::int32_t>(first - heights.begin()), static_cast<std::int32_t>(last - heights.begin())};
    for (std::int32_t p = range[t][0]; p < range[t][1]; ++p) ++start[p + 1];
  }
  for (std::size_t p = 0; p < planes; ++p) start[p + 1] += start[p];
  std::vector<std::int32_t> cut(start.back());
  std::vector<std::size_t> fill(start.begin(), start.end() - 1);
  for (std::size_t t = 0; t < complex.triangles.size(); ++t)
    for (std::int32_t p = range[t][0]; p < range[t][1]; ++p) cut[fill[p]++] = static_cast<std::int32_t>(t);

  std::vector<std::string> packed(planes);
  parallel_for(planes, drawing.threads, [&](std::size_t plane) {
    const double height = heights[plane];
    std::vector<CurveSegment> segments;
    segments.reserve(start[plane + 1] - start[plane]);
    for (std::size_t i = start[plane]; i < start[plane + 1]; ++i) {
      const InterfaceTriangle& t = complex.triangles[cut[i]];
      CurveSegment s;
      // From the edge that rises through the plane to the one that sinks, what lies above the triangle is on the left.
      s.left = index(mirrored ? t.below : t.above);
      s.right = index(mirrored ? t.above : t.below);
      for (int k = 0; k < 3; ++k) {
        const std::int32_t a = t.v[k], b = t.v[(k + 1) % 3];
        const bool above_a = points[a].z >= height, above_b = points[b].z >= height;
        if (above_a == above_b) continue;
        (above_b ? s.from : s.to) = edge_name(a, b);
        (above_b ? s.a : s.b) = crossing(points, a, b, height);
      }
      segments.push_back(s);
    }
    Bytes bytes;
    pack(join_segments(std::move(segments), drawing.unit_mm, drawing.tolerance_mm), bytes);
    packed[plane] = std::move(bytes.text);
  });
  return packed;
}

std::string draw_section(const Stack& stack, const Section& section, const LabelIndex& index,
                         const CurveDrawing& drawing) {
  std::vector<CurveSegment> segments;
  for (const SectionEdge& e : section.edges) {
    const auto at = [&](std::int32_t p) {
      return std::array<double, 2>{section.points[p].x * stack.grid_x_mm, section.points[p].y * stack.grid_y_mm};
    };
    segments.push_back({index(e.left), index(e.right), static_cast<std::uint64_t>(e.a), static_cast<std::uint64_t>(e.b),
                        at(e.a), at(e.b)});
  }
  Bytes bytes;
  pack(join_segments(std::move(segments), drawing.unit_mm, drawing.tolerance_mm), bytes);
  return std::move(bytes.text);
}

PixelWindow window_of_labels(const LabelVolume& volume, int stack_axis) {
  const SliceStrides s = strides_of(volume, stack_axis);
  int x0 = s.width, x1 = -1, y0 = s.height, y1 = -1;
  const std::uint16_t* voxel = volume.voxels.data();
  const int u = (stack_axis + 1) % 3, v = (stack_axis + 2) % 3;
  for (int k = 0; k < volume.size[2]; ++k)
    for (int j = 0; j < volume.size[1]; ++j, voxel += volume.size[0]) {
      int first = 0, last = volume.size[0];
      while (first < last && voxel[first] == 0) ++first;
      if (first == last) continue;
      while (voxel[last - 1] == 0) --last;
      const int low[3] = {first, j, k}, high[3] = {last - 1, j, k};
      x0 = std::min(x0, low[u]), x1 = std::max(x1, high[u]);
      y0 = std::min(y0, low[v]), y1 = std::max(y1, high[v]);
    }
  if (x1 < 0) return {0, 0, s.width, s.height};
  x0 = std::max(0, x0 - 1), y0 = std::max(0, y0 - 1);
  x1 = std::min(s.width - 1, x1 + 1), y1 = std::min(s.height - 1, y1 + 1);
  return {x0, y0, x1 - x0 + 1, y1 - y0 + 1};
}

std::vector<std::string> pack_slices(const LabelVolume& volume, int stack_axis, const PixelWindow& window,
                                     const LabelIndex& index, int threads) {
  const SliceStrides s = strides_of(volume, stack_axis);
  std::vector<std::int32_t> number(volume.labels.size());
  for (std::size_t l = 0; l < number.size(); ++l) number[l] = index(volume.labels[l].number);
  std::vector<std::string> packed(static_cast<std::size_t>(s.count));
  parallel_for(packed.size(), threads, [&](std::size_t k) {
    Bytes bytes;
    std::uint16_t label = 0;
    std::uint64_t run = 0;
    for (int y = window.y; y < window.y + window.height; ++y) {
      const std::uint16_t* row = volume.voxels.data() + k * s.w + static_cast<std::size_t>(y) * s.v;
      for (int x = window.x; x < window.x + window.width; ++x) {
        const std::uint16_t here = row[static_cast<std::size_t>(x) * s.u];
        if (here != label && run > 0) {
          bytes.number(static_cast<std::uint64_t>(number[label]));
          bytes.number(run);
          run = 0;
        }
        label = here;
        ++run;
      }
    }
    bytes.number(static_cast<std::uint64_t>(number[label]));
    bytes.number(run);
    packed[k] = std::move(bytes.text);
  });
  return packed;
}

}  // namespace stackmesh
