#pragma once
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "model/label_volume.h"
#include "model/solver_model.h"

namespace stackmesh {

/// A piece of a step: y = offset + factor * x ^ exponent, for x up to `up_to`.
struct LawPiece {
  double up_to = std::numeric_limits<double>::infinity();  ///< largest x, in the unit of the step before
  double factor = 1;                                       ///< of the power
  double exponent = 1;                                     ///< of x
  double offset = 0;                                       ///< in the unit of the step
};

/// One step of a law: from one quantity to the next, each in its own unit.
struct LawStep {
  std::string from;              ///< name of the quantity that it takes
  std::string to;                ///< name of the quantity that it gives
  std::string unit;              ///< of `to`: g/cm3, mg/cm3, kg/m3, t/mm3, or MPa, GPa, Pa
  std::vector<LawPiece> pieces;  ///< ascending up_to; a power of a negative number counts as that of 0
};

/// Intensity to modulus, step by step: calibration, densities, Young's modulus.
struct ModulusLaw {
  std::string name;            ///< as labels refer to it
  std::string source;          ///< where it was published
  std::vector<LawStep> steps;  ///< the first takes the image's intensity, the last gives a modulus

  /// What the law makes of an intensity.
  struct Value {
    double young_mpa = 0;      ///< Young's modulus
    double density_t_mm3 = 0;  ///< of the last density (apparent, where the law names it); 0: the law has none
  };
  /// All steps, one after the other. @param intensity in the unit of the image, such as HU
  Value at(double intensity) const;
};

/// Fibres by rule: the wall's depth is the solution of Laplace's equation between two sets (0 on the first, 1 on the
/// second), its gradient the way through the wall; the helix angle goes linearly with the depth from the first angle to
/// the second. The fibre lies at that angle to the circumference, towards `along`, at right angles to the gradient.
struct FibreRule {
  std::string from;                          ///< set of faces of depth 0, such as the endocardium
  std::string to;                            ///< set of faces of depth 1, such as the epicardium
  std::array<double, 2> angle_deg{60, -60};  ///< helix angle at `from` and at `to`
  Vec3 along = {0, 0, 1};                    ///< the long axis, unit, from apex to base
};

/// What a label is made of: a constant modulus, or a law.
struct LabelMaterial {
  MaterialKind kind = MaterialKind::linear;  ///< how it answers
  std::vector<double> constants;             ///< of other kinds, see MaterialKind
  std::optional<FibreRule> fibres;           ///< of materials with axes
  std::optional<std::array<Vec3, 2>> axes;   ///< the same for all its elements
  std::optional<double> young_mpa;           ///< constant Young's modulus; unset: by `law`, or of another kind
  std::string law;                           ///< of MaterialPlan::laws; used where young_mpa is unset
  double poisson = 0.3;                      ///< Poisson's ratio
  std::optional<double> density_t_mm3;       ///< unset: the law's, else 0 (none written)
  std::optional<double> floor_mpa;           ///< of a law: elements below are set to it, and counted
  std::optional<double> ceiling_mpa;         ///< of a law: elements above are set to it, and counted
};

/// Shells of --skin.
struct SkinMaterial {
  double young_mpa = 0;      ///< Young's modulus
  double poisson = 0.3;      ///< Poisson's ratio
  double density_t_mm3 = 0;  ///< mass density; 0: none is written
};

/// Which elements of a label share a material in decks that cannot carry one modulus an element.
enum class Binning {
  logarithmic,    ///< bins of as wide a ratio of modulus each: no element is off by more than half of it
  equal_count,    ///< of as many elements each
  equal_modulus,  ///< of as wide a range of modulus each
};

/// How intensities become moduli of elements.
struct MappingOptions {
  bool integrate_modulus = true;  ///< the modulus field over each element; else the mean intensity, mapped once
  int erode_px = 0;               ///< voxels of the label nearer to its border than this many are not used
  int bins = 200;                 ///< materials per label in decks that cannot carry one modulus an element
  Binning binning = Binning::logarithmic;  ///< how elements are put into bins
  int threads = 0;                         ///< 0: all of the machine; the result does not depend on it
};

/// Supports and loads by the names of sets.
struct LoadCase {
  /// A set, or a point of `points`, held or moved along axes.
  struct Held {
    std::string set;                                   ///< its name
    std::array<std::optional<double>, 3> value_mm;     ///< displacement along each axis; unset: free
    std::array<std::optional<double>, 3> value_rad{};  ///< rotations, of a point
  };
  /// Exactly one of pressure, and force or moment or both.
  struct Loaded {
    std::string set;                     ///< of faces, or a point of `points`
    std::optional<Vec3> force_n;         ///< in all, spread evenly over the faces
    std::optional<double> pressure_mpa;  ///< against the faces
    std::optional<Vec3> moment_nmm{};    ///< in all, about the point, or about the faces' centre
  };
  /// A point that stands for a set of faces: bound to it as a rigid body, or its loads spread over the faces.
  struct Point {
    std::string name;   ///< by which supports and loads name it
    std::string set;    ///< of the faces
    Vec3 at_mm;         ///< in the space of the mesh
    bool rigid = true;  ///< false: its loads are spread over the faces
  };
  /// Springs between a set and the ground; exactly one of both stiffnesses.
  struct Spring {
    std::string set;                   ///< of faces
    std::optional<Vec3> n_per_mm;      ///< in all, along the axes, spread evenly over the faces
    std::optional<double> mpa_per_mm;  ///< foundation: pressure per mm along the faces' normals
  };
  /// What acts in a step.
  struct Acting {
    std::vector<Held> held;             ///< supports
    std::vector<Loaded> loaded;         ///< loads
    std::optional<Vec3> gravity_mm_s2;  ///< acceleration of every body
    /// Whether nothing acts.
    bool empty() const { return held.empty() && loaded.empty() && !gravity_mm_s2; }
  };
  /// A step as the file has it.
  struct Step {
    std::string name;                       ///< for decks and reports
    Analysis analysis = Analysis::statics;  ///< what it computes
    bool large_displacements = false;       ///< requested
    int increments = 0;                     ///< to begin with; 0: LoadStep::increments says what is taken
    int modes = 10;                         ///< of a frequency step: how many are computed
    Acting acting;                          ///< beside what acts always
  };
  Acting always;                ///< in every step
  std::vector<Point> points;    ///< that stand for sets of faces
  std::vector<Spring> springs;  ///< in every step
  Step defaults;                ///< of the one step that there is where `steps` is empty
  std::vector<Step> steps;      ///< in sequence; empty: one, of what acts always
};

/// What two parts of --parts do to each other.
struct ContactLaw {
  std::array<std::string, 2> parts;        ///< their names
  Contact contact = Contact::tie;          ///< what they do
  double friction = 0;                     ///< coefficient of contact
  std::optional<double> stiffness_mpa_mm;  ///< unset: see join_parts()
  /// of contact: springs hold the parts that have no support, in all as stiff as this share of the contact
  double stabilise = 0;
};

/// A law file, read and checked.
struct MaterialPlan {
  std::string path;                             ///< of the file
  std::map<std::string, ModulusLaw> laws;       ///< by name
  std::map<std::string, LabelMaterial> labels;  ///< by number or name; "*": all others
  std::map<std::string, SkinMaterial> skins;    ///< by number or name of their label; "*": all others
  MappingOptions mapping;                       ///< how intensities become moduli
  LoadCase load_case;                           ///< supports and loads
  std::vector<ContactLaw> contacts;             ///< between parts
};

/// The names of the laws that need no steps in a file.
std::vector<std::string> known_laws();

/// Reads a law file (docs/fem.md has its schema).
/// @throws Error(input) naming file and entry: no JSON, an unknown or missing entry or unit, a calibration whose slope
/// is not above 0, a law that does not end in a modulus
MaterialPlan read_law(const std::string& path);

}  // namespace stackmesh
