#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/disjoint_sets.h"
#include "model/complex.h"

namespace stackmesh {

/// The boundary of one label: the oriented sides of triangles that face out of it.
struct LabelBoundary {
  Label label = 0;
  bool closed = true;  ///< every directed edge is matched by its reverse, with multiplicity
  long vertices = 0, edges = 0, triangles = 0;
  std::size_t nonmanifold_edges = 0;  ///< where more than two of its sides meet
  double volume_mm3 = 0, area_mm2 = 0;
  int outer_pieces = 0;  ///< pieces that enclose a positive volume
  int shells = 0;        ///< pieces, walls of cavities included
  /// Handles of all shells together, by V - E + F of the boundary with edges and vertices where it merely touches
  /// itself taken apart; 0 unless closed.
  long genus = 0;
};

/// Two sides of one label that continue each other across an edge. A side is 2 * triangle + (0 below, 1 above).
struct Neighbours {
  std::int32_t row, side, other;
  std::int32_t edge;  ///< index into `edge_lengths_mm`
  bool first;         ///< no earlier entry is of the same two triangles at this edge
};

/// The boundaries of all labels but 0, and the pieces they fall into: sides joined over edges; where more
/// than two of a label meet at an edge, across the solid between them, so that parts that merely touch stay
/// apart.
struct Boundaries {
  std::vector<LabelBoundary> labels;               ///< ascending by label
  std::vector<std::array<std::int32_t, 2>> row;    ///< per triangle: index into `labels` of below, above; -1: none
  std::vector<std::array<std::int32_t, 2>> piece;  ///< per triangle: piece of its below and above side; -1: none
  std::vector<double> piece_volume_mm3;            ///< signed: negative for the wall of a cavity
  std::vector<std::int32_t> piece_row;
  std::size_t open_edges = 0, nonmanifold_edges = 0;
  std::vector<std::array<std::int32_t, 2>> open_edge_list;  ///< the first `limit`, ascending
  std::vector<double> edge_lengths_mm;                      ///< one per undirected edge
  std::vector<Neighbours> neighbours;                       ///< only when requested
};

/// A triangle between a label and itself bounds nothing. @throws Error(input) for an index without a point or
/// a coordinate that is not finite.
Boundaries find_boundaries(const InterfaceComplex& complex, std::size_t limit, bool neighbours = false);

}  // namespace stackmesh
