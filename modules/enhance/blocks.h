#pragma once
#include <cstdint>
#include <vector>

#include "enhance/complex_mesh.h"

namespace stackmesh {

/// A part of a complex that can be changed on its own: all triangles that come near a box of space. Those that leave
/// the box are frozen. What changes stays inside the box, so parts that are changed at the same time cannot meet.
struct MeshBlock {
  ComplexMesh mesh;
  std::vector<std::int32_t> vertices, triangles;  ///< the numbers in the whole of those it began with
  std::vector<double> size;                       ///< edge length requested at each vertex
  std::vector<std::int32_t> hints;                ///< face of the reference for each vertex
};

/// Cuts space into boxes of about `vertices_each` vertices, halving at the quantile `cut` along the longest axis;
/// frozen triangles reach within `margin_mm` of a box's sides. Other quantiles put the sides elsewhere. The result
/// depends on the mesh alone.
std::vector<MeshBlock> cut_into_blocks(const ComplexMesh& mesh, const std::vector<double>& size,
                                       const std::vector<std::int32_t>& hints, std::size_t vertices_each, double cut,
                                       double margin_mm, int threads);

/// Puts changed blocks together again; dead vertices and triangles vanish.
void join_blocks(ComplexMesh& mesh, std::vector<double>& size, std::vector<std::int32_t>& hints,
                 const std::vector<MeshBlock>& blocks);

}  // namespace stackmesh
