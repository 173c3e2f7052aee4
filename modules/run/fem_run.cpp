#include "run/fem_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

#include "base/cancel.h"
#include "base/error.h"
#include "base/stage_clock.h"
#include "base/warning.h"
#include "fem/assign_materials.h"
#include "fem/check_supports.h"
#include "fem/element_quality.h"
#include "fem/estimate_error.h"
#include "fem/join_parts.h"
#include "fem/load_case.h"
#include "fem/recover_stress.h"
#include "fem/selection.h"
#include "fem/solver_names.h"
#include "fem/split_parts.h"
#include "image/read_image.h"
#include "image/read_label_table.h"
#include "mesh/voids.h"
#include "meshio/read_frd.h"
#include "meshio/read_mesh.h"
#include "model/label_table.h"
#include "model/space.h"
#include "report/html_report.h"
#include "run/complete_report.h"
#include "run/mesh_product.h"
#include "run/output_files.h"
#include "run/provenance.h"
#include "run/report_names.h"
#include "run/solve_with_calculix.h"
#include "validate/check_volume.h"
#include "volume/raise_order.h"
#include "volume/refine_tets.h"

namespace stackmesh {
namespace {

constexpr std::size_t kMostMeshes = 3;  // of --accuracy

class FemRun {
 public:
  FemRun(const FemRunOptions& options, Monitor& progress) : o_(options), progress_(progress) {}

  RunReport run() {
    const CancelScope scope(&progress_);
    std::vector<std::string> all = o_.mesh.outputs;
    all.insert(all.end(), o_.mesh.reports.begin(), o_.mesh.reports.end());
    std::vector<std::string> read = o_.mesh.input.paths;
    read.insert(read.end(), {o_.image, o_.materials});
    check_output_files(all, read);
    // What the user wrote is read before anything long begins.
    if (!o_.materials.empty()) {
      plan_ = read_law(o_.materials);
      if (o_.erode_px) plan_->mapping.erode_px = *o_.erode_px;
      plan_->mapping.threads = o_.mesh.mesh.threads;
    }
    if (o_.accuracy_rel) check_accuracy();
    if (o_.accuracy_rel && !o_.mesh.layers.empty())
      fail_usage("--accuracy cuts tetrahedra, not wedges", "--layer",
                 "leave one of them out; compare runs with more wedges and a smaller --edge-length instead");
    if (!o_.image.empty()) image_ = read_image(o_.image, {"", o_.mesh.input.allow_outside});
    const std::vector<std::string>& inputs = o_.mesh.input.paths;
    if (inputs.size() != 1 || !is_readable_mesh(inputs[0])) return from_labels();
    if (!o_.mesh.layers.empty())
      fail_usage("--layer needs the labels, not a mesh of them", inputs[0], "give the labels that it was made from");
    if (!o_.mesh.input.voids.empty())
      fail_usage("--void needs the labels, not a mesh of them", inputs[0], "give the labels that it was made from");
    return from_mesh(inputs[0]);
  }

 private:
  /// What --accuracy needs, told before anything is meshed.
  void check_accuracy() const {
    if (!has_calculix())
      fail_usage("--accuracy solves the load case with CalculiX, and there is no ccx in PATH", "--accuracy",
                 "install calculix-ccx, or leave --accuracy out");
    const auto has_static_step = [](const LoadCase& c) {
      if (c.steps.empty()) return !c.always.empty();
      return std::any_of(c.steps.begin(), c.steps.end(),
                         [](const LoadCase::Step& s) { return s.analysis == Analysis::statics; });
    };
    if (!plan_ || !has_static_step(plan_->load_case))
      fail_usage("--accuracy needs a load case with a static step to solve", "--accuracy",
                 "give one with --materials LAW.json (docs/fem.md)");
  }

  RunReport from_labels() {
    return run_mesh(
        o_.mesh, progress_,
        [&](MeshProduct product, RunReport& report, AtomicFiles& files) { model(std::move(product), report, files); },
        [&](const std::vector<LabelInfo>& labels) { check_labels(labels); });
  }

  /// What names labels is checked as soon as they are known: a mistake is told before anything is meshed.
  void check_labels(const std::vector<LabelInfo>& labels) const {
    if (plan_) check_plan(*plan_, solver_names(labels), image_.has_value());
    const LabelTable known(labels);
    for (const auto& [name, text] : o_.parts) known.resolve(text, "--parts");
    for (const auto& [text, thickness] : o_.skins) known.resolve(text, "--skin");
    for (const std::string& text : o_.selections) check_selection(text, solver_names(labels));
  }

  RunReport from_mesh(const std::string& path) {
    RunReport report;
    StageClock clock(progress_, report.stages);
    AtomicFiles files;
    report.command = o_.mesh.command;
    report.version = o_.mesh.version;
    report.options = o_.mesh.option_texts;
    report.warnings = o_.mesh.notes;
    check_outputs();
    MeshProduct product;
    clock.run("read", [&] { product = read(path, report); });
    check_labels(product.labels);
    clock.run("validate", [&] { check(product, report); });
    const std::vector<Label> behind = voids_behind(product.mesh.faces);
    change_space(product.mesh, written_);  // it was read and judged in LPS
    if (o_.mesh.mesh.order == 2 && product.mesh.mid.empty()) {
      OrderOptions order;
      order.threads = o_.mesh.mesh.threads;
      clock.run("volume", [&] { product.mesh = raise_order(std::move(product.mesh), order).mesh; });
    }
    if (o_.mesh.mesh.refine > 0) {
      const double tets = static_cast<double>(product.mesh.tets.size()) * std::pow(8, o_.mesh.mesh.refine);
      if (!o_.mesh.mesh.many_tets && tets > 1e7)
        fail_usage("about " + std::to_string(std::lround(tets / 1e6)) + " million tetrahedra would be made", "--refine",
                   "refine less often, or say --yes");
      clock.run("volume", [&] { product.mesh = refine_tets(std::move(product.mesh), o_.mesh.mesh.refine); });
    }
    name_voids(product.mesh.faces, behind);
    product.labels.insert(product.labels.end(), voids_.begin(), voids_.end());
    const bool html = asks_for_html(o_.mesh.reports);
    HtmlPictures pictures;
    clock.run("write", [&] {
      model(html ? product : std::move(product), report, files);
      if (html) pictures = draw(product, report);
    });
    report.peak_rss_mb = peak_memory_mb();
    for (const std::string& r : o_.mesh.reports) {
      const std::string text = is_html_report(r) ? to_html({{"mesh", &report, &pictures}}) : to_json(report);
      files.write(r, [&](std::FILE* f) { std::fwrite(text.data(), 1, text.size(), f); });
    }
    files.commit();
    return report;
  }

  HtmlPictures draw(const MeshProduct& product, const RunReport& report) const {
    const InterfaceComplex surface = {product.mesh.points, product.mesh.faces, product.mesh.space};
    HtmlScene scene;
    scene.surface = &surface;
    scene.mesh = &product.mesh;
    scene.values = &report.fem->faces;
    HtmlOptions options;
    options.threads = o_.mesh.mesh.threads;
    return draw_pictures(scene, options);
  }

  void check_outputs() const {
    for (const std::string& path : o_.mesh.outputs)
      if (!is_volume_format(path))
        fail_usage("a mesh is made into a solver model, not into this", "'" + path + "'", "choose " + volume_endings());
    check_report_names(o_.mesh.reports);
    if (o_.mesh.space != "lps" && o_.mesh.space != "ras")
      fail_usage("unknown space '" + o_.mesh.space + "'", "--space", "choose lps or ras");
  }

  MeshProduct read(const std::string& path, RunReport& report) {
    MeshReadOptions how;
    how.label_array = o_.label_array;
    MeshFile file = read_mesh(path, how);
    if (file.tets.empty()) fail_input("the mesh has no tetrahedra", path, "give a volume mesh, or labels");
    report.input.path = path;
    report.input.kind = "mesh";
    for (const std::string& note : file.notes) report.warnings.push_back({WarningCode::mesh_converted, path, note});
    if (file.label_source == LabelSource::none)
      report.warnings.push_back(
          warning_at(WarningCode::labels_matched, path,
                     "no cell array holds labels: every element has label 1 (name an array with --label-array)"));
    if (!file.space)
      report.warnings.push_back(warning_at(WarningCode::frame, path, "does not say its frame; it is taken as LPS"));
    MeshProduct product;
    product.mesh = take_elements(file);
    product.mesh.space = file.space.value_or(Space::lps);
    written_ = product.mesh.space == Space::none ? Space::none : o_.mesh.space == "ras" ? Space::ras : Space::lps;
    report.input.space = to_text(written_);
    product.up = o_.up;
    if (product.mesh.space == Space::ras) change_space(product.mesh, Space::lps);  // and back again
    if (!product.mesh.wedges.empty() && (o_.mesh.mesh.refine > 0 || o_.accuracy_rel))
      fail_usage("the mesh has wedges, and only tetrahedra are cut into eight", path,
                 o_.mesh.mesh.refine > 0 ? "leave --refine out" : "leave --accuracy out");
    const std::set<Label> present(product.mesh.labels.begin(), product.mesh.labels.end());
    for (const Label l : present) {
      if (l <= 0)
        fail_input("a label of the mesh is not above 0", path + ", label " + std::to_string(l),
                   "number labels from 1; 0 is the background");
      product.labels.push_back({l, ""});
      for (const LabelInfo& named : file.names)
        if (named.number == l) product.labels.back() = named;
    }
    for (std::size_t t = 0; t < file.behind.size(); ++t)
      if (file.behind[t] != 0) walls_[sorted(file.triangles[t].v)] = file.behind[t];
    for (const LabelInfo& named : file.names)
      if (std::find(file.behind.begin(), file.behind.end(), named.number) != file.behind.end()) voids_.push_back(named);
    if (!o_.mesh.input.names.empty()) {
      const std::vector<LabelInfo> table = read_label_table(o_.mesh.input.names);
      apply_label_table(table, product.labels);
      apply_label_table(table, voids_);
    }
    keep_labels(product);
    return product;
  }

  static std::array<std::int32_t, 3> sorted(std::array<std::int32_t, 3> v) {
    std::sort(v.begin(), v.end());
    return v;
  }
  /// The void behind each face, as the file tells.
  std::vector<Label> voids_behind(const std::vector<InterfaceTriangle>& faces) const {
    std::vector<Label> behind(walls_.empty() ? 0 : faces.size(), 0);
    for (std::size_t i = 0; i < behind.size(); ++i)
      if (const auto at = walls_.find(sorted(faces[i].v));
          at != walls_.end() && (faces[i].below == 0 || faces[i].above == 0))
        behind[i] = at->second;
    return behind;
  }

  /// --label and --merge.
  void keep_labels(MeshProduct& product) const {
    if (o_.mesh.input.labels.empty() && !o_.mesh.input.merge) return;
    std::set<Label> keep;
    std::vector<LabelInfo> kept;
    for (const std::size_t k : LabelTable(product.labels).resolve(o_.mesh.input.labels)) {
      keep.insert(product.labels[k].number);
      if (kept.empty() || !o_.mesh.input.merge) kept.push_back(product.labels[k]);
    }
    relabel(product.mesh, [&](Label l) { return keep.count(l) == 0 ? 0 : o_.mesh.input.merge ? kept[0].number : l; });
    product.labels = std::move(kept);
  }

  void check(MeshProduct& product, RunReport& report) {
    TetMesh& mesh = product.mesh;
    const ElementQuality quality = element_quality(mesh);
    if (!quality.non_positive.empty()) {
      std::string list;
      for (std::size_t i = 0; i < std::min<std::size_t>(quality.non_positive.size(), 100); ++i)
        list += (i > 0 ? ", " : "") + std::to_string(quality.non_positive[i] + 1);
      if (quality.non_positive.size() > 100) list += ", ...";
      fail_input(std::to_string(quality.non_positive.size()) + " of " + std::to_string(mesh.elements()) +
                     " elements have a Jacobian that is not positive",
                 report.input.path + ", elements " + list,
                 "mesh it again, or turn the elements round where their nodes are in the wrong order");
    }
    if (o_.mesh.mesh.order == 1 && !mesh.mid.empty()) {
      mesh.mid.clear();
      mesh.wedge_mid.clear();
      report.warnings.push_back(
          {WarningCode::element_order, "", "the mesh is of second order: its mid-side nodes are left out (--order 1)"});
    }
    add_label_rows(report, product.labels);
    // A mesh whose parts have nodes of their own is judged as one body.
    TetMesh whole = mesh;
    if (const std::size_t twins = join_equal_nodes(whole); twins > 0) {
      const std::string text = std::to_string(twins) + " nodes lie exactly on another one";
      if (o_.parts.empty()) {
        report.warnings.push_back({WarningCode::coincident_nodes, "",
                                   text + " and stay apart from it; --parts makes contact or ties of such faces"});
      } else {
        report.warnings.push_back(
            {WarningCode::coincident_nodes, "", text + ": they were joined to it before --parts"});
        mesh = whole;
        walls_.clear();  // they name the nodes before
      }
    }
    mesh.faces = faces_of_tets(mesh);
    whole.faces = faces_of_tets(whole);
    judge(whole, report);
    if (!report.volume->conforms)
      report.warnings.push_back({WarningCode::not_conforming, "",
                                 "the mesh does not conform: faces or edges of its tetrahedra do not match"});
  }

  /// Its surface only for a report.
  void judge(const TetMesh& mesh, RunReport& report) const {
    if (o_.mesh.reports.empty()) {
      report.volume = check_volume(mesh, {o_.mesh.mesh.threads});
      return;
    }
    const InterfaceComplex surface = {mesh.points, mesh.faces, mesh.space};
    check_mesh(report, surface, &mesh, o_.mesh.mesh.threads);
    Judged judged;
    judged.surface = &surface;
    judged.mesh = &mesh;
    judged.threads = o_.mesh.mesh.threads;
    complete_report(report, judged);
    report.provenance = find_provenance({report.input.path});
  }

  /// A model, and what there is to say of it.
  struct Built {
    SolverModel model;
    MaterialReport materials;
    std::vector<Warning> warnings;
  };

  void model(MeshProduct product, RunReport& report, AtomicFiles& files) {
    Built built = build(product);
    std::optional<FemAccuracy> accuracy;
    if (o_.accuracy_rel) accuracy = refine_until_accurate(product, built);
    product.mesh = TetMesh();
    const SolverModel& model = built.model;
    for (const Warning& w : built.warnings) report.warnings.push_back(w);
    report.fem = summary(model, built.materials);
    if (asks_for_html(o_.mesh.reports))
      report.fem->faces = surface_values(model, o_.result.empty() ? std::vector<double>() : mises_of(model));
    report.fem->accuracy = std::move(accuracy);
    if (report.fem->accuracy && !report.fem->accuracy->reached)
      report.warnings.push_back({WarningCode::accuracy, "", not_reached(*report.fem->accuracy)});

    MeshWriteOptions write = o_.mesh.write;
    for (const std::string& path : o_.mesh.outputs) {
      if (!is_volume_format(path)) continue;
      for (const std::string& loss : losses_of(path, model))
        report.warnings.push_back({WarningCode::format_loss, path, loss});
      write_model(files, path, model, write);
    }
  }

  /// Von Mises stress at the model's nodes, out of a result of CalculiX for this very model.
  std::vector<double> mises_of(const SolverModel& model) const {
    const FrdResult result = read_frd(o_.result);
    const auto stress = result.fields.find("STRESS");
    if (stress == result.fields.end())
      fail_input("the result has no stress", o_.result,
                 "ask for it in the deck: *EL FILE and S, as decks with a load case do");
    std::vector<double> mises(model.mesh.points.size(), 0);
    for (std::size_t i = 0; i < result.numbers.size(); ++i) {
      const std::int64_t node = result.numbers[i] - 1;
      if (node < 0 || node >= static_cast<std::int64_t>(mises.size())) continue;  // of rigid points and springs
      const Vec3 p = model.mesh.points[node];
      if (norm(result.points[i] - p) > 1e-3 + 1e-4 * norm(p))
        fail_input("the result is of another mesh: its node " + std::to_string(node + 1) + " lies elsewhere", o_.result,
                   "give the result of this input with these very options");
      const auto& s = stress->second[i];
      const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
      mises[node] = std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
    }
    return mises;
  }

  std::string not_reached(const FemAccuracy& a) const {
    char text[240];
    std::snprintf(text, sizeof text,
                  "the accuracy of %.3g %% was not reached: %.3g %% in set %s on the last of %zu meshes; ",
                  100 * a.asked_rel, 100 * a.estimate.error_rel, a.estimate.worst_set.c_str(), a.elements.size());
    return text + std::string(a.elements.size() < kMostMeshes
                                  ? "a finer one would have more than " + std::to_string(most_elements()) +
                                        " elements (--yes solves it)"
                                  : "begin with smaller edges");
  }
  std::size_t most_elements() const { return o_.mesh.mesh.order == 2 ? 150000 : 1000000; }

  /// Solves the load case on the mesh, on its tetrahedra cut into eight, and once more, until what changes is small
  /// enough. The last model is the one that is written.
  FemAccuracy refine_until_accurate(MeshProduct& product, Built& built) {
    FemAccuracy out;
    out.asked_rel = *o_.accuracy_rel;
    std::vector<StressMeasure> measures;
    for (;;) {
      const SolverModel& model = built.model;
      for (const LoadStep& s : model.sets.steps)
        if (s.large_displacements)
          fail_usage("--accuracy is for steps of small displacements", s.name,
                     "leave --accuracy or large_displacements out");
      if (model.sets.has_contact())
        fail_usage("--accuracy is for bodies that are joined, not for contact", "--accuracy",
                   "tie the parts, or leave --accuracy out");
      SolverModel first = model;  // its first static step alone
      const LoadStep step = *std::find_if(first.sets.steps.begin(), first.sets.steps.end(),
                                          [](const LoadStep& s) { return s.analysis == Analysis::statics; });
      first.sets.steps = {step};
      MeshWriteOptions write = o_.mesh.write;
      const auto begin = std::chrono::steady_clock::now();
      const std::vector<Vec3> moved =
          solve_with_calculix(first, write, o_.mesh.mesh.threads, o_.mesh.mesh.fill.timeout_s);
      out.solve_s.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
      out.elements.push_back(model.mesh.tets.size());
      measures.push_back(recover_stress(first, moved));
      if (measures.size() > 1) {
        out.estimate = estimate_error(measures, o_.mesh.mesh.order);
        out.reached = out.estimate.error_rel <= out.asked_rel;
      }
      if (out.reached || measures.size() == kMostMeshes ||
          (!o_.mesh.mesh.many_tets && measures.size() > 1 && 8 * model.mesh.tets.size() > most_elements()))
        return out;
      product.mesh = refine_tets(std::move(product.mesh), 1);
      ++times_cut_;
      built = build(product);
    }
  }

  Built build(const MeshProduct& product) const {
    Built out;
    SetOptions sets;
    sets.up = product.up;
    sets.image = product.image;
    sets.sharp_deg = o_.sharp_deg;
    sets.selections = o_.selections;
    sets.times_cut = o_.mesh.mesh.refine + times_cut_;
    const LabelTable known(product.labels);
    for (const auto& [name, text] : o_.parts) sets.parts.push_back({name, known.numbers(text)});
    for (const auto& [text, thickness] : o_.skins)
      for (const Label l : known.numbers(text)) sets.skins.push_back({l, thickness});
    out.model = name_sets(product.mesh, product.labels, sets);
    SolverModel& model = out.model;

    if (image_) {
      for (const Warning& w : image_->warnings) out.warnings.push_back(w);
      if (product.mesh.space == Space::none)
        fail_usage("an image cannot be mapped onto a mesh without anatomical axes", "--image " + o_.image,
                   "give labels that carry their place in the world");
    }
    out.materials = assign_materials(model, plan_ ? &*plan_ : nullptr, image_ ? &*image_ : nullptr);
    for (const Warning& w : out.materials.warnings) out.warnings.push_back(w);
    if (!plan_)
      out.warnings.push_back(
          {WarningCode::materials, "", "no --materials: decks that need materials carry placeholders (E = 1 MPa)"});
    model.sets.quality = element_quality(model.mesh).scaled_jacobian;
    if (plan_) apply_load_case(model, plan_->load_case, o_.materials);
    JoinOptions join;
    join.others = o_.contact;
    if (plan_) join.laws = &plan_->contacts;
    join.path = o_.materials;
    join_parts(model, join);
    check_supports(model, o_.materials);
    if (model.mesh.mid.empty() && !model.sets.steps.empty())
      out.warnings.push_back({WarningCode::element_order, "",
                              "linear tetrahedra answer too stiffly, and their stresses are too low where it bends (by "
                              "a quarter in the middle of a coarse mesh): "
                              "take --order 2 for figures that are to be relied on"});
    return out;
  }

  FemReport summary(const SolverModel& model, const MaterialReport& materials) const {
    FemReport f;
    f.order = model.mesh.mid.empty() ? 1 : 2;
    f.nodes = model.mesh.points.size();
    f.elements = model.mesh.elements();
    f.wedges = model.mesh.wedges.size();
    f.image = o_.image;
    f.materials_path = o_.materials;
    f.placeholder_materials = model.sets.placeholder_materials;
    for (const NodeSet& s : model.sets.node_sets) {
      FemSet row{s.name, s.note, s.nodes.size(), 0};
      for (const FaceSet& faces : model.sets.surfaces)
        if (faces.name == s.name) row.faces = faces.faces.size();
      f.sets.push_back(row);
    }
    f.pairs = model.sets.pairs;
    f.materials = materials.labels;
    for (const ShellSet& s : model.sets.shells) {
      f.skins.push_back({s.name, s.thickness_mm});
      f.shells += s.faces.size();
    }
    f.bodies = bodies_of(model);
    for (const LoadStep& s : model.sets.steps) f.steps.push_back(summary(model, s));
    if (!f.steps.empty()) {
      f.supports = f.steps[0].supports;
      f.loaded_nodes = f.steps[0].loaded_nodes;
      f.force_n = f.steps[0].force_n;
    }
    return f;
  }

  static FemStep summary(const SolverModel& model, const LoadStep& s) {
    FemStep out;
    out.name = s.name;
    out.frequency = s.analysis == Analysis::frequency;
    out.large_displacements = s.large_displacements || model.sets.is_hyperelastic();
    out.supports = s.supports.size() + s.point_supports.size();
    std::set<std::int32_t> loaded;
    for (const auto& [node, force] : s.forces_n) {
      loaded.insert(node);
      out.force_n = out.force_n + force;
    }
    for (const PointLoad& l : s.point_loads) out.force_n = out.force_n + l.force_n;
    for (const Pressure& p : s.pressures) {
      out.force_n = out.force_n + force_of(model, p);
      for (const NodeSet& set : model.sets.node_sets)
        if (set.name == p.set) loaded.insert(set.nodes.begin(), set.nodes.end());
    }
    out.loaded_nodes = loaded.size() + s.point_loads.size();
    out.pressures = s.pressures.size();
    out.gravity_mm_s2 = s.gravity_mm_s2;
    return out;
  }

  const FemRunOptions& o_;
  Monitor& progress_;
  std::optional<MaterialPlan> plan_;
  std::optional<IntensityVolume> image_;
  int times_cut_ = 0;                                   // by --accuracy, beyond --refine
  std::map<std::array<std::int32_t, 3>, Label> walls_;  // of a given mesh: its faces on voids, by their sorted corners
  std::vector<LabelInfo> voids_;                        // that the mesh names
  Space written_ = Space::lps;
};

}  // namespace

RunReport run_fem(const FemRunOptions& options, Monitor& progress) {
  return FemRun(options, progress).run();
}

}  // namespace stackmesh
