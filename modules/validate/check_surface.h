#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/complex.h"

namespace stackmesh {

/// What the boundary of one label is like.
struct LabelSurface {
  Label label = 0;      ///< never the background
  bool closed = false;  ///< an oriented 2-cycle: every directed edge is matched by its reverse, with multiplicity
  int components = 0;  ///< solid pieces; those that touch at an edge or a vertex only are apart, cavities are no pieces
  long euler = 0;      ///< V - E + F of the boundary, with the vertices of the complex
  long genus = 0;      ///< handles: of all its shells, touching edges and vertices taken apart; 0 unless closed
  double volume_mm3 = 0;              ///< signed, by the divergence theorem: positive when the boundary faces outwards
  double area_mm2 = 0;                ///< of its triangles
  double angle_min_deg = 0;           ///< smallest of its triangles
  std::size_t nonmanifold_edges = 0;  ///< where more than two triangles bound it: it touches itself there
};

/// What a complex is like; angles and edges of an empty one are 0.
struct SurfaceCheck {
  std::size_t vertices = 0;    ///< points of the complex
  std::size_t triangles = 0;   ///< of the complex
  std::size_t open_edges = 0;  ///< undirected edges at which the boundary of some label does not cancel
  /// pairs of triangles that meet beyond what they share, and degenerate triangles; where there are none, pairs of
  /// triangles whose labels contradict each other: sheets that passed through each other at a common edge, pieces in
  /// the wrong label (validate/label_agreement.h)
  std::size_t self_intersections = 0;
  std::size_t nonmanifold_edges = 0;     ///< undirected edges where more than two triangles bound one label
  std::size_t degenerate_triangles = 0;  ///< corners on one line
  double angle_min_deg = 0;              ///< the smallest angle of a triangle: the least over the triangles
  double angle_p1_deg = 0;               ///< its 1st percentile
  double angle_median_deg = 0;           ///< its median
  double edge_min_mm = 0;                ///< shortest edge
  double edge_median_mm = 0;             ///< median of the edges' lengths
  std::vector<LabelSurface> labels;      ///< ascending, without 0
  std::vector<std::array<std::int32_t, 2>>
      intersecting_pairs;                                   ///< triangle numbers, ascending; (t, t): t is degenerate
  std::vector<std::array<std::int32_t, 2>> open_edge_list;  ///< point numbers, ascending
};

/// How a surface is checked.
struct SurfaceCheckOptions {
  int threads = 0;                ///< 0: all of the machine; the result does not depend on it
  std::size_t list_limit = 1000;  ///< longest list of pairs and of edges
};

/// Judges a complex without knowing how it was made. Coordinates in mm, any frame that is right-handed.
/// Orientation tests are exact. @throws Error(input) for an index without a point or a coordinate that is not
/// finite.
SurfaceCheck check_surface(const InterfaceComplex& complex, const SurfaceCheckOptions& options = {});

}  // namespace stackmesh
