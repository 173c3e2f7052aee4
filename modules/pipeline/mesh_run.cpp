#include "pipeline/mesh_run.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <exception>
#include <map>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "pipeline/complete_report.h"
#include "pipeline/far_sections.h"
#include "pipeline/mesh_product.h"
#include "pipeline/output_files.h"
#include "pipeline/provenance.h"
#include "pipeline/report_names.h"
#include "pipeline/stage_clock.h"
#include "pipeline/virtual_sections.h"
#include "pipeline/voids.h"
#include "pipeline/volume_sections.h"
#include "report/html_report.h"
#include "stitch/drawn_detail.h"
#include "volume/grow_layers.h"
#include "volume/raise_order.h"
#include "volume/refine_tets.h"

namespace stackmesh {
namespace {

class MeshRun {
 public:
  MeshRun(const MeshRunOptions& options, Progress& progress, const ModelStage& model)
      : o_(options), model_(model), clock_(progress, report_.stages), progress_(progress) {}

  RunReport run(const LabelsStage& labels) {
    check_mesh_outputs(o_);
    report_.command = o_.command;
    report_.version = o_.version;
    report_.options = o_.option_texts;
    report_.warnings = o_.notes;
    clock_.run("read", [&] { read(); });
    if (labels) labels(filled_labels());
    clock_.run("contours", [&] { make_sections(); });
    clock_.run("stitch", [&] { stitch(); });
    if (o_.enhance && !is_too_large()) {
      refuse_too_fine();
      enhance();
    } else {
      clock_.run("validate", [&] { take_stitched(judge(surface_, o_.threads)); });
    }
    if (o_.target == Target::volume && is_sound() && !filled_) clock_.run("volume", [&] { fill(); });
    if (filled_) clock_.run("volume", [&] { take_filled(); });
    clock_.run("validate", [&] { judge_rest(); });
    const std::string refusal = verdict();
    if (refusal.empty() && model_ && mesh_) clock_.run("write", [&] { make_model(); });
    clock_.run("write", [&] {
      if (refusal.empty()) write();
      if (wants_html()) draw(refusal.empty());
    });
    report_.peak_rss_mb = peak_memory_mb();
    write_reports();
    files_.commit();
    if (!refusal.empty()) throw Error(ErrorKind::no_result, refusal, report_.input.path, mend_);
    return std::move(report_);
  }

 private:
  void warn(const std::string& text) { report_.warnings.push_back(text); }

  void read() {
    InputOptions input = o_.input;
    input.caps = o_.stitch.caps;
    input.label_caps = o_.label_caps_text;
    input_ = read_input(input);
    if (input_.volume) keep_pieces(*input_.volume, o_.pieces, input_.warnings);
    for (const std::string& w : input_.warnings) warn(w);
    report_.input.path = input_.path;
    report_.input.files = o_.input.paths;
    report_.input.kind = input_.kind;
    const bool anatomical = input_.anatomical;
    if (o_.space == "ras" && !anatomical)
      fail_usage("--space ras needs an input with anatomical axes", input_.path, "leave --space out: coordinates are kept as they are");
    world_ = anatomical ? (o_.space == "ras" ? WorldSpace::ras : WorldSpace::lps) : WorldSpace::none;
    report_.input.space = anatomical ? o_.space : "none";
    add_label_rows(report_, input_.labels);
    for (LabelReport& row : report_.labels) row.is_void = input_.voids.count(row.label) > 0;
    layers_ = resolve_layers(o_.layers, input_.labels, input_.voids);
    if (!input_.volume) return;
    const LabelVolume& v = *input_.volume;
    report_.input.dimensions = v.size;
    report_.input.spacing_mm = report_.input.effective_spacing_mm = v.spacing_mm;
    const std::vector<std::size_t> counts = count_voxels(v);
    for (std::size_t k = 1; k < v.labels.size(); ++k)
      report_.labels[k - 1].input_volume_mm3 = static_cast<double>(counts[k]) * v.voxel_volume_mm3();
    if (o_.sections.band_px > 0 && !o_.sections.as_stored) {
      report_.input.effective_spacing_mm = reduce_to_true_grid(input_, o_.threads);
      if (report_.input.effective_spacing_mm != report_.input.spacing_mm) warn(input_.warnings.back());
    }
    double volume_mm3 = 0;
    for (const LabelReport& row : report_.labels)
      if (!row.is_void) volume_mm3 += row.input_volume_mm3.value_or(0);
    if (o_.target == Target::volume && o_.fill.max_volume_mm3) refuse_too_many(1.5 * volume_mm3 / *o_.fill.max_volume_mm3);
    double bounded = 0;
    for (const auto& [label, mm3] : label_sizes(o_.label_volumes_text, "--max-volume"))
      for (const LabelReport& row : report_.labels)
        if (row.label == label) bounded += 1.5 * row.input_volume_mm3.value_or(0) / mm3;
    if (o_.target == Target::volume) refuse_too_many(bounded);
  }

  std::vector<LabelInfo> filled_labels() const {
    std::vector<LabelInfo> filled;
    for (const LabelInfo& l : input_.labels)
      if (input_.voids.count(l.number) == 0) filled.push_back(l);
    return filled;
  }

  bool wants_html() const { return asks_for_html(o_.reports); }

  /// --strict must know of a lost component, too.
  bool wants_fidelity() const { return !o_.reports.empty() || o_.strict; }

  void make_sections() {
    check_stack_axis(input_, o_.sections.contours.axis);
    if (input_.sections) {
      if (o_.sections.band_asked)
        fail_usage("--band has no meaning for drawn contours, which are kept exactly", input_.path, "leave it out");
      stack_ = std::move(*input_.sections);
      for (const Section& s : stack_.sections) report_.contours.vertices_traced += s.points.size();
      add_virtual_sections(stack_, o_.sections.virtual_sections, o_.threads, report_.warnings);
      for (const Section& s : stack_.sections) report_.contours.vertices += s.points.size();
    } else {
      SectionOptions options = o_.sections;
      options.faired_surface = o_.enhance;
      far_sections_ = long_voxels(*input_.volume);
      if (!far_sections_.empty() && !options.virtual_sections) options.virtual_sections = 0;
      VolumeSections made = volume_sections(*input_.volume, options, progress_);
      ContourResult& c = made.contours;
      for (const std::string& w : made.warnings) warn(w);
      faired_ = std::move(made.faired);
      stack_ = std::move(c.stack);
      axis_ = c.axis;
      report_.contours.loops = c.loops;
      report_.contours.vertices_traced = c.vertices_traced;
      report_.contours.vertices = c.vertices;
      if (!wants_fidelity()) input_.volume->voxels = {};  // no one asks for them any more
    }
    report_.input.axis = std::string(1, "xyz"[axis_]);
    for (const Section& s : stack_.sections) report_.input.sections += s.interpolated ? 0 : 1;
  }

  void stitch() {
    StitchOptions options = o_.stitch;
    options.threads = o_.threads;
    std::vector<LabelInfo> known = {{0, ""}};
    known.insert(known.end(), input_.labels.begin(), input_.labels.end());
    for (const auto& [text, caps] : o_.label_caps_text)
      for (std::size_t k : resolve_labels(known, text, "--caps")) options.label_caps[known[k].number] = caps;
    StitchResult result = stitch_sections(stack_, options, progress_);
    for (const std::string& w : result.warnings) warn(w);
    surface_ = std::move(result.complex);
    if (!input_.volume) keep_pieces(surface_, o_.pieces, report_.warnings);
    frame_ = stack_.frame;
    report_.stitched.added_points = result.added_points;
    report_.stitched.vertices = surface_.points.size();
    report_.stitched.triangles = surface_.triangles.size();
    for (LabelReport& row : report_.labels) {
      const auto it = result.caps.find(row.label);
      if (it == result.caps.end()) continue;
      row.cap_low = it->second.low;
      row.cap_high = it->second.high;
    }
    pixel_mm_ = stack_.pixel_mm;
    const std::size_t n = stack_.sections.size();
    gap_mm_ = n > 1 ? (stack_.sections[n - 1].z_mm - stack_.sections[0].z_mm) / static_cast<double>(n - 1) : pixel_mm_;
    if (!input_.volume) {
      drawn_gap_mm_ = drawn_gap_mm(stack_);
      drawn_bulge_mm_ = drawn_bulge_mm(stack_);
      far_sections_ = far_sections(stack_, surface_);
    }
    if (o_.reports.empty() || input_.volume) stack_ = Stack();  // a report judges by the contours, and draws them
  }

  bool is_too_large() {
    if (!far_sections_.empty() && o_.enhance_up_to) {
      lost_detail_ = "the surface is stitched, not enhanced";
      warn(far_sections_ + ": the surface is kept as stitched; look at spacing and heights");
      return true;
    }
    if (!o_.enhance_up_to || surface_.triangles.size() <= *o_.enhance_up_to) return false;
    lost_detail_ = "the surface is stitched, not enhanced";
    warn("the stitched surface has " + std::to_string(surface_.triangles.size()) +
         " triangles, more than are enhanced unasked (it would take minutes): it is kept as stitched; ask for enhancement with --edge-length "
         "or --deviation, or reduce it with --interpolate or --simplify");
    return true;
  }

  /// An edge length that is far too small is told before the surface is remeshed, which would take as long as it is small.
  void refuse_too_fine() const {
    if (o_.target != Target::volume || !o_.enhancement.edge_length_mm) return;
    const double edge = *o_.enhancement.edge_length_mm, inner = 2 * edge;
    double area = 0, volume = 0;  // of both sides; stitched steps have up to half as much again as the surface that comes of them
    for (const InterfaceTriangle& t : surface_.triangles) {
      const Vec3 &a = surface_.points[t.v[0]], &b = surface_.points[t.v[1]], &c = surface_.points[t.v[2]];
      area += ((t.below != 0) + (t.above != 0)) * 0.5 * norm(cross(b - a, c - a)) / 1.5;
      volume += ((t.below != 0) - (t.above != 0)) * dot(a, cross(b, c)) / 6;
    }
    refuse_too_many(1.5 * area / (0.433 * edge * edge) + std::abs(volume) / (0.12 * inner * inner * inner));
  }

  /// What the exact checks say of a surface.
  struct Judgement {
    InterfaceComplex world;  // in the coordinates that will be written
    SurfaceCheck check;
    bool is_sound() const { return check.open_edges == 0 && check.self_intersections == 0; }
  };

  /// A surface is checked beside the stage that goes on with it, which is believed only after the check.
  void begin_judging(const InterfaceComplex& surface) {
    clock_.begin_beside("validate", [&] { beside_ = judge(surface, 1); }, thread_count(o_.threads) > 1);
  }
  Judgement finish_judging() {
    clock_.run("validate", [&] { clock_.finish_beside(); });
    return std::move(beside_);
  }

  /// The stitched surface is kept until the enhanced one has passed the same exact checks.
  void enhance() {
    EnhanceOptions options = o_.enhancement;
    options.pixel_mm = pixel_mm_;
    options.gap_mm = gap_mm_;
    if (!faired_.triangles.empty()) {
      options.faired = &faired_;
      // An organ that ends inside of the image ends as its faired surface does, unless flat ends were asked for.
      options.inner_caps = o_.stitch.caps == Caps::flat || !o_.label_caps_text.empty();
    }
    options.drawn_gap_mm = drawn_gap_mm_;
    options.drawn_bulge_mm = drawn_bulge_mm_;
    options.threads = o_.threads;
    options.label_edge_mm = label_sizes(o_.label_edges_text, "--edge-length");
    for (const LabelReport& row : report_.labels)
      if (row.input_volume_mm3) options.label_volume_mm3[row.label] = *row.input_volume_mm3;
    EnhanceResult result;
    std::exception_ptr error;
    begin_judging(surface_);
    clock_.run("enhance", [&] {
      try {
        result = enhance_complex(surface_, options, progress_);
        faired_ = {};
      } catch (...) {
        error = std::current_exception();
      }
    });
    take_stitched(finish_judging());
    if (!is_sound()) return;  // no one may enhance it
    if (error) std::rethrow_exception(error);
    for (const std::string& w : result.warnings) warn(w);
    InterfaceComplex stitched = std::exchange(surface_, std::move(result.complex));
    const SurfaceCheck before = *report_.surface;
    report_.surface_level = result.level;

    std::atomic<bool> unsound{false};
    clock_.begin_beside(
        "validate",
        [&] {
          beside_ = judge(surface_, o_.target == Target::volume ? 1 : o_.threads);
          unsound = !accepts(beside_, before);
        },
        o_.target == Target::volume && thread_count(o_.threads) > 1);
    if (o_.target == Target::volume) {
      clock_.run("volume", [&] {
        try {
          fill(&unsound);
        } catch (...) {
          error = std::current_exception();
        }
      });
    }
    Judgement enhanced = finish_judging();
    if (!accepts(enhanced, before)) {
      warn("the enhanced surface did not pass the exact checks (" + std::to_string(enhanced.check.open_edges) + " open edges, " +
           std::to_string(enhanced.check.self_intersections) + " self-intersections): the stitched surface is used");
      surface_ = std::move(stitched);
      report_.surface_level = "stitched";
      filled_.reset();
      plan_.reset();
    } else {
      if (error) std::rethrow_exception(error);
      take(std::move(enhanced));
    }
    if (report_.surface_level != "enhanced" && lost_detail_.empty()) lost_detail_ = "the surface is " + report_.surface_level + ", not enhanced";
    for (const LabelSurface& b : before.labels)
      for (const LabelSurface& a : report_.surface->labels)
        if (a.label == b.label && (a.euler != b.euler || a.components != b.components))
          warn("label " + std::to_string(a.label) + ": enhancement changed its Euler number from " + std::to_string(b.euler) + " to " +
               std::to_string(a.euler) + " and its pieces from " + std::to_string(b.components) + " to " + std::to_string(a.components));
  }

  /// Of "5=2.0,9=1.0": labels by number or name.
  std::map<Label, double> label_sizes(const std::vector<std::pair<std::string, double>>& texts, const std::string& option) const {
    std::vector<LabelInfo> known = {{0, ""}};
    known.insert(known.end(), input_.labels.begin(), input_.labels.end());
    std::map<Label, double> sizes;
    for (const auto& [text, size] : texts)
      for (std::size_t k : resolve_labels(known, text, option)) sizes[known[k].number] = size;
    return sizes;
  }

  static bool accepts(const Judgement& enhanced, const SurfaceCheck& before) {
    return enhanced.is_sound() && enhanced.check.labels.size() == before.labels.size();
  }

  bool is_sound() const { return report_.surface->open_edges == 0 && report_.surface->self_intersections == 0; }

  /// The volume mesher works in stack coordinates; only what it gives is mapped to the world.
  void fill(const std::atomic<bool>* given_up = nullptr) {
    FillOptions options = o_.fill;
    options.known_sound = true;
    options.threads = o_.threads;
    options.given_up = given_up;
    options.label_max_volume_mm3 = label_sizes(o_.label_volumes_text, "--max-volume");
    if (report_.surface_level == "enhanced") {  // good triangles: inner tetrahedra may be asked for quality
      if (!options.radius_edge) options.radius_edge = 1.4;
      if (!options.max_volume_mm3) options.inner_growth = 2;
      options.improve_deg = std::max(24.0, options.dihedral_deg.value_or(0));
    } else if (options.dihedral_deg) {
      options.improve_deg = options.dihedral_deg;
    }
    const bool whole = input_.voids.empty();
    options.outside_is_empty = whole;
    if (!whole) hollowed_ = hollowed(surface_, input_.voids);
    const InterfaceComplex& body = whole ? surface_ : hollowed_.complex;
    if (!layers_.empty()) {
      check_outer_faces(body, layers_);
      plan_ = plan_layers(body, layers_, o_.threads);
      options.outside_is_empty = false;  // the layers lie there
    }
    const InterfaceComplex& filled = plan_ ? plan_->core : body;
    refuse_too_many(estimate_tets(filled, options));
    filled_ = fill_volume(filled, options);
    if (whole) return;
    for (std::int32_t& t : filled_->offending_triangles) t = hollowed_.original[t];
  }

  void take_filled() {
    FillResult result = std::move(*filled_);
    for (const std::string& w : result.warnings) warn(w);
    if (!result.fallback.empty()) warn("the volume mesher fell back: " + result.fallback + "; then " + result.message);
    if (result.status == FillResult::Status::verified) {
      report_.closure = "verified";
      mesh_ = std::move(result.mesh);
      follow_moved(result.moved_points);
      if (plan_) take_layers();
      if (o_.order == 2) raise();
      if (o_.refine > 0) refine();
    } else {
      report_.closure = "failed";
      refusal_ = "the volume mesher did not fill the surface (" + result.message + ")";
      if (result.status == FillResult::Status::timed_out) mend_ = "give it longer with --timeout, or mesh fewer labels at once";
      if (result.status == FillResult::Status::crashed) mend_ = "free some memory, or mesh fewer labels at once";
      offending_ = std::move(result.offending_triangles);
    }
  }

  void take_layers() {
    add_layers(*mesh_, *plan_);
    for (LayerFigures& f : plan_->figures) {
      for (LayerPlace& p : f.places) p.at_mm = frame_.to_world(p.at_mm);
      if (const std::string text = layer_warning(f); !text.empty()) warn(text);
      report_.layers.push_back(std::move(f));
    }
    plan_.reset();
  }

  /// The surface has its points where the tets have them, and is checked again.
  void follow_moved(const std::vector<std::int32_t>& moved) {
    if (moved.empty()) return;
    std::map<std::array<double, 3>, Vec3> to;  // points of the surface at one place are one for the tets
    for (const std::int32_t v : moved) to[{surface_.points[v].x, surface_.points[v].y, surface_.points[v].z}] = mesh_->points[v];
    for (Vec3& p : surface_.points)
      if (const auto at = to.find({p.x, p.y, p.z}); at != to.end()) p = at->second;
    take(judge(surface_, o_.threads));
    if (!is_sound()) fail_internal("the surface was sound until its worst tetrahedra were improved", "volume");
  }

  void refuse_too_many(double tets) const {
    if (o_.many_tets || tets <= 1e7) return;
    char text[32];
    std::snprintf(text, sizeof text, "%.0f", tets / 1e6);
    fail_usage("about " + std::string(text) + " million tetrahedra would be made", report_.input.path,
               "ask for larger ones with --edge-length or --max-volume, or say --yes if you want that many");
  }

  /// In stack coordinates, where flat caps are planes across an axis.
  void raise() {
    OrderOptions options;
    options.threads = o_.threads;
    options.volumes_restored = report_.surface_level == "enhanced";
    mesh_ = raise_order(std::move(*mesh_), options).mesh;
  }

  /// The finer surface takes the place of the coarse one once it has passed the same checks.
  void refine() {
    refuse_too_many(static_cast<double>(mesh_->tets.size()) * std::pow(8, o_.refine));
    mesh_ = refine_tets(std::move(*mesh_), o_.refine);
    const std::vector<LabelSurface> before = std::move(report_.surface->labels);
    take(judge(surface_of(*mesh_), o_.threads));
    for (const LabelSurface& l : before)  // voids are not refined
      if (input_.voids.count(l.label) > 0) report_.surface->labels.push_back(l);
    if (!is_sound()) mend_ = "leave --refine out, or use --order 1: curved sides cut into flat ones touch here";
  }

  /// Stack coordinates to LPS; a mirrored frame turns triangles and tets inside out, so they are turned back.
  void to_world(std::vector<Vec3>& points, std::vector<InterfaceTriangle>& triangles) const {
    for (Vec3& p : points) p = frame_.to_world(p);
    if (frame_.mirrors())
      for (InterfaceTriangle& t : triangles) std::swap(t.v[1], t.v[2]);
  }

  /// Closure and intersections, on the coordinates that will be written.
  Judgement judge(const InterfaceComplex& surface, int threads) const {
    Judgement j;
    j.world = surface;
    to_world(j.world.points, j.world.triangles);
    SurfaceCheckOptions check;
    check.threads = threads;
    j.check = check_surface(j.world, check);
    return j;
  }

  void take_stitched(Judgement j) {
    report_.stitched.open_edges = j.check.open_edges;
    report_.stitched.self_intersections = j.check.self_intersections;
    take(std::move(j));
  }

  void take(Judgement j) {
    world_surface_ = std::move(j.world);
    report_.surface = std::move(j.check);
  }

  void judge_rest() {
    surface_ = std::move(world_surface_);
    if (mesh_) {
      to_world(mesh_->points, mesh_->faces);
      if (frame_.mirrors())
        turn_all_round(*mesh_);
      report_.volume = check_volume(*mesh_, {o_.threads});
      const VolumeCheck& v = *report_.volume;
      if (report_.surface_level == "enhanced" && (v.dihedral_min_deg < 1 || v.dihedral_max_deg > 179)) {
        char text[120];
        std::snprintf(text, sizeof text, "the flattest tetrahedra have dihedral angles of %.2f to %.2f degrees", v.dihedral_min_deg, v.dihedral_max_deg);
        warn(std::string(text) + ": a solver may fail on them; the report's defects say where (--report R.html), another --edge-length may avoid them");
      }
    }
    if (wants_fidelity() && input_.volume) judge_fidelity();
    fill_label_rows(report_, fidelity_.empty() ? nullptr : &fidelity_);
    for (const LabelReport& row : report_.labels)
      if (!row.closed) warn("label " + std::to_string(row.label) + " has no closed surface");
    if (!o_.reports.empty()) give_verdicts();
  }

  void give_verdicts() {
    Judged j;
    j.surface = &surface_;
    if (mesh_) j.mesh = &*mesh_;
    if (input_.volume) j.volume = &*input_.volume;
    else if (!stack_.sections.empty()) j.sections = &stack_;
    j.axis = axis_;
    if (!fidelity_.empty()) j.fidelity = &fidelity_;
    j.threads = o_.threads;
    complete_report(report_, j);
    report_.provenance = find_provenance(o_.input.paths);
  }

  void judge_fidelity() {
    FidelityOptions options;
    options.threads = o_.threads;
    options.stack_axis = axis_;
    fidelity_ = check_fidelity(surface_, *input_.volume, options);
    for (const LabelFidelity& f : fidelity_)
      if (f.missing_components > 0)
        lost("label " + std::to_string(f.label) + ": " + std::to_string(f.missing_components) + " of " + std::to_string(f.input_components) +
             " components are missing");
      else if (!f.components_match)
        lost("label " + std::to_string(f.label) + ": the surface's pieces do not match the input's components one to one");
  }

  void lost(const std::string& text) {
    warn(text);
    lost_detail_ = lost_detail_.empty() ? text : lost_detail_;
  }

  /// Why there is no valid result; empty if there is one.
  std::string verdict() {
    const SurfaceCheck& s = *report_.surface;
    if (s.open_edges > 0 || s.self_intersections > 0) {
      refusal_ = "the stitched surface has " + std::to_string(s.open_edges) + " open edges and " +
                 std::to_string(s.self_intersections) + " self-intersections";
      for (const auto& pair : s.intersecting_pairs) offending_.insert(offending_.end(), pair.begin(), pair.end());
    } else if (report_.volume && (report_.volume->inverted > 0 || !report_.volume->conforms)) {
      refusal_ = "the volume mesh has " + std::to_string(report_.volume->inverted) + " inverted " + (mesh_->wedges.empty() ? "tetrahedra" : "elements") + " and " +
                 std::to_string(report_.volume->nonconforming_faces + report_.volume->nonconforming_edges) + " faces or edges that do not conform";
    }
    if (!refusal_.empty()) {
      report_.closure = o_.target == Target::volume ? "failed" : "skipped";
      if (mend_.empty()) mend_ = "try --simplify 0, and report the input";
      write_offending();
    } else if (o_.strict && !lost_detail_.empty()) {
      refusal_ = lost_detail_;
      mend_ = "leave --strict out to accept it";
    }
    return refusal_;
  }

  void write_offending() {
    if (offending_.empty() || (o_.outputs.empty() && o_.reports.empty())) return;
    std::sort(offending_.begin(), offending_.end());
    offending_.erase(std::unique(offending_.begin(), offending_.end()), offending_.end());
    InterfaceComplex part;
    part.points = surface_.points;
    for (std::int32_t t : offending_) part.triangles.push_back(surface_.triangles[t]);
    const std::string base = o_.outputs.empty() ? o_.reports[0] : o_.outputs[0];
    const std::string path = base.substr(0, base.rfind('.')) + ".offending.vtp";
    write_surface(files_, path, part, write_options());
    warn("the offending triangles are in " + path);
  }

  MeshWriteOptions write_options() const {
    MeshWriteOptions w = o_.write;
    w.space = world_;
    w.labels = input_.labels;
    return w;
  }

  /// With voids: what bounds the filled labels; the voids' own surfaces are whole beside them.
  InterfaceComplex written_surface() {
    if (mesh_ && o_.refine > 0) name_voids(surface_.triangles, hollowed_.behind);
    if (o_.write.per_label) return std::move(surface_);
    Hollowed of_filled = hollowed(surface_, input_.voids);
    name_voids(of_filled.complex.triangles, of_filled.behind);
    return std::move(of_filled.complex);
  }

  void write() {
    if (world_ == WorldSpace::ras) {
      to_ras(surface_.points);
      if (mesh_) to_ras(mesh_->points);
    }
    if (mesh_) name_voids(mesh_->faces, hollowed_.behind);
    if (!input_.voids.empty()) surface_ = written_surface();
    for (const std::string& path : o_.outputs) {
      if (is_surface_format(path)) {
        write_surface(files_, path, surface_, write_options());
        if (ends_with(path, ".stl")) check_rounded(path);
      } else if (!model_) {
        if (ends_with(path, ".mesh") && !mesh_->wedges.empty()) warn(path + ": the format has no pyramids; wedges and pyramids are divided into tetrahedra");
        write_volume(files_, path, *mesh_, write_options());
      }
    }
    write_names();
  }

  /// The mesh in the frame that will be written, for the solver model.
  void make_model() {
    TetMesh mesh;
    if (wants_html()) {
      mesh = *mesh_;  // the page shows it
    } else {
      mesh = std::move(*mesh_);
      mesh_.reset();
    }
    name_voids(mesh.faces, hollowed_.behind);
    model_(mesh_product(std::move(mesh), input_.labels, world_, frame_.axes[2], input_.volume ? &*input_.volume : nullptr), report_, files_);
  }

  /// STL keeps 24 bits of a coordinate: what is written is checked again.
  void check_rounded(const std::string& path) {
    InterfaceComplex rounded = surface_;
    for (Vec3& p : rounded.points) p = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    SurfaceCheckOptions check;
    check.threads = o_.threads;
    const SurfaceCheck s = check_surface(rounded, check);
    if (s.self_intersections > 0)
      warn(path + ": rounding to STL's 32-bit coordinates makes " + std::to_string(s.self_intersections) +
           " pairs of triangles touch or cross; the other formats keep the checked surface");
  }

  void draw(bool written) {
    HtmlScene scene;
    scene.surface = &surface_;
    if (mesh_) scene.mesh = &*mesh_;
    if (input_.volume) scene.volume = &*input_.volume;
    else scene.sections = &stack_;
    scene.stack_axis = axis_;
    InterfaceComplex of_model;  // corners of second-order tetrahedra lie beside the surface's
    if (report_.fem && mesh_) {
      of_model = {mesh_->points, mesh_->faces};
      scene.surface = &of_model;
      scene.values = &report_.fem->faces;
    }
    scene.space = world_ == WorldSpace::none ? "none" : world_ == WorldSpace::ras && written ? "ras" : "lps";
    HtmlOptions options;
    options.threads = o_.threads;
    pictures_ = draw_pictures(scene, options);
  }

  void write_reports() {
    for (const std::string& path : o_.reports) {
      const std::string text = is_html_report(path) ? to_html({{"mesh", &report_, &pictures_}}) : to_json(report_);
      files_.write(path, [&](std::FILE* f) { std::fwrite(text.data(), 1, text.size(), f); });
    }
  }

  void write_names() {
    const std::string text = names_to_json(report_);
    for (const std::string& path : o_.names_outputs)
      files_.write(path, [&](std::FILE* f) { std::fwrite(text.data(), 1, text.size(), f); });
  }

  const MeshRunOptions& o_;
  const ModelStage& model_;
  RunReport report_;
  StageClock clock_;
  Progress& progress_;
  AtomicFiles files_;
  Input input_;
  Stack stack_;
  Frame frame_;
  int axis_ = 2;
  double pixel_mm_ = 1, gap_mm_ = 1, drawn_gap_mm_ = 0, drawn_bulge_mm_ = 0;  // drawn: of contour input, between drawn sections
  InterfaceComplex faired_;                   // stack coordinates; what enhancement draws the surface to
  InterfaceComplex surface_, world_surface_;  // stack coordinates until judge_rest()
  Judgement beside_;
  Hollowed hollowed_;  // what was filled
  std::map<Label, LayerSize> layers_;
  std::optional<LayerPlan> plan_;  // of filled_
  std::optional<FillResult> filled_;
  std::optional<TetMesh> mesh_;
  HtmlPictures pictures_;
  WorldSpace world_ = WorldSpace::lps;
  std::vector<LabelFidelity> fidelity_;
  std::vector<std::int32_t> offending_;
  std::string refusal_, mend_, lost_detail_, far_sections_;
};

}  // namespace

RunReport run_mesh(const MeshRunOptions& options, Progress& progress, const ModelStage& model, const LabelsStage& labels) {
  return MeshRun(options, progress, model).run(labels);
}

}  // namespace stackmesh
