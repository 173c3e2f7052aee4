#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "model/stack.h"

namespace stackmesh {

constexpr std::int32_t kGridPerPixel = 1024;  ///< grid units in a pixel

/// A slice of palette indices, rows along y.
struct Slice {
  int width = 0, height = 0;
  std::vector<std::uint16_t> pixels;
  std::uint16_t at(int x, int y) const {
    return x < 0 || y < 0 || x >= width || y >= height ? 0 : pixels[static_cast<std::size_t>(y) * width + x];
  }
};

/// A vertex of a crack contour: the pixel corner (x, y), and where it is drawn.
struct CrackVertex {
  std::int32_t x, y;
  GridPoint position;
  bool keep = false;  ///< simplification must not drop it
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
  std::vector<std::uint64_t>
      keep;  ///< keys (components.h) of corners that simplification must not drop, ascending
};

/// The crack contours of all labels of a slice as shared arcs. Where pixels touch by a corner only, one fixed
/// rule decides (docs/contours.md): the background joins; else a label whose two pixels hang together
/// elsewhere in the volume; else the corner stays a junction.
SliceArcs trace_arcs(const Slice& slice, const CornerRules& rules);

/// Simplifies arcs with tolerance (pixels); see extract_sections. Returns each arc's kept vertices.
std::vector<std::vector<GridPoint>> simplify_arcs(const std::vector<Arc>& arcs, double tolerance_px);

/// The same for arcs whose vertices lie anywhere; tolerance in grid units. Only crossings are looked after.
std::vector<std::vector<GridPoint>> simplify_free_arcs(const std::vector<Arc>& arcs, double tolerance);

}  // namespace stackmesh
