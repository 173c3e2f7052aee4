#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "base/warning.h"
#include "mesh/layers.h"
#include "mesh/stages.h"
#include "volume/raise_order.h"
#include "volume/refine_tets.h"

namespace stackmesh {
namespace {

/// Below it TetGen finds next to no place for a point inside that makes a better tetrahedron of the surface's
/// triangles, and looks for most of its time; the improvement, which may put points anywhere, does.
constexpr double kThinInEdges = 0.8;

FillOptions fill_options(const MeshOptions& o, const InterfaceComplex& surface, SurfaceLevel level) {
  FillOptions options = o.fill;
  options.known_sound = true;
  options.threads = o.threads;
  if (level == SurfaceLevel::enhanced) {  // good triangles: quality may be requested of inner tetrahedra
    const bool sizes_requested =
        options.radius_edge || options.dihedral_deg || options.max_volume_mm3 || !options.label_max_volume_mm3.empty();
    if (sizes_requested || thickness_in_edges(surface) > kThinInEdges) {
      if (!options.radius_edge) options.radius_edge = 1.4;
      if (!options.max_volume_mm3) options.inner_growth = 2;
    }
    options.improve_deg = std::max(24.0, options.dihedral_deg.value_or(0));
  } else if (options.dihedral_deg) {
    options.improve_deg = options.dihedral_deg;
  }
  options.outside_is_empty = o.voids.empty();
  return options;
}

/// The surface has its points where the tets have them, and is checked again.
void follow_moved(SurfaceStage& surface, const TetMesh& mesh, const std::vector<std::int32_t>& moved,
                  const Frame& frame, int threads) {
  if (moved.empty()) return;
  std::map<std::array<double, 3>, Vec3> to;  // points of the surface at one place are one for the tets
  for (const std::int32_t v : moved)
    to[{surface.complex.points[v].x, surface.complex.points[v].y, surface.complex.points[v].z}] = mesh.points[v];
  for (Vec3& p : surface.complex.points)
    if (const auto at = to.find({p.x, p.y, p.z}); at != to.end()) p = at->second;
  surface.judged = judge(surface.complex, frame, threads);
  if (!surface.judged.is_sound())
    fail_internal("the surface was sound until its worst tetrahedra were improved", "volume");
}

/// Puts the layers over the filled core.
void take_layers(TetStage& out, LayerPlan& plan, const Frame& frame, std::vector<Warning>& warnings) {
  add_layers(*out.mesh, plan);
  for (LayerFigures& f : plan.figures) {
    for (LayerPlace& p : f.places) p.at_mm = frame.to_world(p.at_mm);
    if (const std::string text = layer_warning(f); !text.empty())
      warnings.push_back({WarningCode::layers, "label " + std::to_string(f.label), text});
    out.layers.push_back(std::move(f));
  }
}

/// The finer surface takes the place of the coarse one once it has passed the same checks.
void refine(TetStage& out, SurfaceStage& surface, const Frame& frame, const MeshOptions& o) {
  refuse_too_many(static_cast<double>(out.mesh->tets.size()) * std::pow(8, o.refine), o);
  out.mesh = refine_tets(std::move(*out.mesh), o.refine);
  const std::vector<LabelSurface> before = std::move(surface.judged.check.labels);
  surface.judged = judge(surface_of(*out.mesh), frame, o.threads);
  for (const LabelSurface& l : before)  // voids are not refined
    if (o.voids.count(l.label) > 0) surface.judged.check.labels.push_back(l);
  if (!surface.judged.is_sound())
    out.refusal = Refusal{"", "leave --refine out, or use --order 1: curved sides cut into flat ones touch here", {}};
}

}  // namespace

void fill_stage(SurfaceStage& surface, const Call& call, const std::atomic<bool>* given_up) {
  const MeshOptions& o = call.options;
  const bool whole = o.voids.empty();
  if (!whole) surface.hollowed = hollowed(surface.complex, o.voids);
  const InterfaceComplex& body = whole ? surface.complex : surface.hollowed.complex;
  if (!o.layers.empty()) {
    check_outer_faces(body, o.layers);
    surface.layers = plan_layers(body, o.layers, o.threads);
  }
  const InterfaceComplex& core = surface.layers ? surface.layers->core : body;
  FillOptions options = fill_options(o, core, surface.level);
  options.given_up = given_up;
  if (surface.layers) options.outside_is_empty = false;  // the layers lie there
  refuse_too_many(estimate_tets(core, options), o);
  surface.filled = fill_volume(core, options);
  if (whole) return;
  for (std::int32_t& t : surface.filled->offending_triangles) t = surface.hollowed.original[t];
}

TetStage tet_stage(SurfaceStage& surface, const Frame& frame, const Call& call) {
  const MeshOptions& o = call.options;
  TetStage out;
  FillResult result = std::move(*surface.filled);
  surface.filled.reset();
  for (const Warning& w : result.warnings) call.warnings.push_back(w);
  if (!result.fallback.empty())
    call.warnings.push_back(
        {WarningCode::mesher, "", "the volume mesher fell back: " + result.fallback + "; then " + result.message});
  if (result.status != FillResult::Status::verified) {
    out.closure = Closure::failed;
    Refusal no{"the volume mesher did not fill the surface (" + result.message + ")", "",
               std::move(result.offending_triangles)};
    if (result.status == FillResult::Status::timed_out)
      no.mend = "give it longer with --timeout, or mesh fewer labels at once";
    if (result.status == FillResult::Status::crashed) no.mend = "free some memory, or mesh fewer labels at once";
    out.refusal = std::move(no);
    return out;
  }
  out.closure = Closure::verified;
  out.mesh = std::move(result.mesh);
  follow_moved(surface, *out.mesh, result.moved_points, frame, o.threads);
  if (surface.layers) take_layers(out, *surface.layers, frame, call.warnings);
  if (o.order == 2) {  // in stack coordinates, where flat caps are planes across an axis
    OrderOptions order;
    order.threads = o.threads;
    order.volumes_restored = surface.level == SurfaceLevel::enhanced;
    out.mesh = raise_order(std::move(*out.mesh), order).mesh;
  }
  if (o.refine > 0) refine(out, surface, frame, o);
  return out;
}

}  // namespace stackmesh
