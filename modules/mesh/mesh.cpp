#include "mesh/mesh.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "base/cancel.h"
#include "base/warning.h"
#include "fair/true_grid.h"
#include "mesh/stages.h"
#include "model/space.h"
#include "sections/far_sections.h"
#include "sections/virtual_sections.h"

namespace stackmesh {
namespace {

/// Bounds on the tetrahedra's volume tell how many there will be, before anything is made.
void refuse_too_small(const std::map<Label, double>& volume_mm3, const MeshOptions& o) {
  if (o.target != Target::volume) return;
  double filled = 0, bounded = 0;
  for (const auto& [label, mm3] : volume_mm3) {
    if (o.voids.count(label) == 0) filled += mm3;
    if (const auto most = o.fill.label_max_volume_mm3.find(label); most != o.fill.label_max_volume_mm3.end())
      bounded += 1.5 * mm3 / most->second;
  }
  if (o.fill.max_volume_mm3) refuse_too_many(1.5 * filled / *o.fill.max_volume_mm3, o);
  refuse_too_many(bounded, o);
}

std::map<Label, double> volumes_of(const LabelVolume& v) {
  const std::vector<std::size_t> counts = count_voxels(v);
  std::map<Label, double> mm3;
  for (std::size_t k = 1; k < v.labels.size(); ++k)
    mm3[v.labels[k].number] = static_cast<double>(counts[k]) * v.voxel_volume_mm3();
  return mm3;
}

SectionStage sections_of(const LabelVolume& volume, LabelMesh& out, const Call& call) {
  SectionOptions options = call.options.sections;
  options.faired_surface = call.options.enhance;
  options.contours.threads = call.options.threads;
  check_slices(volume, options.contours.axis, call.options.input_name);
  SectionStage s;
  s.far_apart = long_voxels(volume);
  if (!s.far_apart.empty() && !options.virtual_sections) options.virtual_sections = 0;
  VolumeSections made = volume_sections(volume, options, call.monitor);
  for (const Warning& w : made.warnings) call.warnings.push_back(w);
  s.faired = std::move(made.faired);
  s.stack = std::move(made.contours.stack);
  out.contours.axis = made.contours.axis;
  out.contours.loops = made.contours.loops;
  out.contours.vertices_traced = made.contours.vertices_traced;
  out.contours.vertices = made.contours.vertices;
  return s;
}

/// Of drawn sections: virtual ones between those that lie far apart.
SectionStage sections_of(Stack stack, LabelMesh& out, const Call& call) {
  SectionStage s;
  s.drawn = true;
  s.stack = std::move(stack);
  for (const Section& section : s.stack.sections) out.contours.vertices_traced += section.points.size();
  add_virtual_sections(s.stack, call.options.sections.virtual_sections, call.options.threads, call.warnings);
  for (const Section& section : s.stack.sections) out.contours.vertices += section.points.size();
  return s;
}

/// Why the mesh is not valid; what the volume mesher said comes after what the checks say.
std::optional<Refusal> refusal_of(const LabelMesh& m, std::optional<Refusal> of_tets) {
  Refusal no = of_tets.value_or(Refusal{});
  const SurfaceCheck& s = m.surface_check;
  if (s.open_edges > 0 || s.self_intersections > 0) {
    no.problem = "the stitched surface has " + std::to_string(s.open_edges) + " open edges and " +
                 std::to_string(s.self_intersections) + " self-intersections";
    for (const auto& pair : s.intersecting_pairs) no.triangles.insert(no.triangles.end(), pair.begin(), pair.end());
  } else if (m.tets_check && (m.tets_check->inverted > 0 || !m.tets_check->conforms)) {
    no.problem = "the volume mesh has " + std::to_string(m.tets_check->inverted) + " inverted " +
                 (m.tets->wedges.empty() ? "tetrahedra" : "elements") + " and " +
                 std::to_string(m.tets_check->nonconforming_faces + m.tets_check->nonconforming_edges) +
                 " faces or edges that do not conform";
  }
  if (no.problem.empty()) return std::nullopt;
  if (no.mend.empty()) no.mend = "try --simplify 0, and report the input";
  std::sort(no.triangles.begin(), no.triangles.end());
  no.triangles.erase(std::unique(no.triangles.begin(), no.triangles.end()), no.triangles.end());
  return no;
}

void warn_of_flat_tets(const LabelMesh& m, std::vector<Warning>& warnings) {
  const VolumeCheck& v = *m.tets_check;
  if (m.level != SurfaceLevel::enhanced || (v.dihedral_min_deg >= 1 && v.dihedral_max_deg <= 179)) return;
  char text[120];
  std::snprintf(text, sizeof text, "the flattest tetrahedra have dihedral angles of %.2f to %.2f degrees",
                v.dihedral_min_deg, v.dihedral_max_deg);
  warnings.push_back({WarningCode::flat_elements, "",
                      std::string(text) + ": a solver may fail on them; the report's defects say where (--report "
                                          "R.html), another --edge-length may avoid them"});
}

/// From sections to the checked mesh.
void finish(SectionStage sections, LabelMesh& out, const Call& call) {
  const MeshOptions& o = call.options;
  for (const Section& s : sections.stack.sections) out.contours.sections += s.interpolated ? 0 : 1;
  StitchedStage stitched = call.clock.run("stitch", [&] { return stitch_stage(std::move(sections), out, call); });
  out.frame = stitched.frame;
  out.sections = std::move(stitched.stack);
  SurfaceStage surface = surface_stage(std::move(stitched), call);
  if (o.target == Target::volume && surface.judged.is_sound() && !surface.filled)
    call.clock.run("volume", [&] { fill_stage(surface, call); });
  TetStage tets;
  if (surface.filled) tets = call.clock.run("volume", [&] { return tet_stage(surface, out.frame, call); });
  out.stitched.open_edges = surface.stitched_check.open_edges;
  out.stitched.self_intersections = surface.stitched_check.self_intersections;
  out.level = surface.level;
  out.lost_detail = std::move(surface.lost_detail);
  out.surface = std::move(surface.judged.world);
  out.surface_check = std::move(surface.judged.check);
  out.behind = std::move(surface.hollowed.behind);
  out.closure = tets.closure;
  out.tets = std::move(tets.mesh);
  out.layers = std::move(tets.layers);
  call.clock.run("validate", [&] {
    if (!out.tets) return;
    change_space(*out.tets, out.frame.world, out.frame);
    out.tets_check = check_volume(*out.tets, {o.threads});
    warn_of_flat_tets(out, call.warnings);
  });
  if (std::optional<Refusal> no = refusal_of(out, std::move(tets.refusal))) {
    out.closure = o.target == Target::volume ? Closure::failed : Closure::skipped;
    throw MeshRefused(*no, std::move(out), o.input_name);
  }
}

/// @param release gives the voxels' memory back once they are sections
template <class Release>
LabelMesh mesh_volume(const LabelVolume& given, const MeshOptions& options, Monitor& monitor, Release release) {
  check_label_volume(given, options.input_name);
  const CancelScope scope(&monitor);
  LabelMesh out;
  StageClock clock(monitor, out.stages);
  const Call call{options, monitor, clock, out.warnings};
  out.labels.assign(given.labels.begin() + 1, given.labels.end());
  std::optional<LabelVolume> changed;  // a copy, where pieces are left out or the labels were made on a coarser grid
  SectionStage sections = clock.run("contours", [&] {
    if (options.pieces.any()) keep_pieces(changed.emplace(given), options.pieces, out.warnings);
    out.input_volume_mm3 = volumes_of(changed ? *changed : given);
    if (options.sections.band_px > 0 && !options.sections.as_stored)
      if (std::optional<TrueGrid> grid = find_true_grid(changed ? *changed : given, options.threads)) {
        out.warnings.push_back({WarningCode::coarser_grid, "",
                                true_grid_warning((changed ? *changed : given).spacing_mm, grid->volume.spacing_mm)});
        changed = std::move(grid->volume);
      }
    const LabelVolume& volume = changed ? *changed : given;
    out.contours.effective_spacing_mm = volume.spacing_mm;
    refuse_too_small(out.input_volume_mm3, options);
    return sections_of(volume, out, call);
  });
  sections.volume_mm3 = out.input_volume_mm3;
  if (options.keep_judged) out.changed_labels = std::move(changed);
  changed.reset();
  release();
  finish(std::move(sections), out, call);
  return out;
}

}  // namespace

LabelMesh mesh_labels(const LabelVolume& volume, const MeshOptions& options, Monitor& monitor) {
  return mesh_volume(volume, options, monitor, [] {});
}

LabelMesh mesh_labels(LabelVolume&& volume, const MeshOptions& options, Monitor& monitor) {
  return mesh_volume(volume, options, monitor, [&] { volume.voxels = {}; });
}

LabelMesh mesh_sections(Stack stack, const MeshOptions& options, Monitor& monitor) {
  const CancelScope scope(&monitor);
  LabelMesh out;
  StageClock clock(monitor, out.stages);
  const Call call{options, monitor, clock, out.warnings};
  out.labels.assign(stack.labels.begin() + 1, stack.labels.end());
  SectionStage sections = clock.run("contours", [&] { return sections_of(std::move(stack), out, call); });
  finish(std::move(sections), out, call);
  return out;
}

LabelMesh mesh_contours(const std::vector<LabelContours>& contours, const MeshOptions& options,
                        const ContourStackOptions& drawn, Monitor& monitor) {
  ContourStackOptions how = drawn;
  how.caps = options.stitch.caps;
  how.label_caps = options.stitch.label_caps;
  std::vector<Warning> warnings;
  Stack stack = sections_from_contours(contours, warnings, how);
  LabelMesh out = mesh_sections(std::move(stack), options, monitor);
  out.warnings.insert(out.warnings.begin(), warnings.begin(), warnings.end());
  return out;
}

void refuse_too_many(double tets, const MeshOptions& options) {
  if (options.many_tets || tets <= 1e7) return;
  char text[32];
  std::snprintf(text, sizeof text, "%.0f", tets / 1e6);
  fail_usage("about " + std::string(text) + " million tetrahedra would be made", options.input_name,
             "ask for larger ones with --edge-length or --max-volume, or say --yes if you want that many");
}

}  // namespace stackmesh
