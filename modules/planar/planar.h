#pragma once
// The plane under two sections: a constrained Delaunay triangulation whose triangles know the label beneath
// and above. For the modules `sections` and `stitch` alone: it is not installed, as it shows CGAL.
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <cstdint>
#include <vector>

#include "model/stack.h"

namespace stackmesh {

/// Which sections an edge of the triangulation belongs to.
enum EdgeOf : std::uint8_t { kNone = 0, kLower = 1, kUpper = 2, kBoth = 3 };

struct PlanarFace {
  Label lower = 0, upper = 0;             // the label beneath and above
  std::int32_t sheet = -1;                // the sheet that this triangle belongs to; -1: none
  std::array<std::uint8_t, 3> edge = {};  // EdgeOf, opposite vertex i
  std::uint8_t known = 0;                 // flooding: bit 1 lower, bit 2 upper
  bool in_domain() const { return lower != upper; }
};

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, Kernel>;
using FaceBase0 = CGAL::Triangulation_face_base_with_info_2<PlanarFace, Kernel>;
using FaceBase = CGAL::Constrained_triangulation_face_base_2<Kernel, FaceBase0>;
using PlanarTds = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Cdt = CGAL::Constrained_Delaunay_triangulation_2<Kernel, PlanarTds>;
using PlanarPoint = Cdt::Point;
using VertexHandle = Cdt::Vertex_handle;
using FaceHandle = Cdt::Face_handle;

/// A vertex of the plane: where the sections have it (-1: not at all).
struct PlanarVertex {
  std::int32_t lower = -1, upper = -1;
  bool is_double() const { return lower >= 0 && upper >= 0; }
};

/// An edge of either section between planar vertices, with what it separates beneath and above.
struct PlanarEdge {
  std::int32_t a, b;
  EdgeOf of;
};

/// The triangulated and labelled plane of a slab.
struct Plane {
  Cdt cdt;
  std::vector<PlanarVertex> vertices;  // a vertex's info() is its index here
  std::vector<VertexHandle> handles;
  std::vector<PlanarEdge> edges;  // every edge of both sections once, in a fixed order
};

/// Builds the plane: both sections' points and edges, then the labels by flooding (paper 3.2.1, 3.2.2).
/// @throws Error(input) where labels contradict each other.
void build_plane(const Section& lower, const Section& upper, double scale_x, double scale_y, Plane& plane);

}  // namespace stackmesh
