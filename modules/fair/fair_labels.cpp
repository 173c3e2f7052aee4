#include "fair/fair_labels.h"

#include <algorithm>

#include "base/parallel.h"
#include "fair/cell_sheets.h"
#include "fair/net.h"

namespace stackmesh {
namespace {

using namespace fair;

constexpr double kVirtualBand_px = 1, kVirtualBand_gaps = 1.5;  // of slices that are a guess only
constexpr int kReach = 40, kRounds = 2;                         // of restoring volumes: steps of averaging, rounds
// of two contours that pass a corner, from the diagonal between them (times the root of 2), in pixels
constexpr float kApart = 0.1F;

/// Moves a vertex to its own side of the diagonal between two contours; (sx, sy) points there.
void keep_apart(FairedLabels::Corner& c, float sx, float sy) {
  const float missing = kApart - (sx * c.dx + sy * c.dy);
  if (missing <= 0) return;
  c.dx += 0.5F * missing * sx;
  c.dy += 0.5F * missing * sy;
}

/// The vertices of the contours of slice z: where the net's edges across the slice cut its plane.
std::vector<FairedLabels::Corner> cut_at(const Net& net, int z) {
  // The edges of the face that a cell has in the slice: along x at y - 1 and y, along y at x - 1 and x.
  constexpr std::uint16_t x0 = 1 << cell_edge(0, 0, 1), x1 = 1 << cell_edge(0, 1, 1), y0 = 1 << cell_edge(1, 1, 0),
                          y1 = 1 << cell_edge(1, 1, 1);
  std::vector<FairedLabels::Corner> out;
  for (std::size_t v = net.slab_start[z]; v < net.slab_start[z + 1]; ++v) {
    const std::int32_t w = net.next[v][5];
    if (w < 0) continue;
    // the plane is at 0
    const float from = -0.5F + std::clamp(net.way[v][2], -0.499F, 0.499F),
                to = 0.5F + std::clamp(net.way[w][2], -0.499F, 0.499F);
    const float share = -from / (to - from);
    FairedLabels::Corner c = {net.cell[v].x, net.cell[v].y, FairedLabels::Corner::whole,
                              net.way[v][0] + share * (net.way[w][0] - net.way[v][0]),
                              net.way[v][1] + share * (net.way[w][1] - net.way[v][1])};
    const std::uint16_t crossed = net.crossed[v] & (x0 | x1 | y0 | y1);
    const auto parted = [&](std::uint16_t edges) {  // does another contour pass the other two edges?
      const auto other = [&](std::size_t k) {
        return k < net.cell.size() && net.cell[k] == net.cell[v] &&
               (net.crossed[k] & (x0 | x1 | y0 | y1) & ~edges) != 0;
      };
      return crossed == edges && (other(v - 1) || other(v + 1));
    };
    const auto emit = [&](FairedLabels::Corner::Part part, float sx, float sy) {
      FairedLabels::Corner k = c;
      k.part = part;
      keep_apart(k, sx, sy);
      out.push_back(k);
    };
    if (parted(x0 | y1)) emit(FairedLabels::Corner::south, 1, -1);
    else if (parted(x1 | y0)) emit(FairedLabels::Corner::north, -1, 1);
    else if (parted(x0 | y0)) emit(FairedLabels::Corner::south, -1, -1);
    else if (parted(x1 | y1)) emit(FairedLabels::Corner::north, 1, 1);
    else out.push_back(c);
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) {
    return a.y != b.y ? a.y < b.y : a.x != b.x ? a.x < b.x : a.part < b.part;
  });
  return out;
}

/// The quads of the net as triangles, each cut along its shorter diagonal.
InterfaceComplex surface_of(const Net& net, const LabelVolume& volume, int threads) {
  InterfaceComplex out;
  out.points.resize(net.cell.size());
  for_each_index(net.cell.size(), threads, [&](std::size_t v) {
    const Cell& c = net.cell[v];
    const Float3& w = net.way[v];
    out.points[v] = {(c.x + static_cast<double>(w[0])) * net.spacing_mm[0],
                     (c.y + static_cast<double>(w[1])) * net.spacing_mm[1],
                     (c.z - 0.5 + static_cast<double>(w[2])) * net.spacing_mm[2]};
  });
  out.triangles.resize(2 * net.quads.size());
  for_each_index(net.quads.size(), threads, [&](std::size_t i) {
    const Net::Quad& q = net.quads[i];
    const auto& k = q.corner;
    const Label low = volume.labels[q.low].number, high = volume.labels[q.high].number;
    const bool first = norm(out.points[k[0]] - out.points[k[2]]) <= norm(out.points[k[1]] - out.points[k[3]]);
    out.triangles[2 * i] =
        first ? InterfaceTriangle{{k[0], k[1], k[2]}, low, high} : InterfaceTriangle{{k[1], k[2], k[3]}, low, high};
    out.triangles[2 * i + 1] =
        first ? InterfaceTriangle{{k[0], k[2], k[3]}, low, high} : InterfaceTriangle{{k[1], k[3], k[0]}, low, high};
  });
  return out;
}

}  // namespace

FairedLabels fair_labels(const LabelVolume& volume, int stacking_axis, const FairOptions& options, Monitor&) {
  NetOptions n;
  n.band_px = options.band_px;
  n.virtual_band_px = std::max(options.band_px, kVirtualBand_px);
  n.virtual_band_gaps = kVirtualBand_gaps;
  n.period = options.virtual_per_gap + 1;
  n.threads = options.threads;
  Net net = build_net(volume, axes_for(stacking_axis), n);
  BendOptions bend;
  bend.threads = options.threads;
  // The further vertices may go, the longer the waves that have to be evened out.
  const double wide = 2 * std::max(options.band_px, 0.5);
  bend.iterations = static_cast<int>((n.period > 1 ? 2 : 1) * wide * bend.iterations);
  bend_least(net, bend);
  restore_local_volumes(net, static_cast<int>(wide * kReach), kRounds, options.threads);
  FairedLabels out;
  for (int z = 0; z < net.size[2]; ++z) out.free.push_back(options.band_px > 0.5 || z % n.period != 0);
  out.slices.resize(net.size[2]);
  parallel_for(out.slices.size(), options.threads,
               [&](std::size_t z) { out.slices[z] = cut_at(net, static_cast<int>(z)); });
  if (options.surface) out.surface = surface_of(net, volume, options.threads);
  return out;
}

}  // namespace stackmesh
