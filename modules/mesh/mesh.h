#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/monitor.h"
#include "base/stage_time.h"
#include "base/warning.h"
#include "enhance/enhance.h"
#include "mesh/keep_pieces.h"
#include "model/complex.h"
#include "model/contours.h"
#include "model/label_volume.h"
#include "model/layers.h"
#include "model/stack.h"
#include "model/tet_mesh.h"
#include "sections/polygons.h"
#include "sections/volume_sections.h"
#include "stitch/stitch.h"
#include "validate/check_surface.h"
#include "validate/check_volume.h"
#include "volume/fill_volume.h"

namespace stackmesh {

/// How far a run goes: to the closed surface, or to the tetrahedra that fill it.
enum class Target { surface, volume };

/// How labels become a mesh. The defaults are those of the command `stackmesh mesh`.
struct MeshOptions {
  Target target = Target::volume;            ///< how far it goes
  std::set<Label> voids;                     ///< labels that bound the others and are not filled
  PieceOptions pieces;                       ///< which pieces of each label are meshed
  SectionOptions sections;                   ///< labels to sections: fairing, simplification, virtual sections
  StitchOptions stitch;                      ///< ends of labels, merge tolerance
  bool enhance = true;                       ///< smooth and remesh the stitched surface
  std::optional<std::size_t> enhance_up_to;  ///< triangles; a larger stitched surface is kept as it is, with a warning
  /// sizes, mm; pixel, gap, the faired surface and volumes that are not given are set by the call
  EnhanceOptions enhancement;
  FillOptions fill;                   ///< sizes of the tetrahedra, mm3; the worker's program and time limit
  std::map<Label, LayerSize> layers;  ///< of wedges, under the outer faces of labels; thinner where there is no room
  int order = 1;                      ///< of the tetrahedra: 1 linear, 2 quadratic (10 nodes)
  int refine = 0;                     ///< how often every tetrahedron is cut into eight, at the end
  bool many_tets = false;             ///< more than 10 million tetrahedra are wanted
  /// the result holds what its fidelity is judged by: the labels where they were changed, or the drawn sections
  bool keep_judged = false;
  int threads = 0;         ///< 0: all of the machine; the result does not depend on it
  std::string input_name;  ///< what errors call the input, such as its file

  MeshOptions() { enhancement.usual_target = true; }
};

/// What came of the volume mesher.
enum class Closure { skipped, verified, failed };

/// Why there is no valid mesh.
struct Refusal {
  std::string problem;                  ///< what is wrong
  std::string mend;                     ///< what may help
  std::vector<std::int32_t> triangles;  ///< of `surface`, where it fails; ascending
};

/// Labels as a checked surface and, for Target::volume, as tetrahedra. Surface and tetrahedra lie in Space::lps; of
/// labels without anatomical axes in Space::none, the axes they came in.
struct LabelMesh {
  std::vector<LabelInfo> labels;                ///< of the input, ascending, without the background
  InterfaceComplex surface;                     ///< all interfaces between labels, closed and free of intersections
  SurfaceLevel level = SurfaceLevel::stitched;  ///< how far enhancement came
  SurfaceCheck surface_check;                   ///< what the exact checks say of `surface`
  std::optional<TetMesh> tets;                  ///< conforming; its faces are the interfaces, without voids
  std::optional<VolumeCheck> tets_check;        ///< what the exact checks say of `tets`
  Closure closure = Closure::skipped;           ///< what came of filling the surface
  std::map<Label, double> input_volume_mm3;     ///< of each label's voxels; empty of contours

  /// What the labels became in their planes.
  struct {
    /// of the voxels on which the labels were made; 0 of contours
    std::array<double, 3> effective_spacing_mm = {0, 0, 0};
    int axis = 2;              ///< of a volume: the stacking axis
    std::size_t sections = 0;  ///< without virtual ones
    /// of the contours: vertices before and after simplification
    std::size_t loops = 0, vertices_traced = 0, vertices = 0;
  } contours;
  /// The surface as it was stitched, before enhancement.
  struct {
    /// counts of it; points that neither section had; what the exact checks found
    std::size_t vertices = 0, triangles = 0, added_points = 0, open_edges = 0, self_intersections = 0;
    std::map<Label, LabelCaps> caps;  ///< how each label ends
  } stitched;

  Frame frame;  ///< stack coordinates to those of the mesh
  /// with MeshOptions::keep_judged: the labels as they were meshed, where pieces were left out or the grid was a finer
  /// one than theirs
  std::optional<LabelVolume> changed_labels;
  Stack sections;  ///< with MeshOptions::keep_judged: drawn sections, as they were stitched
  /// with voids: per face of `tets` as filled, the void on its open side, 0 where there is none
  std::vector<Label> behind;
  std::vector<LayerFigures> layers;  ///< what came of MeshOptions::layers, places in the coordinates of the mesh
  std::string lost_detail;           ///< what a strict caller does not accept: a fallback; "": nothing
  std::vector<Warning> warnings;     ///< of all stages, in their order
  std::vector<StageTime> stages;     ///< what each took, in their order
};

/// There is no valid mesh; `partial` says how far it came and holds the surface that was refused.
class MeshRefused : public Error {
 public:
  /// `made` becomes `partial`; `where` names the input in the message.
  MeshRefused(const Refusal& why, LabelMesh made, const std::string& where)
      : Error(ErrorKind::no_result, why.problem, where, why.mend),
        refusal(why),
        partial(std::make_shared<LabelMesh>(std::move(made))) {}
  Refusal refusal;                     ///< why
  std::shared_ptr<LabelMesh> partial;  ///< never null
};

/// Labels on a grid to a conforming mesh: sections, stitched (\cite wang2005, section 3), enhanced (section 4), filled
/// and checked by code that shares nothing with what made it. Every label is closed, and no two triangles meet but in
/// what they share, as exact tests show.
/// @throws Error(input) for a volume that is no valid one (check_label_volume) or has fewer than two slices along its
/// stacking axis, Error(usage) for options that make no sense, MeshRefused (an Error(no_result)) where no valid mesh
/// was found, Error(cancelled) where the monitor says so.
LabelMesh mesh_labels(const LabelVolume& volume, const MeshOptions& options = {}, Monitor& monitor = no_monitor());

/// The same; frees the voxels as soon as they are sections, so that less memory is taken.
LabelMesh mesh_labels(LabelVolume&& volume, const MeshOptions& options = {}, Monitor& monitor = no_monitor());

/// Drawn contours to a conforming mesh: one entry a label, kept to the last digit. `drawn` says how they are read; ends
/// are made as options.stitch says.
/// @throws as mesh_labels(); Error(input) for contours that are no partition of their planes (sections_from_contours)
LabelMesh mesh_contours(const std::vector<LabelContours>& contours, const MeshOptions& options = {},
                        const ContourStackOptions& drawn = {}, Monitor& monitor = no_monitor());

/// The same of sections that were made before.
LabelMesh mesh_sections(Stack sections, const MeshOptions& options = {}, Monitor& monitor = no_monitor());

/// @throws Error(usage) where more than 10 million tetrahedra would be made and `options` do not ask for so many
void refuse_too_many(double tets, const MeshOptions& options);

}  // namespace stackmesh
