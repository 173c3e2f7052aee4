#include "fair/fair_labels.h"

#include <algorithm>

#include "base/parallel.h"
#include "fair/cell_sheets.h"
#include "fair/net.h"

namespace stackmesh {
namespace {

using namespace fair;

constexpr int kReach = 64, kRounds = 2;  // of restoring volumes: steps of averaging, rounds
constexpr float kApart = 0.1F;  // of two contours that pass a corner, from the diagonal between them (times the root of 2), in pixels

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
  constexpr std::uint16_t x0 = 1 << cell_edge(0, 0, 1), x1 = 1 << cell_edge(0, 1, 1), y0 = 1 << cell_edge(1, 1, 0), y1 = 1 << cell_edge(1, 1, 1);
  std::vector<FairedLabels::Corner> out;
  for (std::size_t v = net.slab_start[z]; v < net.slab_start[z + 1]; ++v) {
    const std::int32_t w = net.next[v][5];
    if (w < 0) continue;
    const float from = -0.5F + net.way[v][2], to = 0.5F + net.way[w][2];  // the plane is at 0
    const float share = -from / (to - from);
    FairedLabels::Corner c = {net.cell[v].x, net.cell[v].y, FairedLabels::Corner::whole,
                              net.way[v][0] + share * (net.way[w][0] - net.way[v][0]), net.way[v][1] + share * (net.way[w][1] - net.way[v][1])};
    const std::uint16_t crossed = net.crossed[v] & (x0 | x1 | y0 | y1);
    const auto parted = [&](std::uint16_t edges) {  // does another contour pass the other two edges?
      const auto other = [&](std::size_t k) { return k < net.cell.size() && net.cell[k] == net.cell[v] && (net.crossed[k] & (x0 | x1 | y0 | y1) & ~edges) != 0; };
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

}  // namespace

FairedLabels fair_labels(const LabelVolume& volume, int stacking_axis, const FairOptions& options, Progress&) {
  NetOptions n;
  n.band_px = options.band_px;
  n.period = options.virtual_per_gap + 1;
  n.threads = options.threads;
  Net net = build_net(volume, axes_for(stacking_axis), n);
  BendOptions bend;
  bend.threads = options.threads;
  bend_least(net, bend);
  restore_local_volumes(net, kReach, kRounds, options.threads);
  FairedLabels out;
  out.slices.resize(net.size[2]);
  parallel_for(out.slices.size(), options.threads, [&](std::size_t z) { out.slices[z] = cut_at(net, static_cast<int>(z)); });
  return out;
}

}  // namespace stackmesh
