#pragma once
// A surface drawn with fewer triangles: internal to the module.
#include <cstddef>
#include <vector>

#include "model/geometry.h"
#include "report/drawn_surface.h"

namespace stackmesh {

/// Collapses edges of the surface until about `most` triangles are left, by OpenMesh's decimater with quadric errors
/// (\cite garland1997), never turning a triangle over. Each interface between two labels, and each set of a solver
/// model on it, is a patch of its own, and the vertices where patches meet stay: so patches stay joined, and the
/// result may have more triangles than `most` where little but such vertices is left. What an edge takes with it goes
/// to its neighbours: a vertex keeps the largest distance of those it stands for, and a triangle the smallest angle.
/// The result does not depend on the number of threads.
/// @param points_mm of the vertices of `fine`, before they were rounded to the grid
DrawnSurface decimated(const DrawnSurface& fine, const std::vector<Vec3>& points_mm, std::size_t most);

}  // namespace stackmesh
