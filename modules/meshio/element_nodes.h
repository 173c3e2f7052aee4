#pragma once
// Nodes of wedges and pyramids in the orders of the formats.
#include <cstdint>
#include <vector>

#include "meshio/prepared_mesh.h"

namespace stackmesh {

/// In which order a format lists mid-side nodes of a wedge.
enum class WedgeOrder {
  /// both triangles, then the edges between them; pyramids have the edges of the base, then those to the apex. Abaqus,
  /// FEBio, Nastran, VTK of second order
  abaqus,
  exodus,  ///< one triangle, the edges between, the other triangle
  gmsh     ///< by the ends of the edges
};

/// Corners and (of second order) mid-side nodes of a wedge: 6 or 15, of a pyramid 5 or 13 (base anticlockwise seen from
/// the apex, apex last).
inline std::vector<std::int32_t> wedge_nodes_of(const PreparedMesh& mesh, std::size_t wedge, WedgeOrder order) {
  const auto& w = mesh.wedges[wedge];
  static constexpr int kPyramid[5] = {0, 3, 4, 1, 2};
  static constexpr int kPyramidMids[2][8] = {{6, 3, 7, 0, 2, 5, 4, 1}, {6, 0, 2, 3, 5, 7, 4, 1}};
  static constexpr int kWedgeMids[3][9] = {
      {0, 1, 2, 3, 4, 5, 6, 7, 8}, {0, 1, 2, 6, 7, 8, 3, 4, 5}, {0, 2, 6, 1, 7, 8, 3, 5, 4}};
  std::vector<std::int32_t> nodes;
  if (is_pyramid(w)) {
    for (const int k : kPyramid) nodes.push_back(w[k]);
    if (mesh.second_order())
      for (const int k : kPyramidMids[order == WedgeOrder::gmsh]) nodes.push_back(mesh.wedge_mids[wedge][k]);
  } else {
    nodes.assign(w.begin(), w.end());
    if (mesh.second_order())
      for (const int k : kWedgeMids[static_cast<int>(order)]) nodes.push_back(mesh.wedge_mids[wedge][k]);
  }
  return nodes;
}

}  // namespace stackmesh
