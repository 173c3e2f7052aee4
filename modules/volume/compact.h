#pragma once
#include <cstdint>
#include <set>
#include <vector>

#include "model/complex.h"

namespace stackmesh::volume {

/// The complex as TetGen gets it: used points only, each place once.
struct Compact {
  std::vector<Vec3> points;               // not yet scaled
  std::vector<std::int32_t> original;     // of each point: its index in the complex
  std::vector<std::int32_t> corners;      // three a triangle
  std::vector<InterfaceTriangle> welded;  // the triangles with each place's first point
};

Compact compact(const InterfaceComplex& complex);

/// The triangles around some of the labels; the others become background.
Compact part_of(const Compact& whole, const std::set<Label>& labels);

/// Two sets of labels with about as many triangle sides each, apart along the longest axis; empty when there is nothing
/// to gain. Neighbours in different sets are no obstacle: their common triangles are kept by both.
std::vector<std::set<Label>> halves(const Compact& whole);

}  // namespace stackmesh::volume
