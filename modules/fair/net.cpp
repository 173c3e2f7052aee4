#include "fair/net.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "fair/cell_sheets.h"
#include "model/voxel_components.h"

namespace stackmesh::fair {
namespace {

constexpr float kInside = 0.499F;  // strictly inside of a cell

/// Labels around a cell: at(a, b, c) of the voxel (x - 1 + a, y - 1 + b, z - 1 + c); the outermost voxels go on beyond
/// the border.
class Surroundings {
 public:
  Surroundings(const LabelVolume& volume, const StackAxes& axes) : voxels_(volume.voxels.data()) {
    const std::array<std::size_t, 3> stride = {1, static_cast<std::size_t>(volume.size[0]),
                                               static_cast<std::size_t>(volume.size[0]) * volume.size[1]};
    stride_ = {stride[axes.u], stride[axes.v], stride[axes.w]};
    size_ = {volume.size[axes.u], volume.size[axes.v], volume.size[axes.w]};
  }
  std::uint16_t operator()(int x, int y, int z) const {
    return voxels_[std::clamp(x, 0, size_[0] - 1) * stride_[0] + std::clamp(y, 0, size_[1] - 1) * stride_[1] +
                   std::clamp(z, 0, size_[2] - 1) * stride_[2]];
  }
  const std::array<int, 3>& size() const { return size_; }

 private:
  const std::uint16_t* voxels_;
  std::array<std::size_t, 3> stride_;
  std::array<int, 3> size_;
};

/// The distinct labels on either side of the edges of a set.
struct LabelSet {
  std::array<std::uint16_t, 8> label;
  int count = 0;
  void add(std::uint16_t l) {
    if (std::find(label.begin(), label.begin() + count, l) == label.begin() + count) label[count++] = l;
  }
};

LabelSet labels_at(const CellLabels& label, std::uint16_t edges) {
  LabelSet out;
  for (int axis = 0; axis < 3; ++axis)
    for (int p = 0; p < 2; ++p)
      for (int q = 0; q < 2; ++q)
        if (edges >> cell_edge(axis, p, q) & 1) {
          out.add(label[cell_corner(axis, 0, p, q)]);
          out.add(label[cell_corner(axis, 1, p, q)]);
        }
  return out;
}

/// The edges of one side of the cell as those of the other side, which the neighbour there has in common.
std::uint16_t seen_from_neighbour(std::uint16_t edges, int axis, int side) {
  std::uint16_t out = 0;
  const int p = (axis + 1) % 3, q = (axis + 2) % 3;
  for (int k = 0; k < 2; ++k) {
    if (edges >> cell_edge(p, k, side) & 1) out |= static_cast<std::uint16_t>(1 << cell_edge(p, k, 1 - side));
    if (edges >> cell_edge(q, side, k) & 1) out |= static_cast<std::uint16_t>(1 << cell_edge(q, 1 - side, k));
  }
  return out;
}

/// Where the middles of a sheet's edges lie on average, from the cell's middle, in voxels.
Float3 middle_of(std::uint16_t edges) {
  Float3 sum = {0, 0, 0};
  for (int axis = 0; axis < 3; ++axis)
    for (int p = 0; p < 2; ++p)
      for (int q = 0; q < 2; ++q)
        if (edges >> cell_edge(axis, p, q) & 1) {
          sum[(axis + 1) % 3] += static_cast<float>(p) - 0.5F;
          sum[(axis + 2) % 3] += static_cast<float>(q) - 0.5F;
        }
  const float count = static_cast<float>(__builtin_popcount(edges));
  return {sum[0] / count, sum[1] / count, sum[2] / count};
}

class NetBuilder {
 public:
  NetBuilder(const LabelVolume& volume, const StackAxes& axes, const NetOptions& options)
      : volume_(volume), axes_(axes), options_(options), label_(volume, axes), components_(volume, axes) {
    net_.size = label_.size();
    net_.spacing_mm = {volume.spacing_mm[axes.u], volume.spacing_mm[axes.v], volume.spacing_mm[axes.w]};
  }

  Net run() {
    find_vertices();
    const std::size_t n = net_.cell.size();
    net_.next.resize(n);
    net_.uses.resize(n);
    net_.curve.resize(n);
    net_.low.resize(n);
    net_.high.resize(n);
    net_.way.resize(n);
    for_each_index(n, options_.threads, [&](std::size_t v) {
      link(static_cast<std::int32_t>(v));
      set_bounds(static_cast<std::int32_t>(v));
    });
    make_quads();
    return std::move(net_);
  }

 private:
  CellLabels labels_of(const Cell& c) const {
    CellLabels out;
    for (int i = 0; i < 8; ++i) out[i] = label_(c.x - 1 + (i & 1), c.y - 1 + (i >> 1 & 1), c.z - 1 + (i >> 2));
    return out;
  }

  FaceSheets face(const Cell& c, const CellLabels& label, int axis, int side) const {
    return face_sheets(label, axis, side, [&](int diagonal) {
      const auto component = [&](int p, int q) {
        std::array<int, 3> at = {c.x - 1, c.y - 1, c.z - 1};
        at[axis] += side;
        at[(axis + 1) % 3] += p;
        at[(axis + 2) % 3] += q;
        for (int a = 0; a < 3; ++a) at[a] = std::clamp(at[a], 0, net_.size[a] - 1);
        return components_.of(at[0], at[1], at[2]);
      };
      return component(diagonal, 0) == component(1 - diagonal, 1);
    });
  }

  /// The sheets that pass a cell, as sets of its edges; ascending.
  std::vector<std::uint16_t>& sheets_of(const Cell& c, const CellLabels& label, std::vector<std::uint16_t>& out) const {
    out.clear();
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        const FaceSheets f = face(c, label, axis, side);
        for (int g = 0; g < f.count; ++g) {
          std::uint16_t joined = f.edges[g];
          out.erase(std::remove_if(out.begin(), out.end(),
                                   [&](std::uint16_t s) {
                                     const bool meets = (s & joined) != 0;
                                     if (meets) joined |= s;
                                     return meets;
                                   }),
                    out.end());
          // What was joined before may meet what was joined since.
          for (std::size_t k = 0; k < out.size();)
            if ((out[k] & joined) != 0) {
              joined |= out[k];
              out.erase(out.begin() + static_cast<std::ptrdiff_t>(k));
              k = 0;
            } else {
              ++k;
            }
          out.push_back(joined);
        }
      }
    std::sort(out.begin(), out.end());
    return out;
  }

  /// Slab z lies between the slices z - 1 and z.
  void find_vertices() {
    // clang takes no bindings into a lambda
    const int width = net_.size[0], height = net_.size[1], slices = net_.size[2];
    const int slabs = slices + 1;
    std::vector<std::vector<std::pair<Cell, std::uint16_t>>> found(slabs);
    const int step = slices_at_once(volume_, axes_, options_.threads);
    parallel_for((slabs + step - 1) / step, options_.threads, [&](std::size_t block) {
      const int first = static_cast<int>(block) * step, last = std::min(slabs, first + step);
      const int begin = std::clamp(first - 1, 0, slices - 1), end = std::min(slices, last);
      const std::vector<Slice> read = read_slices(volume_, axes_, begin, std::max(end, begin + 1));
      std::vector<std::uint16_t> mixed(width), sheets;
      for (int z = first; z < last; ++z) {
        const std::uint16_t* lower = read[std::clamp(z - 1, 0, slices - 1) - begin].pixels.data();
        const std::uint16_t* upper = read[std::clamp(z, 0, slices - 1) - begin].pixels.data();
        for (int y = 0; y <= height; ++y) {
          const std::size_t row0 = static_cast<std::size_t>(std::max(y - 1, 0)) * width;
          const std::size_t row1 = static_cast<std::size_t>(std::min(y, height - 1)) * width;
          const std::uint16_t *a = lower + row0, *b = lower + row1, *c = upper + row0, *d = upper + row1;
          std::uint16_t any = 0;
          for (int x = 0; x < width; ++x) {
            mixed[x] = static_cast<std::uint16_t>((a[x] ^ b[x]) | (a[x] ^ c[x]) | (a[x] ^ d[x]));
            any |= static_cast<std::uint16_t>(mixed[x] | (a[x] ^ a[0]));
          }
          if (any == 0) continue;
          for (int x = 0; x <= width; ++x) {
            const int l = std::max(x - 1, 0), r = std::min(x, width - 1);
            if ((mixed[l] | mixed[r] | (a[l] ^ a[r])) == 0) continue;
            const Cell cell = {x, y, z};
            for (std::uint16_t s : sheets_of(cell, {a[l], a[r], b[l], b[r], c[l], c[r], d[l], d[r]}, sheets))
              found[z].push_back({cell, s});
          }
        }
      }
    });
    net_.slab_start.assign(1, 0);
    for (const auto& f : found) net_.slab_start.push_back(net_.slab_start.back() + f.size());
    net_.cell.reserve(net_.slab_start.back());
    net_.crossed.reserve(net_.slab_start.back());
    for (auto& f : found) {
      for (const auto& [cell, sheet] : f) {
        net_.cell.push_back(cell);
        net_.crossed.push_back(sheet);
      }
      std::vector<std::pair<Cell, std::uint16_t>>().swap(f);
    }
    index_rows();
  }

  void index_rows() {
    row_start_.assign(static_cast<std::size_t>(net_.size[2] + 1) * (net_.size[1] + 1) + 1, 0);
    for (const Cell& c : net_.cell) ++row_start_[row_of(c) + 1];
    for (std::size_t r = 1; r < row_start_.size(); ++r) row_start_[r] += row_start_[r - 1];
  }
  std::size_t row_of(const Cell& c) const { return static_cast<std::size_t>(c.z) * (net_.size[1] + 1) + c.y; }

  /// The vertex of a cell whose sheet crosses one of the edges; -1: none.
  std::int32_t find(const Cell& c, std::uint16_t edges) const {
    const std::size_t row = row_of(c);
    const auto begin = net_.cell.begin() + row_start_[row], end = net_.cell.begin() + row_start_[row + 1];
    auto it = std::lower_bound(begin, end, c.x, [](const Cell& p, std::int32_t x) { return p.x < x; });
    for (; it != end && it->x == c.x; ++it)
      if (const std::ptrdiff_t v = it - net_.cell.begin(); net_.crossed[v] & edges) return static_cast<std::int32_t>(v);
    return -1;
  }

  void link(std::int32_t v) {
    const Cell c = net_.cell[v];
    const std::uint16_t crossed = net_.crossed[v];
    const CellLabels label = labels_of(c);
    net_.curve[v] = labels_at(label, crossed).count > 2;
    const std::array<int, 3> at = {c.x, c.y, c.z};
    std::uint8_t uses = 0, along = 0;
    for (int d = 0; d < kDirections; ++d) {
      net_.next[v][d] = -1;
      const int axis = d / 2, side = d & 1;
      if (at[axis] == (side ? net_.size[axis] : 0)) continue;  // the net is open at the border
      const FaceSheets f = face(c, label, axis, side);
      for (int g = 0; g < f.count; ++g) {
        if (!(f.edges[g] & crossed) || net_.next[v][d] >= 0) continue;
        Cell to = c;
        (axis == 0 ? to.x : axis == 1 ? to.y : to.z) += side ? 1 : -1;
        net_.next[v][d] = find(to, seen_from_neighbour(f.edges[g], axis, side));
        uses |= static_cast<std::uint8_t>(1 << d);
        if (labels_at(label, f.edges[g]).count > 2) along |= static_cast<std::uint8_t>(1 << d);
      }
    }
    // A vertex of a curve between three labels lies evenly along the curve; where curves meet, nothing is asked of it.
    if (net_.curve[v]) uses = __builtin_popcount(along) == 2 ? along : 0;
    net_.uses[v] = uses;
  }

  bool real_slice(int z) const { return z % options_.period == 0; }

  bool shares_cell(std::int32_t v) const {
    const std::size_t i = static_cast<std::size_t>(v);
    return (i > 0 && net_.cell[i - 1] == net_.cell[i]) ||
           (i + 1 < net_.cell.size() && net_.cell[i + 1] == net_.cell[i]);
  }

  void set_bounds(std::int32_t v) {
    const Cell c = net_.cell[v];
    const std::array<int, 3> at = {c.x, c.y, c.z};
    const bool real_below = real_slice(std::clamp(c.z - 1, 0, net_.size[2] - 1)),
               real_above = real_slice(std::clamp(c.z, 0, net_.size[2] - 1));
    const float plane = std::max(
        kInside, static_cast<float>(real_below || real_above ? options_.band_px : options_.virtual_band_px) - 0.001F);
    const float along = std::max(kInside, static_cast<float>(options_.virtual_band_gaps));
    Float3 low = {-plane, -plane, real_below ? -kInside : -along}, high = {plane, plane, real_above ? kInside : along},
           start = {0, 0, 0};
    keep_room(c, low, high);
    if (shares_cell(v)) {  // each sheet stays on its side of the cell
      const Float3 middle = middle_of(net_.crossed[v]);
      const float room = static_cast<float>(options_.split_px);
      for (int a = 0; a < 3; ++a) {
        start[a] = middle[a];
        if (middle[a] > 0.1F) low[a] = std::max(low[a], -room);
        if (middle[a] < -0.1F) high[a] = std::min(high[a], room);
      }
    }
    for (int a = 0; a < 3; ++a) {
      if (at[a] == 0 || at[a] == net_.size[a]) low[a] = high[a] = 0;  // the border cuts flat
      start[a] = std::clamp(start[a], low[a], high[a]);
    }
    net_.low[v] = low;
    net_.high[v] = high;
    net_.way[v] = start;
  }

  /// Where a label is only a few voxels thick, the sheets on either side of it share the room fairly: along every
  /// direction into the cell's voxels each may go half of the way to the next sheet, less the room that it keeps.
  void keep_room(const Cell& c, Float3& low, Float3& high) const {
    const float room = static_cast<float>(options_.thin_px);
    const bool wide = high[0] > 0.5F;
    const int longest = static_cast<int>(std::ceil(2 * (std::max({high[0], high[2], -low[2]}) + room)));
    for (int corner = 0; corner < 8; ++corner) {
      const std::array<int, 3> voxel = {c.x - 1 + (corner & 1), c.y - 1 + (corner >> 1 & 1), c.z - 1 + (corner >> 2)};
      const std::uint16_t own = label_(voxel[0], voxel[1], voxel[2]);
      for (int axes = 1; axes < 8; ++axes) {  // directions from the voxel into the cell
        std::array<int, 3> step;
        for (int a = 0; a < 3; ++a) step[a] = (axes >> a & 1) == 0 ? 0 : (corner >> a & 1) ? -1 : 1;
        if (label_(voxel[0] + step[0], voxel[1] + step[1], voxel[2] + step[2]) == own) continue;
        int thick = 1;  // voxels of the label from here on, away from the cell
        while (thick < longest &&
               label_(voxel[0] - thick * step[0], voxel[1] - thick * step[1], voxel[2] - thick * step[2]) == own)
          ++thick;
        if (thick == longest) continue;
        const float share = 0.5F * static_cast<float>(thick) - room;
        for (int a = 0; a < 3; ++a) {
          if (wide && a != 2 && step[2] != 0) continue;  // slices that jitter do not make a label thin
          if (step[a] > 0) low[a] = std::max(low[a], -share);
          if (step[a] < 0) high[a] = std::min(high[a], share);
        }
      }
    }
  }

  /// The quads of the voxel edges at the far side of each cell.
  void make_quads() {
    const std::size_t slabs = net_.slab_start.size() - 1;
    std::vector<std::vector<Net::Quad>> made(slabs);
    parallel_for(slabs, options_.threads, [&](std::size_t z) {
      for (std::size_t v = net_.slab_start[z]; v < net_.slab_start[z + 1]; ++v) {
        const Cell c = net_.cell[v];
        for (int axis = 0; axis < 3; ++axis) {
          std::array<int, 3> from = {c.x, c.y, c.z};
          from[axis] -= 1;
          if (from[0] < 0 || from[1] < 0 || from[2] < 0) continue;
          std::array<int, 3> to = {c.x, c.y, c.z};
          if (to[0] >= net_.size[0] || to[1] >= net_.size[1] || to[2] >= net_.size[2]) continue;
          const std::uint16_t low = label_(from[0], from[1], from[2]), high = label_(to[0], to[1], to[2]);
          if (low == high) continue;
          // The four cells around the voxel edge, which is at their far, near sides of the other two axes.
          const int p = (axis + 1) % 3, q = (axis + 2) % 3;
          if (!(net_.crossed[v] >> cell_edge(axis, 1, 1) & 1)) continue;
          Cell cells[3] = {c, c, c};
          const auto step = [](Cell& cell, int along) { ++(along == 0 ? cell.x : along == 1 ? cell.y : cell.z); };
          step(cells[0], p);
          step(cells[1], p);
          step(cells[1], q);
          step(cells[2], q);
          const std::int32_t b = find(cells[0], 1 << cell_edge(axis, 0, 1)),
                             m = find(cells[1], 1 << cell_edge(axis, 0, 0)),
                             d = find(cells[2], 1 << cell_edge(axis, 1, 0));
          if (b < 0 || m < 0 || d < 0) continue;
          made[z].push_back({{static_cast<std::int32_t>(v), b, m, d}, static_cast<std::uint8_t>(axis), low, high});
        }
      }
    });
    std::size_t total = 0;
    for (const auto& quads : made) total += quads.size();
    net_.quads.reserve(total);
    for (auto& quads : made) {
      net_.quads.insert(net_.quads.end(), quads.begin(), quads.end());
      std::vector<Net::Quad>().swap(quads);
    }
  }

  const LabelVolume& volume_;
  const StackAxes axes_;
  const NetOptions& options_;
  const Surroundings label_;
  const VoxelComponents components_;
  Net net_;
  std::vector<std::int32_t> row_start_;  // first vertex of every row of cells
};

}  // namespace

Net build_net(const LabelVolume& volume, const StackAxes& axes, const NetOptions& options) {
  return NetBuilder(volume, axes, options).run();
}

}  // namespace stackmesh::fair
