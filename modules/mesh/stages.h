#pragma once
// Private to the module: the stages of a run, and the values that go from one to the next.
#include <atomic>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/stage_clock.h"
#include "base/warning.h"
#include "mesh/judge.h"
#include "mesh/mesh.h"
#include "mesh/voids.h"
#include "volume/grow_layers.h"

namespace stackmesh {

/// What all stages of one call share.
struct Call {
  const MeshOptions& options;
  Monitor& monitor;
  StageClock& clock;
  std::vector<Warning>& warnings;
};

/// Sections, and what is known of the labels that they were made of.
struct SectionStage {
  Stack stack;
  bool drawn = false;                  ///< contours as they were drawn; false: of a label volume
  InterfaceComplex faired;             ///< the faired interfaces as a whole; empty without fairing
  std::map<Label, double> volume_mm3;  ///< of each label's voxels
  std::string far_apart;               ///< why the surface is not worth enhancing; "": it is
};

/// A stitched surface, in stack coordinates, and the measures that enhancement needs.
struct StitchedStage {
  InterfaceComplex complex;
  Stack stack;  ///< the sections as they were stitched, where someone wants them
  Frame frame;
  double pixel_mm = 1, gap_mm = 1;
  double drawn_gap_mm = 0, drawn_bulge_mm = 0;  ///< of drawn contours
  InterfaceComplex faired;
  std::map<Label, double> volume_mm3;
  std::string far_apart;
};

/// The surface that is handed out, and the tetrahedra that were filled beside its last check.
struct SurfaceStage {
  InterfaceComplex complex;  ///< stack coordinates
  SurfaceLevel level = SurfaceLevel::stitched;
  Judgement judged;
  SurfaceCheck stitched_check;
  std::optional<FillResult> filled;
  Hollowed hollowed;                ///< what was filled, where there are voids
  std::optional<LayerPlan> layers;  ///< of `filled`
  std::string lost_detail;
};

/// The tetrahedra, in stack coordinates, or why there are none.
struct TetStage {
  std::optional<TetMesh> mesh;
  Closure closure = Closure::skipped;
  std::optional<Refusal> refusal;
  std::vector<LayerFigures> layers;  ///< places in the coordinates of the mesh
};

StitchedStage stitch_stage(SectionStage sections, LabelMesh& out, const Call& call);

/// The stitched surface, enhanced where that is wanted; it is kept until the enhanced one has passed the same exact
/// checks.
SurfaceStage surface_stage(StitchedStage stitched, const Call& call);

/// The volume mesher works in stack coordinates; only what it gives is mapped to the world.
void fill_stage(SurfaceStage& surface, const Call& call, const std::atomic<bool>* given_up = nullptr);

/// Second order and refinement of what was filled; the surface follows the tetrahedra.
TetStage tet_stage(SurfaceStage& surface, const Frame& frame, const Call& call);

}  // namespace stackmesh
