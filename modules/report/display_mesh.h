#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/complex.h"
#include "model/tet_mesh.h"
#include "report/label_index.h"
#include "report/surface_values.h"

namespace stackmesh {

/// A grid of whole numbers over a mesh's box: point = origin + unit * (i, j, k), 0 <= i, j, k <= 65535.
struct DisplayGrid {
  Vec3 origin_mm;
  double unit_mm = 1;
};
DisplayGrid grid_over(const std::vector<Vec3>& points);

/// A mesh as the page draws it: packed arrays, each a chunk (see README.md of this module for their form).
struct PackedMesh {
  std::size_t vertices = 0, elements = 0;
  double cell_mm = 0;           ///< vertices of one cell of this size were joined; 0: the mesh as it is
  std::size_t one_of = 1;       ///< one of so many tets is shown
  double distance_unit_mm = 0;  ///< of the vertex distances
  std::vector<std::string> names, chunks;
};

/// The surface: positions, triangles, the two labels and smallest angle of each, the distance of each vertex (if
/// any are given: one per point of the complex). Above `most` triangles it is decimated
/// (report/decimate.h), or, where that is not enough or would take too long, the vertices of a cell that bound the same
/// labels are joined; what is kept of each are the largest distance and the smallest angle. `values` of a solver model
/// are one per triangle, or none.
PackedMesh pack_surface(const InterfaceComplex& complex, const std::vector<float>& distances_mm,
                        const DisplayGrid& grid, const LabelIndex& index, std::size_t most,
                        const std::vector<TriangleValues>& values = {});

/// The tets: positions, corners, labels and smallest dihedral angle of each. Above `most` tets one of several is kept.
PackedMesh pack_tets(const TetMesh& mesh, const DisplayGrid& grid, const LabelIndex& index, std::size_t most,
                     int threads);

}  // namespace stackmesh
