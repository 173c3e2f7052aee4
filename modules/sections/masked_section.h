#pragma once
// Sections of drawn contours whose regions know every label that covers them: internal to the module.
#include <bitset>
#include <cstdint>
#include <functional>
#include <vector>

#include "model/edge_grid.h"
#include "sections/drawn_level.h"

namespace stackmesh {

/// The most labels that can be drawn as contours at once.
constexpr std::size_t kMostDrawnLabels = 256;

/// One bit for each contour file: whether a region lies inside its contours.
using LabelMask = std::bitset<kMostDrawnLabels>;

/// A section whose sides know all labels that cover them; which of them wins is decided later.
struct MaskedSection {
  struct Edge {
    std::int32_t a, b;  ///< indices of `section.points`
    LabelMask left, right;
  };
  Section section;  ///< its height and points (grid units); its edges have no labels yet and are not in it
  std::vector<Edge> edges;
};

/// What a part of a region is covered by, and its area in grid units squared.
using VisitArea = std::function<void(const LabelMask& mask, double area)>;

/// Makes `out.section.points` and `out.edges` of the contours' segments (\cite wang2005, 3.1): the segments are noded
/// by snap rounding, regions are grown in a constrained triangulation without crossing an edge, and the labels that
/// cover them are found from the outside in. A segment that a label walks twice counts as none.
/// @param sources the contour of each segment
/// @param visit is called for every triangle, in the order of the triangulation
/// @throws Error(internal) where the triangulation lacks an edge
void mask_regions(std::vector<GridSegment> segments, const std::vector<SourceSegment>& sources, MaskedSection& out,
                  const VisitArea& visit);

}  // namespace stackmesh
