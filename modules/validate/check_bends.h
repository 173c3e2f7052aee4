#pragma once
#include <cstddef>
#include <vector>

#include "model/complex.h"

namespace stackmesh {

/// How rough a surface is: the angles between the normals of triangles that continue each other across an edge. 0 is
/// flat, 180 a fold upon itself. NaN where there are no such edges.
struct Bends {
  std::size_t edges = 0;      ///< between triangles that continue each other
  double mean_deg = 0;        ///< weighted by the length of the edge
  double above_40_share = 0;  ///< of the edges, by number: those that bend by more than 40 degrees
};

/// How rough one label's surface is.
struct LabelBends {
  Label label = 0;  ///< never the background
  Bends bends;      ///< of its whole surface, whatever lies on the other side
};

/// How rough a complex is.
struct BendCheck {
  Bends surface;                   ///< every pair of neighbours once, also where two labels share it
  std::vector<LabelBends> labels;  ///< ascending, without 0
};

/// Measures the bends of each label's surface, and of all together. Where a label touches itself along an edge, the
/// sides that bound the same solid are neighbours; triangles without area are left out. Does not depend on the number
/// of threads (0: all).
/// @throws Error(input) as check_surface does.
BendCheck check_bends(const InterfaceComplex& complex, int threads = 0);

}  // namespace stackmesh
