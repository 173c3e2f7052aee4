#include "run/mesh_run.h"

#include <algorithm>
#include <utility>

#include "base/cancel.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/stage_clock.h"
#include "base/text.h"
#include "base/warning.h"
#include "mesh/voids.h"
#include "model/label_table.h"
#include "model/space.h"
#include "report/html_report.h"
#include "run/complete_report.h"
#include "run/mesh_product.h"
#include "run/output_files.h"
#include "run/provenance.h"
#include "run/report_names.h"

namespace stackmesh {
namespace {

/// The input of a run, its mesh, and what is written of it.
class MeshRun {
 public:
  MeshRun(const MeshRunOptions& options, Monitor& progress, const ModelStage& model)
      : o_(options), model_(model), clock_(progress, report_.stages), progress_(progress) {}

  RunReport run(const LabelsStage& labels, const MadeStage& made) {
    const CancelScope scope(&progress_);
    check_mesh_outputs(o_);
    report_.command = o_.command;
    report_.version = o_.version;
    report_.options = o_.option_texts;
    report_.warnings = o_.notes;
    clock_.run("read", [&] { read(); });
    if (labels) labels(filled_labels());
    const std::optional<Refusal> refusal = make_mesh();
    clock_.run("validate", [&] { judge(); });
    if (refusal) write_offending(*refusal);
    const bool valid = !refusal && !(o_.strict && !lost_detail_.empty());
    if (valid && model_ && mesh_.tets) clock_.run("write", [&] { make_model(); });
    clock_.run("write", [&] {
      if (valid) write();
      if (asks_for_html(o_.reports)) draw();
    });
    report_.peak_rss_mb = peak_memory_mb();
    write_reports();
    files_.commit();
    if (refusal) throw Error(ErrorKind::no_result, refusal->problem, report_.input.path, refusal->mend);
    if (!valid) throw Error(ErrorKind::no_result, lost_detail_, report_.input.path, "leave --strict out to accept it");
    if (made) made({std::move(mesh_.surface), std::move(mesh_.tets), write_options(), !input_.voids.empty()});
    return std::move(report_);
  }

 private:
  void warn(Warning w) { report_.warnings.push_back(std::move(w)); }

  void read() {
    InputOptions input = o_.input;
    input.caps = o_.mesh.stitch.caps;
    input.label_caps = o_.label_caps_text;
    input_ = read_input(input);
    check_stack_axis(input_, o_.mesh.sections.contours.axis);
    if (!input_.volume && o_.mesh.sections.band_asked)
      fail_usage("--band has no meaning for drawn contours, which are kept exactly", input_.path, "leave it out");
    report_.input.path = input_.path;
    report_.input.files = o_.input.paths;
    report_.input.kind = input_.kind;
    const bool anatomical = input_.anatomical;
    if (o_.space == "ras" && !anatomical)
      fail_usage("--space ras needs an input with anatomical axes", input_.path,
                 "leave --space out: coordinates are kept as they are");
    written_ = !anatomical ? Space::none : o_.space == "ras" ? Space::ras : Space::lps;
    report_.input.space = to_text(written_);
    add_label_rows(report_, input_.labels);
    for (LabelReport& row : report_.labels) row.is_void = input_.voids.count(row.label) > 0;
    if (!input_.volume) return;
    report_.input.dimensions = input_.volume->size;
    report_.input.spacing_mm = report_.input.effective_spacing_mm = input_.volume->spacing_mm;
  }

  std::vector<LabelInfo> filled_labels() const {
    std::vector<LabelInfo> filled;
    for (const LabelInfo& l : input_.labels)
      if (input_.voids.count(l.number) == 0) filled.push_back(l);
    return filled;
  }

  /// --strict must know of a lost component, too.
  bool wants_fidelity() const { return !o_.reports.empty() || o_.full_report || o_.strict; }

  MeshOptions mesh_options() const {
    MeshOptions m = o_.mesh;
    m.voids = input_.voids;
    m.input_name = input_.path;
    m.keep_judged = wants_fidelity();
    const LabelTable known(input_.labels);
    m.stitch.label_caps = known.values(o_.label_caps_text, "--caps");
    m.enhancement.label_edge_mm = known.values(o_.label_edges_text, "--edge-length");
    m.fill.label_max_volume_mm3 = known.values(o_.label_volumes_text, "--max-volume");
    m.layers = resolve_layers(o_.layers, input_.labels, input_.voids);
    return m;
  }

  LabelMesh mesh_of_input(const MeshOptions& options) {
    if (!input_.volume)
      return mesh_sections(clock_.run("contours", [&] { return drawn_sections(input_); }), options, progress_);
    if (wants_fidelity()) return mesh_labels(*input_.volume, options, progress_);
    return mesh_labels(std::move(*input_.volume), options, progress_);
  }

  /// The mesh in memory, and why it is no valid one.
  std::optional<Refusal> make_mesh() {
    std::optional<Refusal> refusal;
    try {
      mesh_ = mesh_of_input(mesh_options());
    } catch (MeshRefused& e) {
      mesh_ = std::move(*e.partial);
      refusal = e.refusal;
    }
    take_figures();
    return refusal;
  }

  void take_figures() {
    for (const Warning& w : input_.warnings) warn(w);
    for (const Warning& w : mesh_.warnings) warn(w);
    for (const StageTime& t : mesh_.stages) add_stage_time(report_.stages, t);
    lost_detail_ = mesh_.lost_detail;
    report_.input.axis = std::string(1, "xyz"[mesh_.contours.axis]);
    report_.input.sections = mesh_.contours.sections;
    if (input_.volume) report_.input.effective_spacing_mm = mesh_.contours.effective_spacing_mm;
    report_.contours.loops = mesh_.contours.loops;
    report_.contours.vertices_traced = mesh_.contours.vertices_traced;
    report_.contours.vertices = mesh_.contours.vertices;
    report_.stitched.vertices = mesh_.stitched.vertices;
    report_.stitched.triangles = mesh_.stitched.triangles;
    report_.stitched.added_points = mesh_.stitched.added_points;
    report_.stitched.open_edges = mesh_.stitched.open_edges;
    report_.stitched.self_intersections = mesh_.stitched.self_intersections;
    report_.surface_level = to_text(mesh_.level);
    report_.surface = mesh_.surface_check;
    report_.volume = mesh_.tets_check;
    report_.layers = mesh_.layers;
    report_.closure = mesh_.closure == Closure::verified ? "verified"
                      : mesh_.closure == Closure::failed ? "failed"
                                                         : "skipped";
    for (LabelReport& row : report_.labels) {
      if (const auto v = mesh_.input_volume_mm3.find(row.label); v != mesh_.input_volume_mm3.end())
        row.input_volume_mm3 = v->second;
      const auto caps = mesh_.stitched.caps.find(row.label);
      if (caps == mesh_.stitched.caps.end()) continue;
      row.cap_low = caps->second.low;
      row.cap_high = caps->second.high;
    }
  }

  /// The labels as they were meshed; null of contours.
  const LabelVolume* labels() const {
    return mesh_.changed_labels ? &*mesh_.changed_labels : input_.volume ? &*input_.volume : nullptr;
  }

  void judge() {
    if (wants_fidelity() && labels() != nullptr) judge_fidelity();
    fill_label_rows(report_, fidelity_.empty() ? nullptr : &fidelity_);
    for (const LabelReport& row : report_.labels)
      if (!row.closed)
        warn({WarningCode::not_closed, "label " + std::to_string(row.label),
              "label " + std::to_string(row.label) + " has no closed surface"});
    if (!o_.reports.empty() || o_.full_report) give_verdicts();
  }

  void give_verdicts() {
    Judged j;
    j.surface = &mesh_.surface;
    if (mesh_.tets) j.mesh = &*mesh_.tets;
    if (labels() != nullptr) j.volume = labels();
    else if (!mesh_.sections.sections.empty()) j.sections = &mesh_.sections;
    j.axis = mesh_.contours.axis;
    if (!fidelity_.empty()) j.fidelity = &fidelity_;
    j.threads = o_.mesh.threads;
    complete_report(report_, j);
    report_.provenance = find_provenance(o_.input.paths);
  }

  void judge_fidelity() {
    FidelityOptions options;
    options.threads = o_.mesh.threads;
    options.stack_axis = mesh_.contours.axis;
    fidelity_ = check_fidelity(mesh_.surface, *labels(), options);
    for (const LabelFidelity& f : fidelity_)
      if (f.missing_components > 0)
        lost(warning_at(WarningCode::pieces_lost, "label " + std::to_string(f.label),
                        std::to_string(f.missing_components) + " of " + std::to_string(f.input_components) +
                            " components are missing"));
      else if (!f.components_match)
        lost(warning_at(WarningCode::pieces_lost, "label " + std::to_string(f.label),
                        "the surface's pieces do not match the input's components one to one"));
  }

  void lost(const Warning& w) {
    warn(w);
    lost_detail_ = lost_detail_.empty() ? w.text : lost_detail_;
  }

  void write_offending(const Refusal& refusal) {
    if (refusal.triangles.empty() || (o_.outputs.empty() && o_.reports.empty())) return;
    InterfaceComplex part;
    part.points = mesh_.surface.points;
    part.space = mesh_.surface.space;
    for (std::int32_t t : refusal.triangles) part.triangles.push_back(mesh_.surface.triangles[t]);
    const std::string base = o_.outputs.empty() ? o_.reports[0] : o_.outputs[0];
    const std::string path = base.substr(0, base.rfind('.')) + ".offending.vtp";
    write_surface(files_, path, part, write_options());
    warn({WarningCode::file_written, path, "the offending triangles are in " + path});
  }

  MeshWriteOptions write_options() const {
    MeshWriteOptions w = o_.write;
    w.labels = input_.labels;
    return w;
  }

  /// With voids: what bounds the filled labels; the voids' own surfaces are whole beside them.
  InterfaceComplex written_surface() {
    if (mesh_.tets && o_.mesh.refine > 0) name_voids(mesh_.surface.triangles, mesh_.behind);
    if (o_.write.per_label) return std::move(mesh_.surface);
    Hollowed of_filled = hollowed(mesh_.surface, input_.voids);
    name_voids(of_filled.complex.triangles, of_filled.behind);
    return std::move(of_filled.complex);
  }

  void write() {
    change_space(mesh_.surface, written_);
    if (mesh_.tets) change_space(*mesh_.tets, written_);
    if (mesh_.tets) name_voids(mesh_.tets->faces, mesh_.behind);
    if (!input_.voids.empty()) mesh_.surface = written_surface();
    for (const std::string& path : o_.outputs) {
      stop_if_cancelled();
      if (is_surface_format(path)) {
        write_surface(files_, path, mesh_.surface, write_options());
        if (ends_with(path, ".stl")) check_rounded(path);
      } else if (!model_) {
        if (ends_with(path, ".mesh") && !mesh_.tets->wedges.empty())
          warn(warning_at(WarningCode::format_loss, path,
                          "the format has no pyramids; wedges and pyramids are divided into tetrahedra"));
        write_volume(files_, path, *mesh_.tets, write_options());
      }
    }
    const std::string names = names_to_json(report_);
    for (const std::string& path : o_.names_outputs)
      files_.write(path, [&](std::FILE* f) { std::fwrite(names.data(), 1, names.size(), f); });
  }

  /// The mesh in the frame that will be written, for the solver model.
  void make_model() {
    TetMesh mesh;
    if (asks_for_html(o_.reports)) {
      mesh = *mesh_.tets;  // the page shows it
    } else {
      mesh = std::move(*mesh_.tets);
      mesh_.tets.reset();
    }
    name_voids(mesh.faces, mesh_.behind);
    model_(mesh_product(std::move(mesh), input_.labels, written_, mesh_.frame.axes[2], labels()), report_, files_);
  }

  /// STL keeps 24 bits of a coordinate: what is written is checked again.
  void check_rounded(const std::string& path) {
    InterfaceComplex rounded = mesh_.surface;
    for (Vec3& p : rounded.points) p = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    SurfaceCheckOptions check;
    check.threads = o_.mesh.threads;
    const SurfaceCheck s = check_surface(rounded, check);
    if (s.self_intersections > 0)
      warn(warning_at(WarningCode::format_loss, path,
                      "rounding to STL's 32-bit coordinates makes " + std::to_string(s.self_intersections) +
                          " pairs of triangles touch or cross; the other formats keep the checked surface"));
  }

  void draw() {
    HtmlScene scene;
    scene.surface = &mesh_.surface;
    if (mesh_.tets) scene.mesh = &*mesh_.tets;
    if (labels() != nullptr) scene.volume = labels();
    else scene.sections = &mesh_.sections;
    scene.stack_axis = mesh_.contours.axis;
    InterfaceComplex of_model;  // corners of second-order tetrahedra lie beside the surface's
    if (report_.fem && mesh_.tets) {
      of_model = {mesh_.tets->points, mesh_.tets->faces, mesh_.tets->space};
      scene.surface = &of_model;
      scene.values = &report_.fem->faces;
    }
    HtmlOptions options;
    options.threads = o_.mesh.threads;
    pictures_ = draw_pictures(scene, options);
  }

  void write_reports() {
    for (const std::string& path : o_.reports) {
      const std::string text = is_html_report(path) ? to_html({{"mesh", &report_, &pictures_}}) : to_json(report_);
      files_.write(path, [&](std::FILE* f) { std::fwrite(text.data(), 1, text.size(), f); });
    }
  }

  const MeshRunOptions& o_;
  const ModelStage& model_;
  RunReport report_;
  StageClock clock_;
  Monitor& progress_;
  AtomicFiles files_;
  Input input_;
  LabelMesh mesh_;
  HtmlPictures pictures_;
  Space written_ = Space::lps;
  std::vector<LabelFidelity> fidelity_;
  std::string lost_detail_;
};

}  // namespace

RunReport run_mesh(const MeshRunOptions& options, Monitor& progress, const ModelStage& model, const LabelsStage& labels,
                   const MadeStage& made) {
  return MeshRun(options, progress, model).run(labels, made);
}

}  // namespace stackmesh
