#pragma once
#include <cstdint>
#include <vector>

#include "model/tet_mesh.h"

namespace stackmesh::volume {

/// How points of layers follow the surface they hang on: those of a column by the share of it that lies between them
/// and its foot.
struct LayerLevels {
  /// of each point: the point of the surface over it; the point itself where it is in no column
  std::vector<std::int32_t> top;
  std::vector<double> share;  ///< 1 on the surface (and in no column), 0 at a foot
  bool any = false;

  explicit LayerLevels(const TetMesh& mesh);
  bool hangs(std::int32_t point) const { return top[point] != point; }
};

}  // namespace stackmesh::volume
