#include "run/fem_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

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
#include "image/read_image.h"
#include "mesh/voids.h"
#include "meshio/read_mesh.h"
#include "model/label_table.h"
#include "model/space.h"
#include "report/html_report.h"
#include "run/fem_summary.h"
#include "run/given_mesh.h"
#include "run/mesh_product.h"
#include "run/output_files.h"
#include "run/provenance.h"
#include "run/report_names.h"
#include "run/solve_with_calculix.h"
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
    GivenMesh given(o_);
    MeshProduct product;
    clock.run("read", [&] { product = given.read(path, report); });
    check_labels(product.labels);
    clock.run("validate", [&] { given.check(product, report); });
    const std::vector<Label> behind = given.voids_behind(product.mesh.faces);
    change_space(product.mesh, given.written());  // it was read and judged in LPS
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
    product.labels.insert(product.labels.end(), given.voids().begin(), given.voids().end());
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
    report.fem = summary_of(model, built.materials, o_.image, o_.materials);
    if (asks_for_html(o_.mesh.reports))
      report.fem->faces = surface_values(model, o_.result.empty() ? std::vector<double>() : mises_of(model, o_.result));
    report.fem->accuracy = std::move(accuracy);
    if (report.fem->accuracy && !report.fem->accuracy->reached)
      report.warnings.push_back({WarningCode::accuracy, "set " + report.fem->accuracy->estimate.worst_set,
                                 not_reached(*report.fem->accuracy)});

    MeshWriteOptions write = o_.mesh.write;
    for (const std::string& path : o_.mesh.outputs) {
      if (!is_volume_format(path)) continue;
      for (const std::string& loss : losses_of(path, model))
        report.warnings.push_back({WarningCode::format_loss, path, loss});
      write_model(files, path, model, write);
    }
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
    for (Warning& w : out.materials.warnings) {
      if (w.where.empty()) w.where = o_.image;  // what is no label's is the image's
      out.warnings.push_back(w);
    }
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

  const FemRunOptions& o_;
  Monitor& progress_;
  std::optional<MaterialPlan> plan_;
  std::optional<IntensityVolume> image_;
  int times_cut_ = 0;  // by --accuracy, beyond --refine
};

}  // namespace

RunReport run_fem(const FemRunOptions& options, Monitor& progress) {
  return FemRun(options, progress).run();
}

}  // namespace stackmesh
