#include "run/complete_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>

#include "base/cancel.h"
#include "base/warning.h"
#include "validate/boundaries.h"
#include "validate/check_bends.h"
#include "validate/check_thickness.h"
#include "validate/check_topology.h"
#include "validate/defects.h"

namespace stackmesh {
namespace {

void fill_thickness(RunReport& report, const std::vector<LabelThickness>& thickness) {
  for (LabelReport& row : report.labels)
    for (const LabelThickness& t : thickness)
      if (t.label == row.label) {
        row.thin_share = t.thin_share;
        row.thickness_p5_mm = t.p5_mm;
      }
}

void fill_bends(RunReport& report, const BendCheck& bends) {
  if (bends.surface.edges > 0) report.bends = bends.surface;
  for (LabelReport& row : report.labels)
    for (const LabelBends& b : bends.labels)
      if (b.label == row.label && b.bends.edges > 0) {
        row.mean_bend_deg = b.bends.mean_deg;
        row.bends_above_40_share = b.bends.above_40_share;
      }
}

std::function<std::optional<int>(const Vec3&)> section_finder(const Judged& j) {
  if (j.volume)
    return [&v = *j.volume, axis = j.axis](const Vec3& p) -> std::optional<int> {
      const double at = dot(p - v.origin_mm, v.axes[axis]) / v.spacing_mm[axis];
      return static_cast<int>(std::clamp(std::round(at), 0.0, v.size[axis] - 1.0));
    };
  if (j.sections && !j.sections->sections.empty())
    return [&s = *j.sections](const Vec3& p) -> std::optional<int> {
      const double z = s.frame.to_stack(p).z;
      std::size_t best = 0;
      for (std::size_t k = 1; k < s.sections.size(); ++k)
        if (std::abs(s.sections[k].z_mm - z) < std::abs(s.sections[best].z_mm - z)) best = k;
      return static_cast<int>(best);
    };
  return nullptr;
}

/// Where a label's surplus handles are: its narrowest.
void add_handles(RunReport& report, const InterfaceComplex& surface, const LabelTopology& t,
                 const std::function<std::optional<int>(const Vec3&)>& section_of) {
  if (t.surplus() == 0) return;
  for (HandlePlace& h :
       find_handles(surface, t.label, std::min<std::size_t>(100, static_cast<std::size_t>(t.surplus())))) {
    Defect d;
    d.kind = "handle";
    d.label = t.label;
    d.where = h.where;
    if (section_of) d.section = section_of(h.where);
    d.entity_kind = "triangles";
    d.entities.assign(h.triangles.begin(), h.triangles.end());
    d.size_mm = h.size_mm;
    char text[160];
    std::snprintf(text, sizeof text,
                  "Label %d has a handle or tunnel about %.3g mm wide at (%.2f, %.2f, %.2f) mm that no slice asks for.",
                  static_cast<int>(t.label), h.size_mm, h.where.x, h.where.y, h.where.z);
    d.text = text;
    report.defects.push_back(std::move(d));
  }
}

/// Pieces of a label beyond those that the drawn sections imply, one by one: its smallest.
void add_loose_pieces(RunReport& report, const InterfaceComplex& surface, const Boundaries& pieces,
                      const LabelTopology& t, const std::function<std::optional<int>(const Vec3&)>& section_of) {
  std::vector<std::int32_t> outer;
  for (std::size_t s = 0; s < pieces.piece_row.size(); ++s)
    if (pieces.labels[pieces.piece_row[s]].label == t.label && pieces.piece_volume_mm3[s] > 0)
      outer.push_back(static_cast<std::int32_t>(s));
  std::stable_sort(outer.begin(), outer.end(), [&](std::int32_t a, std::int32_t b) {
    return pieces.piece_volume_mm3[a] < pieces.piece_volume_mm3[b];
  });
  outer.resize(std::min<std::size_t>({outer.size(), static_cast<std::size_t>(t.pieces - t.implied_pieces), 100}));
  for (const std::int32_t piece : outer) {
    Defect d;
    d.kind = "loose_piece";
    d.label = t.label;
    Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    d.entity_kind = "triangles";
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
      if (pieces.piece[i][0] != piece && pieces.piece[i][1] != piece) continue;
      d.entities.push_back(static_cast<std::int32_t>(i));
      for (const std::int32_t v : surface.triangles[i].v) {
        const Vec3& p = surface.points[v];
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
      }
    }
    d.where = 0.5 * (low + high);
    d.size_mm = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
    if (section_of) d.section = section_of(d.where);
    char text[240];
    std::snprintf(text, sizeof text,
                  "Label %d has a piece of its own of %.3g mm3 at (%.2f, %.2f, %.2f) mm, from (%.1f, %.1f, %.1f) to "
                  "(%.1f, %.1f, %.1f), that the sections do not imply.",
                  static_cast<int>(t.label), pieces.piece_volume_mm3[piece], d.where.x, d.where.y, d.where.z, low.x,
                  low.y, low.z, high.x, high.y, high.z);
    d.text = text;
    report.warnings.push_back(
        {WarningCode::piece_not_implied, "label " + std::to_string(t.label),
         "label" + d.text.substr(5, d.text.size() - 6) + "; --min-piece or --keep-largest leaves it out"});
    report.defects.push_back(std::move(d));
  }
}

}  // namespace

void add_label_rows(RunReport& report, const std::vector<LabelInfo>& labels) {
  for (const LabelInfo& l : labels) {
    LabelReport row;
    row.label = l.number;
    row.name = l.name;
    row.colour = l.colour;
    report.labels.push_back(std::move(row));
  }
}

void check_mesh(RunReport& report, const InterfaceComplex& surface, const TetMesh* mesh, int threads) {
  SurfaceCheckOptions check;
  check.threads = threads;
  check.list_limit = 20000;
  report.surface = check_surface(surface, check);
  report.surface_level = "";
  if (mesh == nullptr) return;
  std::vector<char> used(surface.points.size(), 0);  // the points inside are no vertices of the surface
  for (const InterfaceTriangle& t : surface.triangles)
    for (const std::int32_t v : t.v) used[v] = 1;
  report.surface->vertices = static_cast<std::size_t>(std::count(used.begin(), used.end(), 1));
  report.volume = check_volume(*mesh, {threads});
  const bool fine = report.volume->inverted == 0 && report.volume->conforms && report.surface->open_edges == 0 &&
                    report.surface->self_intersections == 0;
  report.closure = fine ? "verified" : "failed";
}

void fill_label_rows(RunReport& report, const std::vector<LabelFidelity>* fidelity) {
  for (LabelReport& row : report.labels) {
    for (const LabelSurface& s : report.surface->labels)
      if (s.label == row.label) {
        row.closed = s.closed;
        row.components = s.components;
        row.euler = s.euler;
        if (s.closed) row.genus = s.genus;
        row.surface_volume_mm3 = s.volume_mm3;
        row.surface_area_mm2 = s.area_mm2;
        row.angle_min_deg = s.angle_min_deg;
        row.nonmanifold_edges = s.nonmanifold_edges;
      }
    if (report.volume)
      for (const LabelTets& t : report.volume->labels)
        if (t.label == row.label) {
          row.tets = t.tets;
          row.wedges = t.wedges;
          row.tet_volume_mm3 = t.volume_mm3;
          row.dihedral_min_deg = t.dihedral_min_deg;
          row.dihedral_max_deg = t.dihedral_max_deg;
        }
    if (!fidelity) continue;
    for (const LabelFidelity& f : *fidelity)
      if (f.label == row.label) {
        row.dice = f.dice;
        row.wrong_centres = f.wrong_centres;
        row.wrong_centres_share = f.wrong_centres_share;
        row.band_distance_mm = f.band_distance_mm;
        row.distance_mm = f.distance_mm;
        row.reverse_distance_mm = f.reverse_distance_mm;
        row.input_components = f.input_components;
      }
  }
}

void complete_report(RunReport& report, const Judged& j) {
  ThicknessOptions thick;
  thick.threads = j.threads;
  thick.elements = report.limits.thin_elements;
  const std::vector<LabelThickness> thickness = check_thickness(*j.surface, thick);
  stop_if_cancelled();
  fill_label_rows(report, j.fidelity);
  fill_thickness(report, thickness);
  const BendCheck bends = check_bends(*j.surface, j.threads);
  fill_bends(report, bends);
  stop_if_cancelled();
  JudgeInput in;
  in.surface = &*report.surface;
  if (report.volume) in.volume = &*report.volume;
  in.thickness = &thickness;
  in.bends = &bends;
  in.fidelity = j.fidelity;
  for (const LabelReport& row : report.labels) {
    in.labels.push_back({row.label, row.name});
    in.input_volume_mm3.push_back(row.input_volume_mm3.value_or(0));
  }
  if (j.volume) {
    in.pixel_mm = std::numeric_limits<double>::infinity(), in.voxel_mm = 0;
    for (int k = 0; k < 3; ++k) {
      if (k != j.axis) in.pixel_mm = std::min(in.pixel_mm, j.volume->spacing_mm[k]);
      in.voxel_mm = std::max(in.voxel_mm, j.volume->spacing_mm[k]);
    }
  }
  TopologyOptions nests;
  nests.axis = j.axis;
  nests.threads = j.threads;
  const std::vector<LabelTopology> topology = j.volume     ? check_topology(*report.surface, *j.volume, nests)
                                              : j.sections ? check_topology(*report.surface, *j.sections, nests)
                                                           : std::vector<LabelTopology>();
  if (j.volume || j.sections) in.topology = &topology;
  stop_if_cancelled();
  report.verdicts = judge(in, report.limits);
  DefectOptions where;
  where.poor_angle_deg = report.limits.angle_warn_deg;
  where.poor_dihedral_deg = report.limits.dihedral_warn_deg;
  where.section_of = section_finder(j);
  report.defects = find_defects(*j.surface, *report.surface, j.mesh, in.volume, j.fidelity, where);
  for (const LabelTopology& t : topology) {
    stop_if_cancelled();
    add_handles(report, *j.surface, t, where.section_of);
  }
  std::optional<Boundaries> pieces;
  for (const LabelTopology& t : topology) {
    if (!j.sections || t.implied_pieces <= 0 || t.pieces <= t.implied_pieces) continue;
    if (!pieces) pieces = find_boundaries(*j.surface, 1);
    add_loose_pieces(report, *j.surface, *pieces, t, where.section_of);
  }
}

}  // namespace stackmesh
