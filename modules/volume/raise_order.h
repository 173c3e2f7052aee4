#pragma once
#include <cstddef>

#include "model/tet_mesh.h"

namespace stackmesh {

/// How mid-side nodes are placed, and how valid the elements stay \cite johnen2013 .
struct OrderOptions {
  bool follow_surface = true;  ///< nodes on curved interfaces leave the straight edge for the smooth surface
  /// the flat triangles hold the right volume, so their corners stand off the true surface (the enhanced one): corners
  /// move onto it, by the height of the arcs around them; false: corners stay
  bool volumes_restored = false;
  double ridge_deg = 40;  ///< two triangles that turn by more meet in a sharp edge: the surface is not smooth across it
  double jacobian_rel = 0.2;  ///< smallest Jacobian determinant allowed anywhere in an element, as a fraction of
                              ///< that of the straight-sided element; above 0, below 1
  int threads = 0;            ///< 0: all of the machine; the result does not depend on it
};

struct OrderResult {
  TetMesh mesh;                   ///< with `mid`; points of the linear mesh come first, unchanged but for moved_corners
  std::size_t moved_corners = 0;  ///< corners that moved onto the smooth surface
  std::size_t curved_nodes = 0;   ///< mid-side nodes that left the straight edge
  std::size_t limited_nodes = 0;  ///< of those on the surface: held nearer to the straight edge than the surface is
  /// a lower bound, valid everywhere (of wedges: at nodes and integration points), of determinant / straight
  /// determinant
  double jacobian_min_rel = 1;
};

/// Makes 10-node tets of 4-node ones and 15-node wedges of 6-node ones: a node on every edge, shared by all elements
/// around it.
///
/// On an interface or the boundary a node moves from the middle of its edge to where the surface's normals at the
/// edge's ends put it (after vlachos2001, but exact on a circle), on a sharp edge or junction to where its tangents
/// do. What lies in a plane across an axis stays in it. Where volumes were restored, corners on curved sides move the
/// other way first, so that the curved sides hold what the flat ones held. A node goes only so far that the determinant
/// stays positive in all of each element, not just at the integration points: bounded by its Bernstein coefficients
/// (johnen2013), and halved until they allow it. Layers bend with the surface over them, less from level to level,
/// until their foot is straight.
///
/// @param mesh linear, every tet positive, mm
/// @throws Error(input) when the mesh has mid-side nodes already or a tet names a point that is not there
OrderResult raise_order(TetMesh mesh, const OrderOptions& options = {});

}  // namespace stackmesh
