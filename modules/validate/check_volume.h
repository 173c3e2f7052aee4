#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/tet_mesh.h"

namespace stackmesh {

/// The elements of one label.
struct LabelTets {
  Label label = 0;                ///< never the background
  std::size_t tets = 0;           ///< without wedges
  std::size_t wedges = 0;         ///< of layers, with pyramids
  double volume_mm3 = 0;          ///< signed; of second-order tets the volume within their curved sides
  double dihedral_min_deg = 180;  ///< smallest dihedral angle of its tets
  double dihedral_max_deg = 0;    ///< largest dihedral angle of its tets
};

/// What a tetrahedral mesh is like; measures of an empty one are 0.
struct VolumeCheck {
  std::size_t nodes = 0;     ///< points of the mesh
  std::size_t tets = 0;      ///< of the mesh
  std::size_t wedges = 0;    ///< of layers, without pyramids
  std::size_t pyramids = 0;  ///< of layers
  /// of wedges and pyramids: at a corner the determinant over the product of its three edges, 1 for the regular one
  double wedge_scaled_jacobian_min = 0;
  int order = 1;             ///< 2: with mid-side nodes
  std::size_t inverted = 0;  ///< tets whose exact orientation is not positive or, of second order, whose Jacobian
                             ///< determinant is not at a corner, a mid-side node or an integration point; wedges that
                             ///< are so at a corner (exactly) or at an integration point
  std::vector<std::int32_t> inverted_list;  ///< the first 1000 elements (wedges are counted behind the tets), ascending
  double dihedral_min_deg = 0;              ///< smallest dihedral angle of a tet
  double dihedral_p1_deg = 0;               ///< 1st percentile of the smallest dihedral per tet
  double dihedral_max_deg = 0;              ///< largest dihedral angle of a tet
  std::size_t dihedral_below_10 = 0;        ///< tets whose smallest dihedral is below 10 degrees
  std::size_t in_narrow_wedges = 0;  ///< of those, tets whose smallest dihedral lies between two sheets of the surface
                                     ///< that meet at less than 10 degrees: no filling could do better
  /// of the tets below 10, those between two sheets that come close: all six edges are the surface's, or a surface
  /// point stands above a surface triangle with nothing in between; every filling has flat tets there
  std::size_t pinched = 0;
  std::array<std::size_t, 36> dihedral_histogram = {};  ///< all six dihedrals of every tet, in steps of 5 degrees
  double radius_edge_max = 0;                           ///< circumradius over shortest edge; infinite for a flat tet
  /// sqrt 2 * determinant over the largest product of three edges at a node; of second order times the smallest
  /// determinant over the straight element's
  double scaled_jacobian_min = 0;
  std::vector<LabelTets> labels;  ///< ascending
  /// The faces between tets of different labels (0 outside) are exactly mesh.faces, with their labels on the
  /// right sides; each face is shared by at most two elements, one on either side; nothing is there twice. Sides of
  /// wedges with four corners are shared by two wedges of a label. Of second order, too: tets that share an edge share
  /// its node, and no node is on two edges.
  bool conforms = false;
  std::size_t nonconforming_faces = 0;                          ///< faces that break that
  std::size_t nonconforming_edges = 0;                          ///< of second order: edges that break that
  std::vector<std::array<std::int32_t, 3>> nonconforming_list;  ///< the first 1000, ascending point numbers
};

/// How a volume mesh is checked.
struct VolumeCheckOptions {
  int threads = 0;                ///< 0: all of the machine; the result does not depend on it
  std::size_t list_limit = 1000;  ///< longest list of faces, and of tets
};

/// Judges a mesh of linear or second-order tets and wedges; angles and radius-edge are those of the corners. @throws
/// Error(input) for an index without a point, labels or mid-side nodes that do not match the elements, or a coordinate
/// that is not finite.
VolumeCheck check_volume(const TetMesh& mesh, const VolumeCheckOptions& options = {});

}  // namespace stackmesh
