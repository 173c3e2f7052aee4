#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "model/geometry.h"
#include "model/label_volume.h"
#include "model/tet_mesh.h"

namespace stackmesh {

/// Corners of the four faces of a tet, in the order of Abaqus's S1 to S4; seen from inside they run anticlockwise.
constexpr int kTetFaces[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
/// Mid-side nodes of those faces (kTetEdges), each behind the corner that its edge begins at.
constexpr int kTetFaceMids[4][3] = {{0, 1, 2}, {3, 4, 0}, {4, 5, 1}, {5, 3, 2}};

/// Corners of the two triangles at the ends of a wedge, in the order of Abaqus's S1 and S2, seen from inside
/// anticlockwise; and their mid-side nodes (kWedgeEdges). Its other sides lie between elements of its label.
constexpr int kWedgeFaces[2][3] = {{0, 1, 2}, {3, 5, 4}};
constexpr int kWedgeFaceMids[2][3] = {{0, 1, 2}, {5, 4, 3}};

/// A face of an element: of a tet by kTetFaces; of a wedge (TetMesh counts them behind the tets) by kWedgeFaces.
struct TetFace {
  std::int32_t tet = 0, face = 0;
};

/// Corners and (of second order) mid-side nodes of a face, seen from outside anticlockwise; -1 for those that are not
/// there.
template <class Tets, class Mids, class Wedges, class WedgeMids>
std::array<std::int32_t, 6> outward_face_of(TetFace f, const Tets& tets, const Mids& mids, const Wedges& wedges,
                                            const WedgeMids& wedge_mids) {
  std::array<std::int32_t, 6> nodes = {-1, -1, -1, -1, -1, -1};
  auto element = static_cast<std::size_t>(f.tet);
  const auto fill = [&](const auto& corners, const auto& middles, const int(&corner)[3], const int(&mid)[3]) {
    nodes = {corners[element][corner[0]], corners[element][corner[2]], corners[element][corner[1]], -1, -1, -1};
    if (!middles.empty())
      for (int k = 0; k < 3; ++k) nodes[3 + k] = middles[element][mid[2 - k]];
  };
  if (element < tets.size()) {
    fill(tets, mids, kTetFaces[f.face], kTetFaceMids[f.face]);
  } else {
    element -= tets.size();
    fill(wedges, wedge_mids, kWedgeFaces[f.face], kWedgeFaceMids[f.face]);
  }
  return nodes;
}
inline std::array<std::int32_t, 6> outward_face_of(const TetMesh& mesh, TetFace f) {
  return outward_face_of(f, mesh.tets, mesh.mid, mesh.wedges, mesh.wedge_mid);
}

/// Nodes under a name. Mid-side nodes are among them when all of their faces are.
struct NodeSet {
  std::string name, note;           ///< the note says what it is, for a comment
  std::vector<std::int32_t> nodes;  ///< ascending
};

/// Element faces under a name; each belongs to one tet, whose outside is the surface's outside.
struct FaceSet {
  std::string name, note;
  std::vector<TetFace> faces;
};

/// What parts that face each other do to each other.
enum class Contact {
  none,     ///< nothing: their surfaces are named only
  tie,      ///< they stay joined
  contact,  ///< they press, and may slide and part
};

/// Two surfaces that lie on each other, each from its own side.
struct SurfacePair {
  std::string name, primary, secondary;  ///< names of face sets
  std::array<std::string, 2> parts;      ///< whose surfaces they are
  Contact contact = Contact::none;
  double stiffness_mpa_mm = 0;  ///< of contact: pressure per mm of penetration
  double friction = 0;          ///< coefficient of contact
  double stabilise = 0;         ///< springs to the ground on unsupported parts, as a share of the contact's stiffness
};

/// Nodes of one part that go where the nodes at the same places go in another part.
struct Tie {
  struct Node {
    std::int32_t node = 0, followed = 0;
    std::array<bool, 3> axes{};  ///< along which it follows: those that no support of its own holds
  };
  std::string name;         ///< of their node set
  std::vector<Node> nodes;  ///< ascending
};

/// How a material answers.
enum class MaterialKind {
  linear,         ///< isotropic: Young's modulus and Poisson's ratio
  orthotropic,    ///< constants: E1, E2, E3, nu12, nu13, nu23, G12, G13, G23; axis 1 is the fibre
  neo_hooke,      ///< constants: C10, bulk modulus K
  mooney_rivlin,  ///< constants: C10, C01, bulk modulus K
  /// Holzapfel-Gasser-Ogden; constants: C10, k1, k2 (none), kappa (none), angle of the fibres to axis 1 (degrees), K
  holzapfel,
};

/// Elements of one material. A label with a mapped modulus has one for each of its bins.
struct ElementMaterial {
  std::string name;
  Label label = 0;
  double young_mpa = 0, poisson = 0, density_t_mm3 = 0;  ///< of kinds that are not linear: those at small strain
  std::vector<std::int32_t> tets;  ///< elements (TetMesh counts wedges behind the tets), ascending
  MaterialKind kind = MaterialKind::linear;
  std::vector<double> constants;  ///< MPa where they have a unit; as the kind says
};

/// Shells on faces of tets, sharing their nodes.
struct ShellSet {
  std::string name;
  Label label = 0;
  double thickness_mm = 0;
  double young_mpa = 0, poisson = 0, density_t_mm3 = 0;
  std::vector<TetFace> faces;
};

/// Nodes of a set held, or moved by so much.
struct Support {
  std::string set;                                ///< of a node set
  std::array<std::optional<double>, 3> value_mm;  ///< per axis; unset: free
};

/// A pressure against the faces of a set. It follows them where the analysis minds large displacements.
struct Pressure {
  std::string set;  ///< of faces
  double mpa = 0;
};

/// A point to which the nodes of a set are bound as a rigid body. Its number follows those of the mesh's nodes.
struct RigidPoint {
  std::string name, set;  ///< of nodes, and of faces
  Vec3 at_mm;
};

/// What is done to a rigid point: displacements (mm) and rotations (rad), or a force (N) and a moment (N mm).
struct PointSupport {
  std::int32_t point = 0;  ///< in SolverSets::points
  std::array<std::optional<double>, 6> value;
};
struct PointLoad {
  std::int32_t point = 0;
  Vec3 force_n, moment_nmm;
};

/// A spring from a node to the ground, along a direction.
struct GroundSpring {
  std::int32_t node = 0;
  Vec3 direction;       ///< unit
  double n_per_mm = 0;  ///< above 0
};
struct SpringSet {
  std::string name;
  std::vector<GroundSpring> springs;
};

enum class Analysis { statics, frequency };

/// One step of an analysis. It says all that acts in it: what a step before it held or loaded and it does not, is free
/// again.
struct LoadStep {
  std::string name;
  Analysis analysis = Analysis::statics;
  bool large_displacements = false;
  int increments = 0;  ///< to begin with; 0: one, or ten where it is not linear
  int modes = 0;       ///< of a frequency step
  std::vector<Support> supports;
  std::vector<PointSupport> point_supports;
  std::vector<std::pair<std::int32_t, Vec3>> forces_n;  ///< on nodes, ascending
  std::vector<PointLoad> point_loads;
  std::vector<Pressure> pressures;
  Vec3 gravity_mm_s2;  ///< acceleration of every body; 0: none

  bool has_loads() const {
    return !forces_n.empty() || !point_loads.empty() || !pressures.empty() || norm(gravity_mm_s2) > 0;
  }
};

/// What a solver is told beside the mesh: sets, materials, what acts.
struct SolverSets {
  std::vector<NodeSet> node_sets;
  std::vector<FaceSet> surfaces;
  std::vector<SurfacePair> pairs;
  std::vector<std::string> parts;  ///< names
  std::vector<int> part_of_node;   ///< with parts: whose each node is
  /// with parts: the node that each was before the parts were given their own copies
  std::vector<std::int32_t> original;
  std::vector<Tie> ties;                   ///< no node is in two of them; a node that is followed follows none
  std::vector<ElementMaterial> materials;  ///< every element is in exactly one, or there are none
  bool placeholder_materials = false;      ///< nobody gave any: E = 1 MPa, Poisson's ratio 0.3
  std::vector<Label> mapped;               ///< labels whose modulus varies from tet to tet
  std::vector<double> modulus_mpa;         ///< per element, not binned; empty: none
  std::vector<double> density_t_mm3;       ///< per element
  std::vector<double> quality;             ///< scaled Jacobian per element (modules/validate); empty: not measured
  /// per element: fibre and, across it, sheet (unit); both 0 where it has none; empty: no tet has
  std::vector<std::array<Vec3, 2>> axes;
  std::vector<ShellSet> shells;
  std::vector<RigidPoint> points;
  std::vector<SpringSet> springs;
  std::vector<LoadStep> steps;  ///< in sequence
  bool has_contact() const {
    return std::any_of(pairs.begin(), pairs.end(), [](const SurfacePair& p) { return p.contact == Contact::contact; });
  }
  bool is_hyperelastic() const {
    return std::any_of(materials.begin(), materials.end(),
                       [](const ElementMaterial& m) { return m.kind >= MaterialKind::neo_hooke; });
  }
};

/// A mesh with what a solver needs. Its tets, and its wedges, are grouped by ascending label, no point is unused.
struct SolverModel {
  TetMesh mesh;
  std::vector<LabelInfo> labels;  ///< ascending; with a name each, distinct whatever the letter case
  SolverSets sets;
};

}  // namespace stackmesh
