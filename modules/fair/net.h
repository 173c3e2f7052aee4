#pragma once
// The surface net of all label interfaces. Internal to the module.
#include <array>
#include <cstdint>
#include <vector>

#include "model/label_volume.h"
#include "model/slices.h"

namespace stackmesh::fair {

using Float3 = std::array<float, 3>;

/// A vertex of the net lies in a cell of the dual grid: the box between the eight voxel centres (x-1 | x, y-1 | y, z-1
/// | z) in the stack's axes, which is the pixel corner (x, y) between the slices z - 1 and z.
struct Cell {
  std::int32_t x, y, z;
};
inline bool operator==(const Cell& a, const Cell& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

/// Directions to neighbouring cells: -x, +x, -y, +y, -z, +z; d ^ 1 is the opposite one.
constexpr int kDirections = 6;

/// The surface net of all labels (\cite gibson1998): a vertex for every sheet that passes a cell, a quad across every
/// edge between two voxel centres of different labels. Where voxels touch by a corner, the rule of docs/contours.md
/// decides which sheets pass the cell; each has a vertex of its own, as in dual marching cubes (\cite nielson2004).
/// Beyond the image's border its outermost voxels go on, so the net is open there.
struct Net {
  std::array<double, 3> spacing_mm = {1, 1, 1};  ///< of the voxels, along the stack's axes
  std::array<int, 3> size = {0, 0, 0};           ///< voxels along the stack's axes
  std::vector<Cell> cell;                        ///< of each vertex; ascending (z, y, x)
  /// edges of the cell that the vertex's sheet crosses: bit 4 axis + p + 2 q for the edge along `axis` at sides p of
  /// the next axis and q of the one after it
  std::vector<std::uint16_t> crossed;
  std::vector<std::size_t> slab_start;                      ///< first vertex of slab z; size[2] + 2 entries
  std::vector<std::array<std::int32_t, kDirections>> next;  ///< neighbours along net edges; -1: none
  /// bit d: the vertex is to lie evenly between its neighbours in these directions
  std::vector<std::uint8_t> uses;
  std::vector<std::uint8_t> curve;  ///< 1: three labels or more meet at the vertex
  std::vector<Float3> low, high;    ///< bounds of the vertex's way from the cell's middle, in voxels
  std::vector<Float3> way;          ///< from the cell's middle to the vertex, in voxels

  struct Quad {
    /// around the edge from a voxel centre to the next one along `axis`, anticlockwise seen from there
    std::array<std::int32_t, 4> corner;
    std::uint8_t axis;
    std::uint16_t low, high;  ///< palette index of the label on either side
  };
  std::vector<Quad> quads;
};

struct NetOptions {
  double band_px = 0.5;   ///< how far a vertex may leave the middle of its cell within the slices' planes, in pixels
  double thin_px = 0.1;   ///< room that each of two sheets keeps to the middle between them, where they are near
  double split_px = 0.1;  ///< room between two sheets of one cell, on either side of its middle
  int period = 1;         ///< every period-th slice is real, those between are interpolated
  double virtual_band_px = 0.5;    ///< band of cells that touch no real slice
  double virtual_band_gaps = 0.5;  ///< the same along the stacking axis, in gaps, away from real slices
  int threads = 0;
};

Net build_net(const LabelVolume& volume, const StackAxes& axes, const NetOptions& options);

struct BendOptions {
  int iterations = 100;
  int threads = 0;
};

/// Moves the vertices to where the net bends least, each within its bounds.
void bend_least(Net& net, const BendOptions& options);

/// Shifts the net along its normals so that the volume on either side is locally what the voxels hold.
/// @param reach steps of averaging along the net
void restore_local_volumes(Net& net, int reach, int rounds, int threads);

}  // namespace stackmesh::fair
