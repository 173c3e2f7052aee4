#include "report/run_report.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "base/error.h"
#include "base/json_text.h"
#include "report/comparison.h"

namespace stackmesh {
namespace {

using Json = nlohmann::ordered_json;

template <class T>
Json optional(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json distance(const std::optional<Distance>& d) {
  if (!d) return nullptr;
  return {{"mean", d->mean}, {"p95", d->p95}, {"max", d->max}};
}

Json distance(const std::optional<BandDistance>& d) {
  if (!d) return nullptr;
  return {{"mean", d->mean}, {"max", d->max}, {"outside_share", d->outside_share}};
}

Json surface(const RunReport& r) {
  if (!r.surface) return nullptr;
  const SurfaceCheck& s = *r.surface;
  return {{"level", r.surface_level},
          {"vertices", s.vertices},
          {"triangles", s.triangles},
          {"open_edges", s.open_edges},
          {"self_intersections", s.self_intersections},
          {"nonmanifold_edges", s.nonmanifold_edges},
          {"angle_min_deg", s.angle_min_deg},
          {"angle_p1_deg", s.angle_p1_deg},
          {"angle_median_deg", s.angle_median_deg},
          {"edge_min_mm", s.edge_min_mm},
          {"edge_median_mm", s.edge_median_mm},
          {"mean_bend_deg", r.bends ? Json(r.bends->mean_deg) : Json(nullptr)},
          {"bends_above_40_share", r.bends ? Json(r.bends->above_40_share) : Json(nullptr)}};
}

/// Every field is there even when no volume is: null.
Json volume(const RunReport& r) {
  const auto of = [&](auto field) { return r.volume ? Json((*r.volume).*field) : Json(nullptr); };
  return {{"nodes", of(&VolumeCheck::nodes)},
          {"tets", of(&VolumeCheck::tets)},
          {"order", of(&VolumeCheck::order)},
          {"inverted", of(&VolumeCheck::inverted)},
          {"dihedral_min_deg", of(&VolumeCheck::dihedral_min_deg)},
          {"dihedral_p1_deg", of(&VolumeCheck::dihedral_p1_deg)},
          {"dihedral_max_deg", of(&VolumeCheck::dihedral_max_deg)},
          {"dihedral_below_10", of(&VolumeCheck::dihedral_below_10)},
          {"in_narrow_wedges", of(&VolumeCheck::in_narrow_wedges)},
          {"pinched", of(&VolumeCheck::pinched)},
          {"dihedral_histogram", of(&VolumeCheck::dihedral_histogram)},
          {"radius_edge_max", of(&VolumeCheck::radius_edge_max)},
          {"scaled_jacobian_min", of(&VolumeCheck::scaled_jacobian_min)},
          {"wedges", of(&VolumeCheck::wedges)},
          {"pyramids", of(&VolumeCheck::pyramids)},
          {"wedge_scaled_jacobian_min", of(&VolumeCheck::wedge_scaled_jacobian_min)},
          {"closure", r.closure}};
}

/// The largest fifty places.
Json layer(const LayerFigures& f) {
  Json places = Json::array();
  for (std::size_t i = 0; i < std::min<std::size_t>(50, f.places.size()); ++i) {
    const LayerPlace& p = f.places[i];
    places.push_back({{"at_mm", {p.at_mm.x, p.at_mm.y, p.at_mm.z}},
                      {"area_mm2", p.area_mm2},
                      {"thickness_mm", p.thickness_mm},
                      {"why", layer_limit_name(p.why)}});
  }
  return {{"label", f.label},
          {"thickness_mm", f.asked.thickness_mm},
          {"count", f.asked.count},
          {"wedges", f.wedges},
          {"pyramids", f.pyramids},
          {"tets", f.tets},
          {"area_mm2", f.area_mm2},
          {"full_share", f.full_rel},
          {"thinned_share", f.thinned_rel},
          {"missing_share", f.missing_rel},
          {"thickness_min_mm", f.thickness_min_mm},
          {"place_count", f.places.size()},
          {"places", places}};
}

Json label(const LabelReport& l) {
  return {{"label", l.label},
          {"name", l.name},
          {"colour", l.colour ? Json(*l.colour) : Json(nullptr)},
          {"void", l.is_void},
          {"closed", l.closed},
          {"components", l.components},
          {"input_components", optional(l.input_components)},
          {"euler", l.euler},
          {"input_volume_mm3", optional(l.input_volume_mm3)},
          {"surface_volume_mm3", l.surface_volume_mm3},
          {"tet_volume_mm3", optional(l.tet_volume_mm3)},
          {"tets", optional(l.tets)},
          {"wedges", optional(l.wedges)},
          {"dice", optional(l.dice)},
          {"wrong_centres", optional(l.wrong_centres)},
          {"wrong_centres_share", optional(l.wrong_centres_share)},
          {"band_distance_mm", distance(l.band_distance_mm)},
          {"distance_mm", distance(l.distance_mm)},
          {"reverse_distance_mm", distance(l.reverse_distance_mm)},
          {"caps", {{"low", l.cap_low}, {"high", l.cap_high}}},
          {"genus", optional(l.genus)},
          {"surface_area_mm2", l.surface_area_mm2},
          {"angle_min_deg", l.angle_min_deg},
          {"nonmanifold_edges", l.nonmanifold_edges},
          {"mean_bend_deg", optional(l.mean_bend_deg)},
          {"bends_above_40_share", optional(l.bends_above_40_share)},
          {"dihedral_min_deg", optional(l.dihedral_min_deg)},
          {"dihedral_max_deg", optional(l.dihedral_max_deg)},
          {"thin_share", optional(l.thin_share)},
          {"thickness_p5_mm", optional(l.thickness_p5_mm)}};
}

Json verdict(const Verdict& v) {
  return {{"id", v.id},       {"title", v.title},       {"status", to_text(v.status)}, {"figure", v.figure},
          {"limit", v.limit}, {"validity", v.validity}, {"labels", v.labels},          {"explanation", v.explanation}};
}

Json defect(const Defect& d) {
  return {{"kind", d.kind},
          {"label", d.label},
          {"where_mm", {d.where.x, d.where.y, d.where.z}},
          {"section", optional(d.section)},
          {"count", d.count},
          {"size_mm", d.size_mm},
          {"entity_kind", d.entity_kind},
          {"entities", d.entities},
          {"text", d.text}};
}

/// Every limit by its name.
template <class L, class Visit>
void each_limit(L& l, Visit visit) {
  visit("volume_warn_rel", l.volume_warn_rel), visit("volume_fail_rel", l.volume_fail_rel);
  visit("dice_warn", l.dice_warn), visit("dice_fail", l.dice_fail);
  visit("wrong_centres_warn_share", l.wrong_centres_warn_share),
      visit("wrong_centres_fail_share", l.wrong_centres_fail_share);
  visit("band_mean_warn_px", l.band_mean_warn_px), visit("band_mean_fail_px", l.band_mean_fail_px);
  visit("band_max_warn_px", l.band_max_warn_px), visit("band_max_fail_px", l.band_max_fail_px);
  visit("mean_distance_warn_px", l.mean_distance_warn_px), visit("mean_distance_fail_px", l.mean_distance_fail_px);
  visit("p95_distance_warn_px", l.p95_distance_warn_px), visit("p95_distance_fail_px", l.p95_distance_fail_px);
  visit("max_distance_warn_px", l.max_distance_warn_px), visit("max_distance_fail_px", l.max_distance_fail_px);
  visit("bends_warn_share", l.bends_warn_share);
  visit("position_warn_px", l.position_warn_px), visit("position_fail_px", l.position_fail_px);
  visit("angle_warn_deg", l.angle_warn_deg), visit("angle_fail_deg", l.angle_fail_deg);
  visit("dihedral_warn_deg", l.dihedral_warn_deg), visit("dihedral_fail_deg", l.dihedral_fail_deg);
  visit("dihedral_max_warn_deg", l.dihedral_max_warn_deg), visit("dihedral_max_fail_deg", l.dihedral_max_fail_deg);
  visit("jacobian_warn", l.jacobian_warn), visit("jacobian_fail", l.jacobian_fail);
  visit("thin_warn_share", l.thin_warn_share), visit("thin_elements", l.thin_elements);
  visit("handles_fail", l.handles_fail);
  visit("small_label_voxels", l.small_label_voxels);
}

Json json_of(double value) {
  return value;
}
Json json_of(std::size_t value) {
  return value;
}
Json json_of(const std::optional<double>& value) {
  return optional(value);
}

Json limits(const Limits& l) {
  Json j = Json::object();
  each_limit(l, [&](const char* name, const auto& value) { j[name] = json_of(value); });
  return j;
}

Json mesh(const std::optional<JudgedMesh>& m) {
  if (!m) return nullptr;
  return {{"path", m->path},         {"format", m->format},
          {"vertices", m->vertices}, {"triangles", m->triangles},
          {"tets", m->tets},         {"wedges", m->wedges},
          {"order", m->order},       {"labels", m->labels},
          {"space", m->space},       {"space_reason", m->space_reason},
          {"sha256", m->sha256}};
}

Json provenance(const std::optional<Provenance>& p) {
  if (!p) return nullptr;
  return {{"input_sha256", p->input_sha256},
          {"input_files", p->input_files},
          {"program", {{"compiler", p->compiler}, {"build_type", p->build_type}, {"sha256", p->program_sha256}}},
          {"machine",
           {{"processor", p->processor}, {"cores", p->cores}, {"memory_gib", p->memory_gib}, {"system", p->system}}},
          {"finished_utc", p->finished_utc}};
}

const char* model_name(MaterialKind kind) {
  switch (kind) {
    case MaterialKind::linear:
      return "linear";
    case MaterialKind::orthotropic:
      return "orthotropic";
    case MaterialKind::neo_hooke:
      return "neo_hooke";
    case MaterialKind::mooney_rivlin:
      return "mooney_rivlin";
    case MaterialKind::holzapfel:
      return "holzapfel";
  }
  return "";
}

Json pairs_of(const FemReport& f) {
  Json pairs = Json::array();
  for (const SurfacePair& p : f.pairs) {
    Json row = {{"name", p.name},
                {"primary", p.primary},
                {"secondary", p.secondary},
                {"parts", p.parts},
                {"contact", p.contact == Contact::tie       ? "tie"
                            : p.contact == Contact::contact ? "contact"
                                                            : "none"}};
    if (p.contact == Contact::contact) {
      row["stiffness_mpa_mm"] = p.stiffness_mpa_mm;
      row["friction"] = p.friction;
      row["stabilise"] = p.stabilise;
    }
    pairs.push_back(row);
  }
  return pairs;
}

Json materials_of(const FemReport& f) {
  Json materials = Json::array();
  for (const MaterialRow& m : f.materials)
    materials.push_back({{"label", m.label},
                         {"name", m.name},
                         {"law", m.law.empty() ? Json(nullptr) : Json(m.law)},
                         {"model", model_name(m.kind)},
                         {"elements", m.elements},
                         {"modulus_min_mpa", m.young_min_mpa},
                         {"modulus_mean_mpa", m.young_mean_mpa},
                         {"modulus_max_mpa", m.young_max_mpa},
                         {"poisson", m.poisson},
                         {"density_mean_t_mm3", m.density_mean_t_mm3},
                         {"clamped_low", m.clamped_low},
                         {"clamped_high", m.clamped_high},
                         {"materials", m.materials},
                         {"bin_error_max_rel", m.bin_error_rel},
                         {"voxels", m.voxels}});
  return materials;
}

Json steps_of(const FemReport& f) {
  Json steps = Json::array();
  for (const FemStep& s : f.steps)
    steps.push_back({{"name", s.name},
                     {"type", s.frequency ? "frequency" : "static"},
                     {"large_displacements", s.large_displacements},
                     {"supports", s.supports},
                     {"loaded_nodes", s.loaded_nodes},
                     {"pressures", s.pressures},
                     {"force_n", {s.force_n.x, s.force_n.y, s.force_n.z}},
                     {"gravity_mm_s2", {s.gravity_mm_s2.x, s.gravity_mm_s2.y, s.gravity_mm_s2.z}}});
  return steps;
}

Json accuracy_of(const FemAccuracy& a) {
  const Accuracy& e = a.estimate;
  Json rows = Json::array();
  for (const SetAccuracy& s : e.sets)
    rows.push_back({{"set", s.set},
                    {"mises_rms_mpa", s.mises_rms_mpa},
                    {"mises_max_mpa", s.mises_max_mpa},
                    {"displacement_max_mm", s.displacement_max_mm},
                    {"mises_extrapolated_mpa", s.mises_extrapolated_mpa},
                    {"order", s.order},
                    {"error_rel", s.error_rel},
                    {"displacement_error_rel", s.displacement_error_rel},
                    {"zz_rel", s.zz_rel},
                    {"held", s.held}});
  return {{"asked_rel", a.asked_rel}, {"reached", a.reached}, {"error_rel", e.error_rel}, {"worst_set", e.worst_set},
          {"elements", a.elements},   {"solve_s", a.solve_s}, {"zz_rel", e.zz_rel},       {"sets", rows}};
}

Json fem(const FemReport& f) {
  Json sets = Json::array(), skins = Json::array(), bodies = Json::array();
  for (const FemSet& s : f.sets)
    sets.push_back({{"name", s.name}, {"what", s.note}, {"nodes", s.nodes}, {"faces", s.faces}});
  for (const Body& b : f.bodies)
    bodies.push_back({{"label", b.label},
                      {"name", b.name},
                      {"elements", b.tets},
                      {"volume_mm3", b.volume_mm3},
                      {"centre_mm", {b.centre.x, b.centre.y, b.centre.z}}});
  for (const auto& [name, thickness] : f.skins) skins.push_back({{"name", name}, {"thickness_mm", thickness}});
  return {{"order", f.order},
          {"accuracy", f.accuracy ? accuracy_of(*f.accuracy) : Json(nullptr)},
          {"nodes", f.nodes},
          {"elements", f.elements},
          {"wedges", f.wedges},
          {"shells", f.shells},
          {"units", "mm, N, MPa, t/mm3"},
          {"image", f.image.empty() ? Json(nullptr) : Json(f.image)},
          {"materials_path", f.materials_path.empty() ? Json(nullptr) : Json(f.materials_path)},
          {"placeholder_materials", f.placeholder_materials},
          {"sets", sets},
          {"pairs", pairs_of(f)},
          {"materials", materials_of(f)},
          {"skins", skins},
          {"bodies", bodies},
          {"load_case",
           {{"supports", f.supports},
            {"loaded_nodes", f.loaded_nodes},
            {"force_n", {f.force_n.x, f.force_n.y, f.force_n.z}},
            {"steps", steps_of(f)}}}};
}

Json describe(const RunReport& r) {
  Json options = Json::object();
  for (const auto& [name, value] : r.options) options[name] = value;
  Json stages = Json::array();
  for (const StageTime& s : r.stages) stages.push_back({{"name", s.name}, {"wall_s", s.wall_s}, {"cpu_s", s.cpu_s}});
  Json labels = Json::array();
  for (const LabelReport& l : r.labels) labels.push_back(label(l));
  Json layers = Json::array();
  for (const LayerFigures& f : r.layers) layers.push_back(layer(f));
  Json verdicts = Json::array(), defects = Json::array();
  for (const Verdict& v : r.verdicts) verdicts.push_back(verdict(v));
  for (const Defect& d : r.defects) defects.push_back(defect(d));
  Json warning_details = Json::array();
  for (const Warning& w : r.warnings) warning_details.push_back({{"code", to_text(w.code)}, {"where", w.where}});
  const bool grid = r.input.dimensions[0] > 0;
  Json j = {{"schema", 1},
            {"stackmesh", r.version},
            {"command", r.command},
            {"options", options},
            {"input",
             {{"path", r.input.path},
              {"kind", r.input.kind},
              {"dimensions", grid ? Json(r.input.dimensions) : Json(nullptr)},
              {"spacing_mm", grid ? Json(r.input.spacing_mm) : Json(nullptr)},
              {"effective_spacing_mm", grid ? Json(r.input.effective_spacing_mm) : Json(nullptr)},
              {"axis", r.input.axis},
              {"sections", r.input.sections},
              {"space", r.input.space}}},
            {"stages", stages},
            {"peak_rss_mb", r.peak_rss_mb},
            {"contours",
             {{"loops", r.contours.loops},
              {"vertices_traced", r.contours.vertices_traced},
              {"vertices", r.contours.vertices}}},
            {"stitched",
             {{"vertices", r.stitched.vertices},
              {"triangles", r.stitched.triangles},
              {"open_edges", r.stitched.open_edges},
              {"self_intersections", r.stitched.self_intersections},
              {"added_points", r.stitched.added_points}}},
            {"surface", surface(r)},
            {"volume", volume(r)},
            {"labels", labels},
            {"layers", layers},
            {"mesh", mesh(r.mesh)},
            {"verdict", r.verdicts.empty() ? Json(nullptr) : Json(to_text(overall(r.verdicts)))},
            {"verdicts", verdicts},
            {"defects", defects},
            {"limits", limits(r.limits)},
            {"provenance", provenance(r.provenance)},
            {"warnings", texts_of(r.warnings)},
            {"warning_details", warning_details}};
  if (r.fem) j["fem"] = fem(*r.fem);
  return j;
}

/// File names need not be valid UTF-8: what is not is replaced.
std::string text_of(const Json& j) {
  return j.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

double number_of(double value) {
  return value;
}
double number_of(std::size_t value) {
  return static_cast<double>(value);
}
double number_of(const std::optional<double>& value) {
  return value.value_or(std::numeric_limits<double>::quiet_NaN());
}

void set_limit(double& limit, const Json& value) {
  limit = value.get<double>();
}
void set_limit(std::size_t& limit, const Json& value) {
  limit = value.get<std::size_t>();
}
void set_limit(std::optional<double>& limit, const Json& value) {
  limit = value.get<double>();
}

}  // namespace

std::vector<std::pair<std::string, double>> named_limits(const Limits& limits) {
  std::vector<std::pair<std::string, double>> named;
  each_limit(limits, [&](const char* name, const auto& value) { named.emplace_back(name, number_of(value)); });
  return named;
}

std::string to_json(const RunReport& report) {
  return text_of(describe(report));
}

std::string to_json(const std::vector<RunReport>& reports) {
  Json meshes = Json::array(), rows = Json::array(), names = Json::array();
  for (const RunReport& r : reports) {
    meshes.push_back(describe(r));
    names.push_back(r.mesh ? r.mesh->path : r.input.path);
  }
  for (const ComparisonRow& row : compare(reports)) {
    Json values = Json::array();
    for (const double v : row.values) values.push_back(std::isfinite(v) ? Json(v) : Json(nullptr));
    rows.push_back({{"id", row.id}, {"name", row.name}, {"values", values}, {"best", row.best}});
  }
  return text_of({{"schema", 1},
                  {"stackmesh", reports.empty() ? "" : reports[0].version},
                  {"command", "validate"},
                  {"comparison", {{"meshes", names}, {"rows", rows}}},
                  {"meshes", meshes}});
}

Limits read_limits(const std::string& path) {
  const Json j =
      Json::parse(read_json_text(path, "the file of limits", "check the name and the rights"), nullptr, false);
  if (j.is_discarded() || !j.is_object())
    fail_input("the limits are no JSON object", path,
               "write {\"dice_warn\": 0.9, ...}; a report lists the names under limits");
  Limits limits;
  std::string known;
  for (const auto& [key, value] : j.items()) {
    bool found = false;
    each_limit(limits, [&, name = key, given = value](const char* field, auto& into) {
      if (name != field) return;
      found = true;
      // as a report lists it
      if (given.is_null() && std::is_same_v<std::decay_t<decltype(into)>, std::optional<double>>) return;
      if (!given.is_number() || given.template get<double>() < 0)
        fail_input("the limit '" + name + "' is no number from 0", path, "give a number");
      set_limit(into, given);
    });
    if (!found) fail_input("there is no limit '" + key + "'", path, "a report lists the names under limits");
  }
  return limits;
}

std::string names_to_json(const RunReport& r) {
  Json labels = Json::array();
  for (const LabelReport& l : r.labels)
    labels.push_back({{"label", l.label}, {"name", l.name}, {"colour", l.colour ? Json(*l.colour) : Json(nullptr)}});
  return Json{{"labels", labels}}.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace stackmesh
