#include "run/validate_run.h"

#include <algorithm>

#include "base/cancel.h"
#include "base/error.h"
#include "base/stage_clock.h"
#include "base/warning.h"
#include "meshio/write_mesh.h"
#include "report/html_report.h"
#include "run/complete_report.h"
#include "run/label_matching.h"
#include "run/mesh_frame.h"
#include "run/mesh_to_judge.h"
#include "run/output_files.h"
#include "run/provenance.h"
#include "run/report_names.h"
#include "validate/defects.h"

namespace stackmesh {
namespace {

/// One mesh, from its file to its verdicts.
class ValidateRun {
 public:
  ValidateRun(const ValidateRunOptions& options, Against* against, const RunReport& start, Monitor& progress)
      : o_(options), against_(against), report_(start), clock_(progress, report_.stages) {}

  RunReport run(const std::string& path) {
    clock_.run("read", [&] { m_ = read_mesh_to_judge(path, o_, report_); });
    clock_.run("validate", [&] {
      turn_round(m_, report_);
      frame_ = take_frame(m_, against_, o_.mesh_space, report_);
      if (frame_.mirrored) turn_round(m_, report_);
      match_ = match_labels(m_, against_, report_);
      check();
      verdicts();
    });
    return std::move(report_);
  }

  /// For the HTML page; `labels`: with the labels' own slices.
  HtmlPictures draw(bool labels) const {
    HtmlScene scene;
    scene.surface = &m_.surface;
    if (!m_.tets.elements() == 0) scene.mesh = &m_.tets;
    if (against_ && against_->input.volume) scene.volume = selected_ ? &*selected_ : &*against_->input.volume;
    if (against_ && !against_->input.volume) scene.sections = &against_->sections;
    if (against_) scene.stack_axis = against_->axis;
    HtmlOptions options;
    options.threads = o_.threads;
    options.labels = labels;
    options.bytes_limit /= o_.meshes.size();
    return draw_pictures(scene, options);
  }

  /// The defects' triangles, where they were requested and there are any.
  void write_defects(AtomicFiles& files, RunReport& report) const {
    if (!o_.write_defects || report.defects.empty()) return;
    const InterfaceComplex part =
        defect_triangles(m_.surface, m_.tets.elements() == 0 ? nullptr : &m_.tets, report.defects);
    if (part.triangles.empty()) return;
    std::string name = m_.file.path.substr(m_.file.path.rfind('/') + 1);
    for (char& c : name)
      if (c == '.') c = '_';
    std::string folder = o_.defects_folder;
    if (folder.empty() && !o_.reports.empty() && o_.reports[0].rfind('/') != std::string::npos)
      folder = o_.reports[0].substr(0, o_.reports[0].rfind('/'));
    const std::string path = (folder.empty() ? "" : folder + "/") + name + ".defects.vtp";
    write_surface(files, path, part);
    report.warnings.push_back(
        {WarningCode::file_written, path,
         "the triangles of the defects are in " + path + ": label_below is the number of the defect, from 1"});
  }

 private:
  bool is_judged(Label label) const {
    return std::any_of(match_.labels.begin(), match_.labels.end(),
                       [&](const LabelInfo& l) { return l.number == label; });
  }

  void check() {
    check_mesh(report_, m_.surface, m_.tets.elements() == 0 ? nullptr : &m_.tets, o_.threads);
    if (against_ && against_->input.volume) check_against_labels();
  }

  void check_against_labels() {
    const LabelVolume* volume = &*against_->input.volume;
    if (match_.united || match_.labels.size() + 1 < volume->labels.size()) {
      std::vector<std::size_t> keep;
      for (std::size_t k = 1; k < volume->labels.size(); ++k)
        if (match_.united || is_judged(volume->labels[k].number)) keep.push_back(k);
      selected_ = select_labels(*volume, keep, match_.united);
      if (match_.united) {
        match_.labels.assign(selected_->labels.begin() + 1, selected_->labels.end());
        for (InterfaceTriangle& t : m_.surface.triangles)
          t.below = t.below ? match_.labels[0].number : 0, t.above = t.above ? match_.labels[0].number : 0;
        report_.labels.resize(1);
        report_.labels[0].label = match_.labels[0].number;
        report_.labels[0].name = "all labels together";
      }
      volume = &*selected_;
    }
    const std::vector<std::size_t> counts = count_voxels(*volume);
    for (LabelReport& row : report_.labels)
      for (std::size_t k = 1; k < volume->labels.size(); ++k)
        if (volume->labels[k].number == row.label)
          row.input_volume_mm3 = static_cast<double>(counts[k]) * volume->voxel_volume_mm3();
    FidelityOptions options;
    options.threads = o_.threads;
    options.stack_axis = against_->axis;
    fidelity_ = check_fidelity(m_.surface, *volume, options);
  }

  void verdicts() {
    Judged j;
    j.surface = &m_.surface;
    if (!m_.tets.elements() == 0) j.mesh = &m_.tets;
    if (against_) {
      if (against_->input.volume) j.volume = &*against_->input.volume;
      if (!against_->input.volume) j.sections = &against_->sections;
      j.axis = against_->axis;
    }
    if (!fidelity_.empty()) j.fidelity = &fidelity_;
    j.threads = o_.threads;
    complete_report(report_, j);
    if (!frame_.wrong.empty()) frame_verdict();
  }

  void frame_verdict() {
    Verdict v;
    v.id = "frame", v.title = "Frame", v.status = Status::fail;
    v.figure = frame_.mirrored                ? "mirrored: " + report_.mesh->space
               : report_.mesh->space == "ras" ? "taken as RAS, fits as LPS"
                                              : "taken as LPS, fits as RAS";
    v.limit = "must fit";
    v.explanation = frame_.wrong + ".";
    const auto at =
        std::find_if(report_.verdicts.begin(), report_.verdicts.end(), [](const Verdict& o) { return !o.validity; });
    report_.verdicts.insert(at, v);
    Defect d;
    d.kind = "wrong_frame";
    Vec3 low = {1e300, 1e300, 1e300}, high = {-1e300, -1e300, -1e300};
    for (const Vec3& p : m_.surface.points) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    d.where = 0.5 * (low + high);
    d.text = frame_.wrong;
    report_.defects.insert(report_.defects.begin(), std::move(d));
  }

  const ValidateRunOptions& o_;
  Against* against_;
  RunReport report_;
  StageClock clock_;
  MeshToJudge m_;  // in the frame of the labels once it is known
  FrameFinding frame_;
  LabelMatch match_;
  std::optional<LabelVolume> selected_;  // the labels that are judged, where they are not all of the input's
  std::vector<LabelFidelity> fidelity_;
};

void check_names(const ValidateRunOptions& o) {
  check_report_names(o.reports);
  if (o.mesh_space != "auto" && o.mesh_space != "lps" && o.mesh_space != "ras" && o.mesh_space != "image")
    fail_usage("unknown space '" + o.mesh_space + "'", "--mesh-space", "choose lps, ras, image or auto");
  std::vector<std::string> inputs = o.meshes;
  if (o.against) inputs.insert(inputs.end(), o.against->paths.begin(), o.against->paths.end());
  check_output_files(o.reports, inputs);
}

}  // namespace

std::vector<RunReport> run_validate(const ValidateRunOptions& o, Monitor& progress) {
  const CancelScope scope(&progress);
  check_names(o);
  RunReport start;
  start.command = "validate";
  start.version = o.version;
  start.options = o.option_texts;
  start.input.space = "none";
  if (o.limits) start.limits = *o.limits;
  std::optional<Against> against;
  {
    StageClock clock(progress, start.stages);
    if (o.against)
      clock.run("read", [&] {
        against.emplace();
        read_against(o, *against);
        describe_input(*against, start);
        start.input.files = o.against->paths;
      });
    if (!o.reports.empty())
      clock.run("provenance",
                [&] { start.provenance = find_provenance(o.against ? o.against->paths : std::vector<std::string>()); });
  }
  std::vector<RunReport> reports;
  std::vector<HtmlPictures> pictures;
  const bool html = asks_for_html(o.reports);
  AtomicFiles files;
  for (const std::string& path : o.meshes) {
    ValidateRun run(o, against ? &*against : nullptr, start, progress);
    reports.push_back(run.run(path));
    run.write_defects(files, reports.back());
    if (html) {
      StageClock clock(progress, reports.back().stages);
      clock.run("pictures", [&] { pictures.push_back(run.draw(pictures.empty())); });
    }
    reports.back().peak_rss_mb = peak_memory_mb();
  }
  std::vector<HtmlSubject> subjects;
  for (std::size_t i = 0; html && i < reports.size(); ++i) {
    const std::string& path = reports[i].mesh->path;
    subjects.push_back({path.substr(path.rfind('/') + 1), &reports[i], &pictures[i]});
  }
  for (const std::string& path : o.reports) {
    const std::string text = is_html_report(path)  ? to_html(subjects)
                             : reports.size() == 1 ? to_json(reports[0])
                                                   : to_json(reports);
    files.write(path, [&](std::FILE* f) { std::fwrite(text.data(), 1, text.size(), f); });
  }
  files.commit();
  return reports;
}

}  // namespace stackmesh
