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
  std::int32_t tet = 0;   ///< number of the element
  std::int32_t face = 0;  ///< number of its face
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
  std::string name;                 ///< distinct among node sets
  std::string note;                 ///< what it is, for a comment
  std::vector<std::int32_t> nodes;  ///< ascending
};

/// Element faces under a name; each belongs to one tet, whose outside is the surface's outside.
struct FaceSet {
  std::string name;            ///< distinct among face sets
  std::string note;            ///< what it is, for a comment
  std::vector<TetFace> faces;  ///< each of the element whose outside is the surface's outside
};

/// What parts that face each other do to each other.
enum class Contact {
  none,     ///< nothing: their surfaces are named only
  tie,      ///< they stay joined
  contact,  ///< they press, and may slide and part
};

/// Two surfaces that lie on each other, each from its own side.
struct SurfacePair {
  std::string name;                  ///< of the pair
  std::string primary;               ///< name of the face set of one side
  std::string secondary;             ///< name of the face set of the other side
  std::array<std::string, 2> parts;  ///< whose surfaces they are
  Contact contact = Contact::none;   ///< what they do
  double stiffness_mpa_mm = 0;       ///< of contact: pressure per mm of penetration
  double friction = 0;               ///< coefficient of contact
  double stabilise = 0;  ///< springs to the ground on unsupported parts, as a share of the contact's stiffness
};

/// Nodes of one part that go where the nodes at the same places go in another part.
struct Tie {
  /// A node that goes where another one goes.
  struct Node {
    std::int32_t node = 0;       ///< index of the mesh's points
    std::int32_t followed = 0;   ///< index of the one that it follows
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
  std::string name;                          ///< distinct among materials
  Label label = 0;                           ///< of its elements
  double young_mpa = 0;                      ///< Young's modulus; of kinds that are not linear, at small strain
  double poisson = 0;                        ///< Poisson's ratio; of kinds that are not linear, at small strain
  double density_t_mm3 = 0;                  ///< mass density; 0: unknown
  std::vector<std::int32_t> tets;            ///< elements (TetMesh counts wedges behind the tets), ascending
  MaterialKind kind = MaterialKind::linear;  ///< which law it follows
  std::vector<double> constants;             ///< MPa where they have a unit; as the kind says
};

/// Shells on faces of tets, sharing their nodes.
struct ShellSet {
  std::string name;            ///< of the set of shells
  Label label = 0;             ///< whose outer faces they lie on
  double thickness_mm = 0;     ///< above 0
  double young_mpa = 0;        ///< Young's modulus
  double poisson = 0;          ///< Poisson's ratio
  double density_t_mm3 = 0;    ///< mass density; 0: unknown
  std::vector<TetFace> faces;  ///< a shell on each
};

/// Nodes of a set held, or moved by so much.
struct Support {
  std::string set;                                ///< of a node set
  std::array<std::optional<double>, 3> value_mm;  ///< per axis; unset: free
};

/// A pressure against the faces of a set. It follows them where the analysis minds large displacements.
struct Pressure {
  std::string set;  ///< of faces
  double mpa = 0;   ///< above 0: it presses
};

/// A point to which the nodes of a set are bound as a rigid body. Its number follows those of the mesh's nodes.
struct RigidPoint {
  std::string name;  ///< its own
  std::string set;   ///< of the nodes, and of the faces, that are bound to it
  Vec3 at_mm;        ///< where it lies, in the space of the mesh
};

/// A rigid point held or moved.
struct PointSupport {
  std::int32_t point = 0;  ///< in SolverSets::points
  /// displacements along x, y, z (mm), then rotations about them (rad); unset: free
  std::array<std::optional<double>, 6> value;
};
/// A force and a moment on a rigid point.
struct PointLoad {
  std::int32_t point = 0;  ///< in SolverSets::points
  Vec3 force_n;            ///< along the axes
  Vec3 moment_nmm;         ///< about the axes
};

/// A spring from a node to the ground, along a direction.
struct GroundSpring {
  std::int32_t node = 0;  ///< index of the mesh's points
  Vec3 direction;         ///< unit
  double n_per_mm = 0;    ///< above 0
};
/// Springs to the ground under a name.
struct SpringSet {
  std::string name;                   ///< distinct among spring sets
  std::vector<GroundSpring> springs;  ///< in the order of their nodes
};

/// What a step computes.
enum class Analysis {
  statics,   ///< displacements and stresses under loads
  frequency  ///< natural frequencies and their modes
};

/// One step of an analysis. It says all that acts in it: what a step before it held or loaded and it does not, is free
/// again.
struct LoadStep {
  std::string name;                                     ///< as the law file calls it
  Analysis analysis = Analysis::statics;                ///< what it computes
  bool large_displacements = false;                     ///< requested; hyperelastic materials need it in any case
  int increments = 0;                                   ///< to begin with; 0: one, or ten where it is not linear
  int modes = 0;                                        ///< of a frequency step
  std::vector<Support> supports;                        ///< of node sets
  std::vector<PointSupport> point_supports;             ///< of rigid points
  std::vector<std::pair<std::int32_t, Vec3>> forces_n;  ///< on nodes, ascending
  std::vector<PointLoad> point_loads;                   ///< on rigid points
  std::vector<Pressure> pressures;                      ///< on face sets
  Vec3 gravity_mm_s2;                                   ///< acceleration of every body; 0: none

  /// Whether anything but supports acts.
  bool has_loads() const {
    return !forces_n.empty() || !point_loads.empty() || !pressures.empty() || norm(gravity_mm_s2) > 0;
  }
};

/// What a solver is told beside the mesh: sets, materials, what acts.
struct SolverSets {
  std::vector<NodeSet> node_sets;  ///< names are distinct
  std::vector<FaceSet> surfaces;   ///< names are distinct; one may be that of a node set
  std::vector<SurfacePair> pairs;  ///< of parts that lie on each other
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
  std::vector<ShellSet> shells;    ///< skins on outer faces
  std::vector<RigidPoint> points;  ///< numbered behind the mesh's nodes, in this order
  std::vector<SpringSet> springs;  ///< elastic foundations, and what holds parts that contact alone would hold
  std::vector<LoadStep> steps;     ///< in sequence
  /// Whether parts press on each other (not: are tied).
  bool has_contact() const {
    return std::any_of(pairs.begin(), pairs.end(), [](const SurfacePair& p) { return p.contact == Contact::contact; });
  }
  /// Whether a material answers to large strains.
  bool is_hyperelastic() const {
    return std::any_of(materials.begin(), materials.end(),
                       [](const ElementMaterial& m) { return m.kind >= MaterialKind::neo_hooke; });
  }
};

/// A mesh with what a solver needs. Its tets, and its wedges, are grouped by ascending label, no point is unused.
struct SolverModel {
  TetMesh mesh;                   ///< first or second order, in the space that is written
  std::vector<LabelInfo> labels;  ///< ascending; with a name each, distinct whatever the letter case
  SolverSets sets;                ///< all that a solver is told beside the mesh
};

}  // namespace stackmesh
