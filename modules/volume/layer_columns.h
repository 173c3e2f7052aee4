#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "volume/grow_layers.h"

namespace stackmesh::volume {

/// The column of each corner of outer faces: from the point, by thickness times way.
struct Columns {
  std::vector<Vec3> way;          ///< inwards, per mm of thickness
  std::vector<double> thickness;  ///< mm; 0: none
  std::vector<LayerLimit> why;
};

/// Finds the columns of one label's layer.
/// @param points, faces of the complex; every place has one point
Columns find_columns(const std::vector<Vec3>& points, const std::vector<InterfaceTriangle>& faces, Label label,
                     const LayerSize& size, int threads);

/// The point of a column between level 0, the surface, and `count`, its foot.
Vec3 level_of_column(const Vec3& point, const Vec3& way, double thickness_mm, int level, int count);

/// The three corners of an outer face, turned so that columns of no length come last, its normal pointing into the
/// label.
struct LayerFace {
  std::array<std::int32_t, 3> v;
  int columns = 0;  ///< of its corners: how many have a column
};
LayerFace layer_face(const InterfaceTriangle& face, const std::vector<double>& thickness);

/// True when the elements of one sheet (of a face, between two levels) are positive however they are divided into tets
/// (exactly).
/// @param low, high the face's corners at both levels; where there is no column they are the same point
bool sheet_is_positive(const std::array<Vec3, 3>& low, const std::array<Vec3, 3>& high, int columns);

}  // namespace stackmesh::volume
