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

enum class Status { pass, warn, fail };
/// "pass", "warn" or "fail".
const char* to_text(Status status);

/// One line at the head of a report: a figure against its limit, in words.
struct Verdict {
  /// closed, intersections, orientation, conforming, topology, components, volume, position, fidelity, roughness,
  /// quality, thickness
  std::string id;
  std::string title;   ///< "Closed"
  std::string figure;  ///< "0 open edges"
  std::string limit;   ///< "none allowed"
  Status status = Status::pass;
  bool validity = false;      ///< a fail makes the mesh invalid (exit 4), not only outside a limit (exit 6)
  std::string explanation;    ///< what was measured, and which labels or elements are to blame
  std::vector<Label> labels;  ///< those that warn or fail, worst first; empty when it concerns the whole mesh
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
  double volume_warn_rel = 0.02, volume_fail_rel = 0.10;                    ///< of a label, mesh against voxels
  double dice_warn = 0.95, dice_fail = 0.85;                                ///< least of any label
  double wrong_centres_warn_share = 0.10, wrong_centres_fail_share = 0.30;  ///< of a label's voxel centres
  /// How far a label's surface is outside of its band (see BandDistance), in units of the largest spacing.
  double band_mean_warn_px = 0.1, band_mean_fail_px = 0.5;
  double band_max_warn_px = 2.0, band_max_fail_px = 10.0;
  /// Distances to voxel faces both ways have no limits unless they are set: they punish a smooth surface for being
  /// smooth. In units of the in-plane pixel (labels to mesh) or the largest spacing (mesh to labels).
  std::optional<double> mean_distance_warn_px, mean_distance_fail_px;
  std::optional<double> p95_distance_warn_px, p95_distance_fail_px;
  std::optional<double> max_distance_warn_px, max_distance_fail_px;  ///< Hausdorff
  double bends_warn_share = 0.10;  ///< of a label's edges, those that bend by more than 40 degrees; never fails
  double position_warn_px = 0.25, position_fail_px = 0.75;  ///< offset of the whole mesh along an axis, in voxels
  double angle_warn_deg = 10, angle_fail_deg = 0.5;         ///< smallest angle of a triangle
  double dihedral_warn_deg = 8, dihedral_fail_deg = 0.5;    ///< smallest dihedral of a tet
  double dihedral_max_warn_deg = 170, dihedral_max_fail_deg = 179.5;
  double jacobian_warn = 0.05, jacobian_fail = 0.005;  ///< smallest scaled Jacobian of a tet
  double thin_warn_share = 0.05;  ///< share of a label's surface whose thickness is below `thin_elements`; never fails
  double thin_elements = 2;
  /// handles beyond those that the slices imply: so many of all labels fail, fewer warn; 0: they never fail
  std::size_t handles_fail = 0;
  std::size_t small_label_voxels = 200;  ///< below, volume, voxel centres and distances of a label warn at most
};

/// What is judged. Pointers may be null: what they tell is then not judged.
struct JudgeInput {
  const SurfaceCheck* surface = nullptr;
  const VolumeCheck* volume = nullptr;
  const std::vector<LabelFidelity>* fidelity = nullptr;
  const std::vector<LabelThickness>* thickness = nullptr;
  const BendCheck* bends = nullptr;
  const std::vector<LabelTopology>* topology = nullptr;
  std::vector<LabelInfo> labels;         ///< of the input, without the background; names for texts
  std::vector<double> input_volume_mm3;  ///< beside `labels`; empty: unknown
  double pixel_mm = 1, voxel_mm = 1;     ///< smallest in-plane and largest spacing
};

/// The verdicts in the order in which they are read. Nothing throws.
std::vector<Verdict> judge(const JudgeInput& input, const Limits& limits = {});

/// The worst of them, and what the program returns: 0 pass or warn, 4 invalid, 6 outside a limit.
Status overall(const std::vector<Verdict>& verdicts);
int exit_code(const std::vector<Verdict>& verdicts);

}  // namespace stackmesh
