#pragma once
// The plane under one slab, cut into sheets: internal to the module, as it shows CGAL.
#include <cstdint>
#include <vector>

#include "planar/planar.h"
#include "stitch/segment_distance.h"
#include "stitch/slab.h"

namespace stackmesh {

/// Where a sheet's vertex lies that has no partner in the other section, in gaps above the lower section.
constexpr double kHalfGap = 0.5;

/// What the rim of a sheet is like at one of its vertices.
enum RimBits : std::uint8_t {
  kRimLower = 1,    ///< an edge of the lower section alone
  kRimUpper = 2,    ///< an edge of the upper section alone
  kRimBoth = 4,     ///< an edge of both
  kInnerLower = 8,  ///< an edge of the lower section that the sheet passes over (the groove of docs/stitching.md)
  kInnerUpper = 16
};

/// A vertex of the plane as one sheet sees it.
struct SheetVertex {
  std::int32_t next;       ///< the same vertex in another sheet; -1: none
  std::int32_t sheet;      ///< its sheet
  std::uint8_t rim;        ///< RimBits
  std::uint8_t rim_edges;  ///< edges of the sheet's rim that meet here
  double height;           ///< 0 lower section .. 1 upper section; set by place_heights()
  std::int32_t out;        ///< number of the 3-D vertex
};

/// A maximal set of triangles with l != u that is not cut by a coincident edge: one continuous height field.
struct Sheet {
  std::uint8_t rims = 0;  ///< union over its rim edges
  EndShape end = EndShape::round;
  double scale = 1;                    ///< of a round end: SlabEnd::scale
  bool flat = false;                   ///< an end of a single section that is closed by a plane
  bool has_inner = false;              ///< has vertices that are neither on its rim nor flat
  int layer = 0;                       ///< order of sheets that meet over a coincident edge
  double reach = 0;                    ///< largest distance of an inner vertex from the rim
  double exponent = 1;                 ///< of equation (1)
  double rim_rise = 0, dome_rise = 0;  ///< of a round end: height = rim_rise + dome_rise * the dome's profile
  SegmentDistance lower, upper;        ///< its rim's segments in either section
  bool is_single() const { return rims == kRimLower || rims == kRimUpper; }
  bool is_round_end() const { return is_single() && !flat; }
};

/// The triangulated plane of a slab, the sheets over it, and their vertices.
struct SlabPlane {
  Plane plane;
  std::vector<Sheet> sheets;
  std::vector<SheetVertex> copies;
  std::vector<std::int32_t> first_copy;  ///< by vertex of the plane, the first of its copies; -1: none
  std::size_t added_points = 0;          ///< vertices of the plane that neither section has

  /// Whether the copy is neither on a rim nor of a flat end.
  bool is_inner(const SheetVertex& c) const {
    return !sheets[c.sheet].flat && !(c.rim & (kRimLower | kRimUpper | kRimBoth));
  }

  /// The copy of a vertex of the plane in a sheet, made where there is none.
  std::int32_t copy_index(std::int32_t vertex, std::int32_t sheet);

  /// 0 or 1 where a copy lies on a section, else kHalfGap (between the sections).
  static double rim_height(const SheetVertex& c);
};

/// Triangulates the plane of the slab, finds its sheets and their order, and adds the points that keep a sheet from
/// lying in a section (\cite wang2005, 3.2 and 3.3). Without sections of any extent nothing is found.
/// @param plane is empty before; the triangulation's handles in it forbid that it is copied afterwards
/// @throws Error(input) where the labels of a section's edges contradict each other
/// @throws Error(internal) where a triangle is too thin to hold a point
void find_sheets(const SlabInput& input, SlabPlane& plane);

}  // namespace stackmesh
