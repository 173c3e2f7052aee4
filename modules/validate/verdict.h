#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "model/label_volume.h"
#include "validate/check_bends.h"
#include "validate/check_fidelity.h"
#include "validate/check_surface.h"
#include "validate/check_thickness.h"
#include "validate/check_topology.h"
#include "validate/check_volume.h"

namespace stackmesh {

/// Whether a figure is inside its limits; ordered from good to bad.
enum class Status { pass, warn, fail };
/// "pass", "warn" or "fail".
const char* to_text(Status status);

/// One line at the head of a report: a figure against its limit, in words.
struct Verdict {
  /// closed, intersections, orientation, conforming, topology, components, volume, position, fidelity, roughness,
  /// quality, thickness
  std::string id;
  std::string title;             ///< "Closed"
  std::string figure;            ///< "0 open edges"
  std::string limit;             ///< "none allowed"
  Status status = Status::pass;  ///< of the figure against the limit
  bool validity = false;         ///< a fail makes the mesh invalid (exit 4), not only outside a limit (exit 6)
  std::string explanation;       ///< what was measured, and which labels or elements are to blame
  std::vector<Label> labels;     ///< those that warn or fail, worst first; empty when it concerns the whole mesh
};

/// Something wrong at a place. Coordinates are mm in the frame of the labels it was judged against (LPS), else
/// of the mesh file.
struct Defect {
  /// hole, open_edge, flipped_triangle, self_intersection, degenerate_triangle, inverted_tet,
  /// nonconforming_face, missing_component, unmatched_piece, swapped_label, handle, shift, wrong_frame, thin,
  /// poor_triangle, poor_tet
  std::string kind;
  Label label = 0;                     ///< 0: none or unknown
  Vec3 where;                          ///< mm; the middle of what is wrong
  std::optional<int> section;          ///< slice of the input that is nearest, from 0 along the stacking axis
  std::string entity_kind;             ///< "triangles", "tets", "points" or "voxels": what `entities` number
  std::vector<std::int64_t> entities;  ///< from 0, in the order of the file as read; at most 50
  std::size_t count = 1;               ///< edges of the hole, pairs of the crossing, voxels of the component
  double size_mm = 0;                  ///< largest extent of its box; 0 for a point
  std::string text;                    ///< one sentence
};

/// Where warnings and failures begin. Distances are in pixels or voxels, so that one table serves a mouse and a man;
/// limits of validity (closed, intersections, inverted, conforming) are not to be changed.
struct Limits {
  double volume_warn_rel = 0.02;           ///< of a label, mesh against voxels: above it warns
  double volume_fail_rel = 0.10;           ///< and above this it fails
  double dice_warn = 0.95;                 ///< least of any label: below it warns
  double dice_fail = 0.85;                 ///< and below this it fails
  double wrong_centres_warn_share = 0.10;  ///< of a label's voxel centres: above it warns
  double wrong_centres_fail_share = 0.30;  ///< and above this it fails
  /// How far a label's surface is outside of its band (see BandDistance), in units of the largest spacing.
  double band_mean_warn_px = 0.1;
  double band_mean_fail_px = 0.5;  ///< the mean fails above
  double band_max_warn_px = 2.0;   ///< the largest warns above
  double band_max_fail_px = 10.0;  ///< the largest fails above
  /// Distances to voxel faces both ways have no limits unless they are set: they punish a smooth surface for being
  /// smooth. In units of the in-plane pixel (labels to mesh) or the largest spacing (mesh to labels).
  std::optional<double> mean_distance_warn_px;
  std::optional<double> mean_distance_fail_px;  ///< the mean fails above
  std::optional<double> p95_distance_warn_px;   ///< the 95th percentile warns above
  std::optional<double> p95_distance_fail_px;   ///< the 95th percentile fails above
  std::optional<double> max_distance_warn_px;   ///< the largest (Hausdorff) warns above
  std::optional<double> max_distance_fail_px;   ///< the largest fails above
  double bends_warn_share = 0.10;        ///< of a label's edges, those that bend by more than 40 degrees; never fails
  double position_warn_px = 0.25;        ///< offset of the whole mesh along an axis, in voxels: above it warns
  double position_fail_px = 0.75;        ///< and above this it fails
  double angle_warn_deg = 10;            ///< smallest angle of a triangle: below it warns
  double angle_fail_deg = 0.5;           ///< and below this it fails
  double dihedral_warn_deg = 8;          ///< smallest dihedral of a tet: below it warns
  double dihedral_fail_deg = 0.5;        ///< and below this it fails
  double dihedral_max_warn_deg = 170;    ///< largest dihedral of a tet: above it warns
  double dihedral_max_fail_deg = 179.5;  ///< and above this it fails
  double jacobian_warn = 0.05;           ///< smallest scaled Jacobian of a tet: below it warns
  double jacobian_fail = 0.005;          ///< and below this it fails
  double thin_warn_share = 0.05;  ///< share of a label's surface whose thickness is below `thin_elements`; never fails
  double thin_elements = 2;       ///< in edges of the surface there
  /// handles beyond those that the slices imply: so many of all labels fail, fewer warn; 0: they never fail
  std::size_t handles_fail = 0;
  std::size_t small_label_voxels = 200;  ///< below, volume, voxel centres and distances of a label warn at most
};

/// What is judged. Pointers may be null: what they tell is then not judged.
struct JudgeInput {
  const SurfaceCheck* surface = nullptr;                   ///< closed, intersections, components, quality
  const VolumeCheck* volume = nullptr;                     ///< orientation, conforming, quality
  const std::vector<LabelFidelity>* fidelity = nullptr;    ///< components, position, fidelity
  const std::vector<LabelThickness>* thickness = nullptr;  ///< of each label
  const BendCheck* bends = nullptr;                        ///< roughness
  const std::vector<LabelTopology>* topology = nullptr;    ///< handles and pieces that slices imply
  std::vector<LabelInfo> labels;                           ///< of the input, without the background; names for texts
  std::vector<double> input_volume_mm3;                    ///< beside `labels`; empty: unknown
  double pixel_mm = 1;                                     ///< smallest in-plane spacing
  double voxel_mm = 1;                                     ///< largest spacing
};

/// The verdicts in the order in which they are read. Nothing throws.
std::vector<Verdict> judge(const JudgeInput& input, const Limits& limits = {});

/// The worst of them, and what the program returns: 0 pass or warn, 4 invalid, 6 outside a limit.
Status overall(const std::vector<Verdict>& verdicts);
int exit_code(const std::vector<Verdict>& verdicts);

}  // namespace stackmesh
