#include "sections/section_raster.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace stackmesh::interpolate {
namespace {

/// Where a contour crosses a row of centres; what lies to the right of it.
struct Crossing {
  long double x;
  std::uint16_t after;
};

}  // namespace

Pixels rasterise(const Section& section, const Raster& raster, const std::map<Label, std::uint16_t>& index_of) {
  Pixels out;
  out.width = raster.width;
  out.height = raster.height;
  out.label.assign(static_cast<std::size_t>(raster.width) * raster.height, 0);
  std::vector<std::vector<Crossing>> rows(raster.height);
  const auto column = [&](double x) { return (x - raster.x0) / raster.unit[0]; };
  const auto row = [&](double y) { return (y - raster.y0) / raster.unit[1]; };
  for (const SectionEdge& e : section.edges) {
    const GridPoint a = section.points[e.a], b = section.points[e.b];
    const std::uint16_t left = index_of.at(e.left), right = index_of.at(e.right);
    out.border.push_back({column(a.x), row(a.y), column(b.x), row(b.y), left, right});
    const double low = std::min(a.y, b.y), high = std::max(a.y, b.y);
    const int first = static_cast<int>(std::max(0.0, std::ceil(row(low)))),
              last = static_cast<int>(std::min(raster.height - 1.0, std::floor(row(high))));
    for (int y = first; y <= last; ++y) {
      const long double at = raster.y0 + static_cast<double>(y) * raster.unit[1];
      if (!(at > low && at < high)) continue;
      const long double x =
          a.x + (at - a.y) * (static_cast<long double>(b.x) - a.x) / (static_cast<long double>(b.y) - a.y);
      rows[y].push_back({x, b.y > a.y ? right : left});
    }
  }
  for (int y = 0; y < raster.height; ++y) {
    std::sort(rows[y].begin(), rows[y].end(), [](const Crossing& c, const Crossing& d) { return c.x < d.x; });
    std::uint16_t label = 0;
    std::size_t next = 0;
    for (int x = 0; x < raster.width; ++x) {
      const long double centre = raster.x0 + static_cast<double>(x) * raster.unit[0];
      while (next < rows[y].size() && rows[y][next].x <= centre) label = rows[y][next++].after;
      out.label[static_cast<std::size_t>(y) * raster.width + x] = label;
    }
  }
  return out;
}

}  // namespace stackmesh::interpolate
