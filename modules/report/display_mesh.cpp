#include "report/display_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "report/decimate.h"
#include "report/join_cells.h"
#include "report/packed.h"
#include "report/shape.h"

namespace stackmesh {
namespace {

constexpr std::size_t kMostDecimated = 2000000;  // triangles; above, decimation would take minutes

GridCell on_grid(const Vec3& p, const DisplayGrid& grid) {
  const auto at = [&](double x, double origin) {
    return static_cast<std::uint16_t>(std::clamp(std::lround((x - origin) / grid.unit_mm), 0L, 65535L));
  };
  return {at(p.x, grid.origin_mm.x), at(p.y, grid.origin_mm.y), at(p.z, grid.origin_mm.z)};
}

std::uint64_t spread(std::uint64_t x) {  // three zeros' room between the bits
  x = (x | x << 32) & 0x1f00000000ffffu;
  x = (x | x << 16) & 0x1f0000ff0000ffu;
  x = (x | x << 8) & 0x100f00f00f00f00fu;
  x = (x | x << 4) & 0x10c30c30c30c30c3u;
  return (x | x << 2) & 0x1249249249249249u;
}

/// Numbers `points` anew along a curve that keeps neighbours close: order[new] = old.
std::vector<std::int32_t> curve_order(const std::vector<GridCell>& points) {
  std::vector<std::uint64_t> code(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    code[i] = spread(points[i][0]) | spread(points[i][1]) << 1 | spread(points[i][2]) << 2;
  std::vector<std::int32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](std::int32_t a, std::int32_t b) { return code[a] != code[b] ? code[a] < code[b] : a < b; });
  return order;
}

std::string pack_positions(const std::vector<GridCell>& points, const std::vector<std::int32_t>& order) {
  Bytes bytes;
  GridCell last = {0, 0, 0};
  for (const std::int32_t p : order) {
    for (int k = 0; k < 3; ++k) bytes.signed_number(static_cast<int>(points[p][k]) - last[k]);
    last = points[p];
  }
  return std::move(bytes.text);
}

std::vector<std::int32_t> inverse(const std::vector<std::int32_t>& order) {
  std::vector<std::int32_t> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = static_cast<std::int32_t>(i);
  return place;
}

/// A quarter of a degree a step, up to 63.75.
std::uint8_t angle_step(double degrees) {
  return static_cast<std::uint8_t>(std::clamp(std::lround(4 * degrees), 0L, 255L));
}

/// Joins cells, larger and larger ones, until no more triangles are left than wanted.
DrawnSurface joined(const DrawnSurface& fine, const DisplayGrid& grid, std::size_t most, double& cell_mm) {
  // A cell about as wide as the edges of a surface of that many triangles.
  const auto at = [&](std::int32_t v) {
    const GridCell& p = fine.points[v];
    return Vec3{grid.unit_mm * p[0], grid.unit_mm * p[1], grid.unit_mm * p[2]};
  };
  double area2 = 0;
  for (const DrawnTriangle& t : fine.triangles) area2 += norm(cross(at(t.v[1]) - at(t.v[0]), at(t.v[2]) - at(t.v[0])));
  const auto goal = static_cast<double>(std::max<std::size_t>(1, most));
  cell_mm = std::max(grid.unit_mm, std::sqrt(area2 / goal));
  DrawnSurface coarse = join_cells(fine, cell_mm / grid.unit_mm);
  while (coarse.triangles.size() > most) {
    cell_mm *= std::clamp(std::sqrt(static_cast<double>(coarse.triangles.size()) / goal), 1.1, 2.0);
    coarse = join_cells(fine, cell_mm / grid.unit_mm);
  }
  return coarse;
}

}  // namespace

DisplayGrid grid_over(const std::vector<Vec3>& points) {
  DisplayGrid grid;
  if (points.empty()) return grid;
  Vec3 low = points[0], high = points[0];
  for (const Vec3& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const double extent = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  grid.origin_mm = low;
  if (extent > 0) grid.unit_mm = extent / 65535;
  return grid;
}

PackedMesh pack_surface(const InterfaceComplex& complex, const std::vector<float>& distances_mm,
                        const DisplayGrid& grid, const LabelIndex& index, std::size_t most,
                        const std::vector<TriangleValues>& values) {
  DrawnSurface drawn;
  drawn.distances_mm = distances_mm;
  for (const Vec3& p : complex.points) drawn.points.push_back(on_grid(p, grid));
  drawn.triangles.reserve(complex.triangles.size());
  for (std::size_t i = 0; i < complex.triangles.size(); ++i) {
    const InterfaceTriangle& t = complex.triangles[i];
    const auto angles = triangle_angles_deg(complex.points[t.v[0]], complex.points[t.v[1]], complex.points[t.v[2]]);
    drawn.triangles.push_back({t.v, index(t.below), index(t.above),
                               angle_step(std::min({angles[0], angles[1], angles[2]})),
                               values.empty() ? TriangleValues{} : values[i]});
  }
  PackedMesh packed;
  if (drawn.triangles.size() > most && drawn.triangles.size() <= kMostDecimated)
    drawn = decimated(drawn, complex.points, most);
  if (drawn.triangles.size() > most) drawn = joined(drawn, grid, most, packed.cell_mm);

  const std::vector<std::int32_t> order = curve_order(drawn.points), place = inverse(order);
  for (DrawnTriangle& t : drawn.triangles) {
    for (std::int32_t& v : t.v) v = place[v];
    std::rotate(t.v.begin(), std::min_element(t.v.begin(), t.v.end()), t.v.end());
  }
  std::stable_sort(drawn.triangles.begin(), drawn.triangles.end(),
                   [](const DrawnTriangle& a, const DrawnTriangle& b) { return a.v < b.v; });
  Bytes corners, labels, angles, distances, model;
  std::int32_t last = 0;
  for (const DrawnTriangle& t : drawn.triangles) {
    corners.number(static_cast<std::uint64_t>(t.v[0] - last));
    corners.number(static_cast<std::uint64_t>(t.v[1] - t.v[0]));
    corners.number(static_cast<std::uint64_t>(t.v[2] - t.v[0]));
    last = t.v[0];
    labels.number(static_cast<std::uint64_t>(t.below));
    labels.number(static_cast<std::uint64_t>(t.above));
    angles.byte(t.angle);
    for (const std::uint8_t v : {t.values.set, t.values.acts, t.values.modulus, t.values.mises}) model.byte(v);
  }
  packed.vertices = drawn.points.size();
  packed.elements = drawn.triangles.size();
  packed.names = {"positions", "triangles", "labels", "angles"};
  packed.chunks = {pack_positions(drawn.points, order), std::move(corners.text), std::move(labels.text),
                   std::move(angles.text)};
  if (!drawn.distances_mm.empty()) {
    float largest = 0;
    for (const float d : drawn.distances_mm) largest = std::max(largest, d);
    packed.distance_unit_mm = largest > 0 ? static_cast<double>(largest) / 255 : 1;
    for (const std::int32_t p : order)
      distances.byte(static_cast<std::uint8_t>(std::lround(drawn.distances_mm[p] / packed.distance_unit_mm)));
    packed.names.push_back("distances");
    packed.chunks.push_back(std::move(distances.text));
  }
  if (!values.empty()) {
    packed.names.push_back("values");
    packed.chunks.push_back(std::move(model.text));
  }
  return packed;
}

PackedMesh pack_tets(const TetMesh& mesh, const DisplayGrid& grid, const LabelIndex& index, std::size_t most,
                     int threads) {
  PackedMesh packed;
  packed.one_of = std::max<std::size_t>(1, (mesh.tets.size() + most - 1) / std::max<std::size_t>(1, most));
  // A number's multiple of the golden ratio spreads what is kept evenly over the mesh's own order.
  std::vector<std::int32_t> kept;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    if (packed.one_of == 1 || static_cast<std::uint32_t>(t * 2654435769u) <= 0xffffffffu / packed.one_of)
      kept.push_back(static_cast<std::int32_t>(t));

  std::vector<GridCell> points;
  std::vector<std::int32_t> new_point(mesh.points.size(), -1);
  for (const std::int32_t t : kept)
    for (const std::int32_t v : mesh.tets[t])
      if (new_point[v] < 0) {
        new_point[v] = static_cast<std::int32_t>(points.size());
        points.push_back(on_grid(mesh.points[v], grid));
      }
  const std::vector<std::int32_t> order = curve_order(points), place = inverse(order);

  struct DrawnTet {
    std::array<std::int32_t, 4> v;
    std::int32_t label;
    std::uint8_t angle;
  };
  std::vector<DrawnTet> tets(kept.size());
  constexpr std::size_t kChunk = 1 << 13;
  parallel_for((kept.size() + kChunk - 1) / kChunk, threads, [&](std::size_t chunk) {
    for (std::size_t i = chunk * kChunk; i < std::min(kept.size(), (chunk + 1) * kChunk); ++i) {
      const auto& v = mesh.tets[kept[i]];
      DrawnTet& t = tets[i];
      for (int k = 0; k < 4; ++k) t.v[k] = place[new_point[v[k]]];
      std::sort(t.v.begin(), t.v.end());
      t.label = index(mesh.labels[kept[i]]);
      const auto cosines = dihedral_cosines(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]]);
      t.angle = angle_step(57.295779513082320877 *
                           std::acos(std::clamp(*std::max_element(cosines.begin(), cosines.end()), -1.0, 1.0)));
    }
  });
  std::stable_sort(tets.begin(), tets.end(), [](const DrawnTet& a, const DrawnTet& b) { return a.v < b.v; });
  Bytes corners, labels, angles;
  std::int32_t last = 0;
  for (const DrawnTet& t : tets) {
    corners.number(static_cast<std::uint64_t>(t.v[0] - last));
    for (int k = 1; k < 4; ++k) corners.number(static_cast<std::uint64_t>(t.v[k] - t.v[k - 1]));
    last = t.v[0];
    labels.number(static_cast<std::uint64_t>(t.label));
    angles.byte(t.angle);
  }
  packed.vertices = points.size();
  packed.elements = tets.size();
  packed.names = {"positions", "tets", "labels", "angles"};
  packed.chunks = {pack_positions(points, order), std::move(corners.text), std::move(labels.text),
                   std::move(angles.text)};
  return packed;
}

}  // namespace stackmesh
