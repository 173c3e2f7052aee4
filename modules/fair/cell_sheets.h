#pragma once
// Which sheets pass a cell of eight voxel centres. Internal to the module.
#include <array>
#include <cstdint>

#include "model/corner_rule.h"

namespace stackmesh::fair {

/// Labels at the corners of a cell: corner a + 2 b + 4 c is on side a of x, b of y, c of z.
using CellLabels = std::array<std::uint16_t, 8>;

/// The edge of a cell along `axis`, on side p of the next axis and q of the one after it.
constexpr int cell_edge(int axis, int p, int q) {
  return 4 * axis + p + 2 * q;
}

/// The corner of a cell on sides a, p, q of `axis`, the next axis and the one after it.
constexpr int cell_corner(int axis, int a, int p, int q) {
  return (a << axis) | (p << (axis + 1) % 3) | (q << (axis + 2) % 3);
}

/// The edges between different labels of one face, in the groups that meet within the face: one group, or two where a
/// diagonal of the face is joined.
struct FaceSheets {
  int count = 0;
  /// of the cell; of two groups, the one around the corner with side 0 of q comes first
  std::array<std::uint16_t, 2> edges = {0, 0};
};

/// @param same(diagonal): do the two voxels of the rising (0) or falling (1) diagonal hang together elsewhere?
template <class SameComponent>
FaceSheets face_sheets(const CellLabels& label, int axis, int side, SameComponent same) {
  const int p = (axis + 1) % 3, q = (axis + 2) % 3;
  const std::uint16_t l00 = label[cell_corner(axis, side, 0, 0)], l10 = label[cell_corner(axis, side, 1, 0)],
                      l01 = label[cell_corner(axis, side, 0, 1)], l11 = label[cell_corner(axis, side, 1, 1)];
  // Sides of an edge along p are those of (q, axis), along q of (axis, p).
  const std::uint16_t p0 = 1 << cell_edge(p, 0, side), p1 = 1 << cell_edge(p, 1, side);
  const std::uint16_t q0 = 1 << cell_edge(q, side, 0), q1 = 1 << cell_edge(q, side, 1);
  FaceSheets out;
  if (l00 != l10 && l01 != l11 && l00 != l01 && l10 != l11) {
    const JoinedDiagonal joined = joined_diagonal(l00, l10, l01, l11, same);
    if (joined != JoinedDiagonal::none) {
      out.count = 2;
      out.edges =
          joined == JoinedDiagonal::rising
              ? std::array<std::uint16_t, 2>{static_cast<std::uint16_t>(p0 | q1), static_cast<std::uint16_t>(p1 | q0)}
              : std::array<std::uint16_t, 2>{static_cast<std::uint16_t>(p0 | q0), static_cast<std::uint16_t>(p1 | q1)};
      return out;
    }
  }
  const std::uint16_t all = static_cast<std::uint16_t>((l00 != l10 ? p0 : 0) | (l01 != l11 ? p1 : 0) |
                                                       (l00 != l01 ? q0 : 0) | (l10 != l11 ? q1 : 0));
  if (all != 0) out.count = 1;
  out.edges[0] = all;
  return out;
}

}  // namespace stackmesh::fair
