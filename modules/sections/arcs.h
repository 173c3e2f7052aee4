#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "model/faired_labels.h"
#include "model/slices.h"
#include "model/stack.h"
#include "sections/components.h"
#include "sections/extract.h"

namespace stackmesh {

/// A vertex of a crack contour: the pixel corner (x, y), and where it is drawn.
struct CrackVertex {
  std::int32_t x, y;
  GridPoint position;
  bool keep = false;    ///< simplification must not drop it
  GridPoint home = {};  ///< where it lies when it is not faired
};

/// A piece of contour between two junctions, or a closed loop (first vertex == last vertex), with one label
/// on its left and one on its right throughout.
struct Arc {
  std::vector<CrackVertex> chain;
  std::uint16_t left = 0, right = 0;
  bool closed = false;
};

struct SliceArcs {
  std::vector<Arc> arcs;
  std::size_t loops = 0;  ///< closed borders found
};

/// How corners are treated.
struct CornerRules {
  /// True when two pixels of a label that touch by a corner hang together elsewhere in the volume.
  std::function<bool(int xa, int ya, int xb, int yb)> same_component;
  bool part = false;  ///< draw contours that pass a corner on both sides a quarter pixel apart
  /// corners that are drawn back from what they touch, that are not faired and that simplification must not drop,
  /// ascending
  std::vector<TouchingCorner> keep;
  bool hold = false;  ///< faired corners stay within half a pixel of where they were
  const std::vector<FairedLabels::Corner>* faired = nullptr;  ///< where the other corners are drawn; needs `part`
};

/// The crack contours of all labels of a slice as shared arcs. Where pixels touch by a corner only, one fixed
/// rule decides (docs/contours.md): the background joins; else a label whose two pixels hang together
/// elsewhere in the volume; else the corner stays a junction. A label that would touch itself there is parted by a
/// short contour between the two other labels, if these differ.
SliceArcs trace_arcs(const Slice& slice, const CornerRules& rules);

/// Draws vertices of faired arcs back to their homes, half of the way at a time, until no two edges meet elsewhere than
/// in common end points. Edges between homes never do. @return how many vertices were drawn back
std::size_t untangle(std::vector<Arc>& arcs);

/// Simplifies arcs with tolerance (pixels); see extract_sections. Returns each arc's kept vertices.
/// @param longest_px edges of several vertices are no longer than about this; 0: no limit
std::vector<std::vector<GridPoint>> simplify_arcs(const std::vector<Arc>& arcs, double tolerance_px,
                                                  double longest_px = 0);

/// The same for arcs whose vertices lie anywhere; tolerance in grid units. Only crossings are looked after.
std::vector<std::vector<GridPoint>> simplify_free_arcs(const std::vector<Arc>& arcs, double tolerance,
                                                       double longest_px = 0);

}  // namespace stackmesh
