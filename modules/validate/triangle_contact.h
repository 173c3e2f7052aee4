#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/geometry.h"

namespace stackmesh {

/// True when two triangles of non-zero area meet anywhere but in the vertices and the edge that they share by
/// index; exact. Vertices that coincide without being the same index count as meeting, as does a triangle
/// twice.
bool triangles_collide(const std::vector<Vec3>& points, const std::array<std::int32_t, 3>& s,
                       const std::array<std::int32_t, 3>& t);

}  // namespace stackmesh
