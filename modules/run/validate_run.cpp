#include "run/validate_run.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

#include "base/cancel.h"
#include "base/error.h"
#include "base/sha256.h"
#include "base/stage_clock.h"
#include "base/text.h"
#include "base/warning.h"
#include "model/space.h"
#include "report/html_report.h"
#include "run/complete_report.h"
#include "run/output_files.h"
#include "run/provenance.h"
#include "run/report_names.h"
#include "run/turn_as_a_whole.h"
#include "validate/defects.h"
#include "validate/overlap.h"

namespace stackmesh {
namespace {

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", share);
  return text;
}

/// Letters and digits only, in lower case: how decks and groups spell a name.
std::string plain(const std::string& name) {
  std::string text;
  for (const char c : lower_case(name))
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) text += c;
  return text;
}

/// What is read once for all meshes.
struct Against {
  Input input;
  Stack sections;                              // of contours
  std::array<int, 3> stored_size = {0, 0, 0};  // of a volume, as its file has it
  std::array<double, 3> stored_spacing_mm = {0, 0, 0};
  Frame stored_frame;  // from the centre of its first voxel
  int axis = 2;
  std::optional<OverlapMeter> meter;
};

/// One mesh, from its file to its verdicts.
class ValidateRun {
 public:
  ValidateRun(const ValidateRunOptions& options, Against* against, const RunReport& start, Monitor& progress)
      : o_(options), against_(against), report_(start), clock_(progress, report_.stages) {}

  RunReport run(const std::string& path) {
    clock_.run("read", [&] { read(path); });
    clock_.run("validate", [&] {
      turn_round();
      take_frame();
      if (mirrored_) turn_round();
      match_labels();
      check();
      verdicts();
    });
    return std::move(report_);
  }

  /// For the HTML page; `labels`: with the labels' own slices.
  HtmlPictures draw(bool labels) const {
    HtmlScene scene;
    scene.surface = &surface_;
    if (!tets_.elements() == 0) scene.mesh = &tets_;
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
    const InterfaceComplex part = defect_triangles(surface_, tets_.elements() == 0 ? nullptr : &tets_, report.defects);
    if (part.triangles.empty()) return;
    std::string name = file_.path.substr(file_.path.rfind('/') + 1);
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
  void warn(Warning w) { report_.warnings.push_back(std::move(w)); }

  void read(const std::string& path) {
    file_ = read_mesh(path, o_.read);
    JudgedMesh m;
    m.path = path, m.format = file_.format;
    m.vertices = file_.points.size() + file_.merged_points;
    m.triangles = file_.triangles.size() + file_.dropped_triangles, m.tets = file_.tets.size(),
    m.wedges = file_.wedges.size();
    m.order = file_.midside.empty() ? 1 : 2;
    if (!o_.reports.empty()) m.sha256 = sha256_of_file(path);
    report_.mesh = std::move(m);
    for (const std::string& n : file_.notes) warn({WarningCode::mesh_converted, file_.path, n});
    if (file_.tets.empty() && file_.wedges.empty()) {
      surface_.points = std::move(file_.points);
      surface_.triangles = std::move(file_.triangles);
      return;
    }
    tets_ = take_elements(file_);
    tets_.faces = std::move(file_.triangles);
    has_faces_ = !tets_.faces.empty();
  }

  void turn_round() {
    for (const std::string& note : turn_as_a_whole(surface_, tets_, has_faces_))
      warn({WarningCode::mesh_converted, file_.path, note});
  }

  // ---- frame

  void take_frame() {
    JudgedMesh& m = *report_.mesh;
    const bool anatomical = against_ && against_->input.anatomical;
    const bool known = anatomical || !against_;
    if (o_.mesh_space == "image") {
      take_image_frame(anatomical);
      return;
    }
    lies_in(known ? Space::lps : Space::none);
    if (against_ && !anatomical) {
      m.space_reason = "the input has no anatomy: coordinates are taken as they are";
      if (o_.mesh_space == "ras")
        fail_usage("--mesh-space ras needs an input with anatomical axes", against_->input.path,
                   "leave --mesh-space out");
      if (against_->input.volume && overlap(Frame{}) == 0) no_overlap("as it is", {});
      return;
    }
    const std::optional<Space> told = o_.mesh_space == "lps"   ? std::optional(Space::lps)
                                      : o_.mesh_space == "ras" ? std::optional(Space::ras)
                                                               : file_.space;
    if (!against_) {
      lies_in(told.value_or(Space::none));
      m.space_reason = o_.mesh_space != "auto" ? "as told by --mesh-space"
                       : told                  ? "the file says so"
                                               : "the file does not say, and there are no labels to compare with";
      return;
    }
    if (!against_->input.volume) {
      take_told_frame(told);
      return;
    }
    if (told) {
      const std::string who = o_.mesh_space != "auto" ? "--mesh-space tells" : "the file tells";
      const bool is_ras = told == Space::ras;
      const double dice = overlap(between(*told, Space::lps));
      lies_in(*told);
      m.space_reason = who + " " + (is_ras ? "RAS" : "LPS") + " (Dice " + percent(dice) + ")";
      if (dice < 0.5) {
        const double other = overlap(between(is_ras ? Space::lps : Space::ras, Space::lps));
        if (other > 0.5 && other > 2 * dice) {
          wrong_frame_ = "the mesh is taken as " + std::string(is_ras ? "RAS" : "LPS") + " because " + who +
                         " so, but as " + (is_ras ? "LPS" : "RAS") + " it would fit: Dice " + percent(other) +
                         " instead of " + percent(dice);
        } else if (dice == 0) {
          no_overlap(is_ras ? "as RAS" : "as LPS", is_ras ? "LPS: " + percent(other) : "RAS: " + percent(other));
        }
      }
      to_lps();
      return;
    }
    const double lps = overlap(Frame{}), ras = overlap(between(Space::ras, Space::lps));
    if (std::max(lps, ras) < 0.5 && take_mirror(std::max(lps, ras))) return;
    if (lps == 0 && ras == 0) no_overlap("neither as LPS nor as RAS", {});
    lies_in(ras > lps ? Space::ras : Space::lps);
    m.space_reason =
        "the file does not say; overlap with the labels: Dice " + percent(lps) + " as LPS, " + percent(ras) + " as RAS";
    if (std::abs(lps - ras) < 0.05)
      warn({WarningCode::frame, file_.path,
            "the frame is uncertain (" + m.space_reason + "): tell it with --mesh-space"});
    to_lps();
  }

  /// Against drawn contours, which have no voxels to compare with.
  void take_told_frame(const std::optional<Space>& told) {
    lies_in(told.value_or(Space::lps));
    report_.mesh->space_reason =
        !told ? "neither the mesh nor the contours say: taken as LPS"
              : std::string(o_.mesh_space != "auto" ? "--mesh-space tells " : "the file tells ") +
                    (told == Space::ras ? "RAS" : "LPS");
    to_lps();
  }

  /// Coordinates are indices times spacing, 0 the centre of the first voxel: they are moved to where the voxels lie.
  void take_image_frame(bool anatomical) {
    if (!against_ || !against_->input.volume)
      fail_usage("--mesh-space image needs the image", "command line", "name the label volume with --against");
    for (std::vector<Vec3>* points : {&surface_.points, &tets_.points})
      for (Vec3& p : *points) p = against_->stored_frame.to_world(p);
    turn_round();  // axes may mirror
    lies_in(anatomical ? Space::lps : Space::none);
    const double dice = overlap(Frame{});
    report_.mesh->space_reason = "moved from indices times spacing, as --mesh-space tells (Dice " + percent(dice) + ")";
    if (dice == 0) no_overlap("as indices times spacing", {});
  }

  /// The frame in which the mesh was written, as the report names it.
  void lies_in(Space space) {
    surface_.space = tets_.space = space;
    report_.mesh->space = to_text(space);
  }

  /// Into the frame of the labels.
  void to_lps() {
    change_space(surface_, Space::lps);
    change_space(tets_, Space::lps);
  }

  void scale(double x, double y, double z) {
    for (std::vector<Vec3>* points : {&surface_.points, &tets_.points})
      for (Vec3& p : *points) p = {x * p.x, y * p.y, z * p.z};
  }

  /// Some programs negate one axis. It is judged in the frame that fits, and said.
  bool take_mirror(double otherwise) {
    const struct {
      const char* text;
      double x, y, z;
    } mirrors[] = {{"RPS (x negated)", -1, 1, 1},
                   {"LAS (y negated)", 1, -1, 1},
                   {"LPI (z negated)", 1, 1, -1},
                   {"RAI (all negated)", -1, -1, -1}};
    for (const auto& m : mirrors) {
      Frame f;
      f.axes = {Vec3{m.x, 0, 0}, Vec3{0, m.y, 0}, Vec3{0, 0, m.z}};
      const double dice = overlap(f);
      if (dice < 0.5 || dice < 2 * otherwise) continue;
      scale(m.x, m.y, m.z);
      mirrored_ = true;
      report_.mesh->space = m.text;
      report_.mesh->space_reason = "the file does not say; it fits only mirrored (Dice " + percent(dice) +
                                   ", at most " + percent(otherwise) + " as LPS or RAS)";
      wrong_frame_ = "the mesh is a mirror image: it fits the labels only as " + std::string(m.text) + ", Dice " +
                     percent(dice) + "; all else is judged in that frame";
      return true;
    }
    return false;
  }

  double overlap(const Frame& frame) const {
    return against_->meter ? against_->meter->measure(surface_, frame, 48).dice_of_all() : 0;
  }

  /// Names the usual mistakes that would explain it.
  [[noreturn]] void no_overlap(const std::string& tried, const std::string& other) const {
    std::string hint = "check the frame, the unit and which labels the mesh was made from";
    Frame metres, image;
    for (int k = 0; k < 3; ++k) metres.axes[k] = 1000.0 * metres.axes[k];
    const LabelVolume& v = *against_->input.volume;
    image.origin = v.origin_mm;
    image.axes = v.axes;
    const struct {
      const char* text;
      Frame frame;
    } guesses[] = {
        {"it would fit in metres: scale it by 1000", metres},
        {"it would fit in the image's own axes and millimetres: add the origin and direction of the labels", image}};
    for (const auto& g : guesses)
      if (overlap(g.frame) > 0.5) hint = g.text;
    fail_input("the mesh and the labels do not overlap (" + tried + (other.empty() ? "" : "; " + other) + ")",
               file_.path + " and " + against_->input.path, hint);
  }

  // ---- labels

  void match_labels() {
    std::set<Label> of_mesh;
    for (const InterfaceTriangle& t : surface_.triangles) of_mesh.insert(t.below), of_mesh.insert(t.above);
    of_mesh.erase(0);
    if (!against_) {
      for (const Label l : of_mesh) {
        LabelReport row;
        row.label = l;
        for (const LabelInfo& n : file_.names)
          if (n.number == l) row.name = n.name;
        report_.labels.push_back(row);
      }
      report_.mesh->labels = source_text() + ": " + list(of_mesh);
      return;
    }
    labels_ = against_->input.labels;
    std::map<Label, Label> to;  // label of the mesh to that of the input
    if (file_.label_source == LabelSource::none) single_surface(to);
    else if (file_.label_source == LabelSource::sets && file_.numbers_from_names) by_name(of_mesh, to);
    else by_number(of_mesh, to);
    std::string text = source_text();
    for (const auto& [from, target] : to)
      if (from != target && file_.label_source != LabelSource::none && to.size() < 12)
        text += ", " + std::to_string(from) + " stands for " + std::to_string(target);
    report_.mesh->labels = text + matched_;
    rename(to);
    add_label_rows(report_, labels_);
  }

  std::string source_text() const {
    switch (file_.label_source) {
      case LabelSource::none:
        return "no labels in the file";
      case LabelSource::sides:
        return "labels from " + file_.label_array;
      case LabelSource::array:
        return "labels from array '" + file_.label_array + "'";
      case LabelSource::sets:
        return "labels from sets";
    }
    return "";
  }

  static std::string list(const std::set<Label>& labels) {
    std::string text;
    std::size_t n = 0;
    for (const Label l : labels) {
      if (++n > 12) return text + " and " + std::to_string(labels.size() - 12) + " more";
      text += (n > 1 ? ", " : "") + std::to_string(l);
    }
    return text;
  }

  bool asked(Label label) const {
    return std::any_of(labels_.begin(), labels_.end(), [&](const LabelInfo& l) { return l.number == label; });
  }
  void keep_only(Label label) {
    labels_.erase(std::remove_if(labels_.begin(), labels_.end(), [&](const LabelInfo& l) { return l.number != label; }),
                  labels_.end());
  }

  /// No labels in the file: it stands for the only label that is requested, the one that it fits best, or all together.
  void single_surface(std::map<Label, Label>& to) {
    if (labels_.size() == 1) {
      to[1] = labels_[0].number;
      matched_ = ", it stands for label " + std::to_string(to[1]);
      return;
    }
    if (!against_->meter)
      fail_input("the mesh has one surface and the contours have " + std::to_string(labels_.size()) + " labels",
                 file_.path, "say which with --label");
    const LabelOverlap o = against_->meter->measure(surface_);
    std::size_t best = 1;
    for (std::size_t l = 2; l < o.input_centres.size(); ++l)
      if (o.dice(0, l) > o.dice(0, best)) best = l;
    const double one = o.dice(0, best), all = o.dice_of_all();
    if (all > one) {
      union_ = true;
      to[1] = labels_[0].number;
      matched_ = ", it stands for all labels together (Dice " + percent(all) + "; best single label " +
                 std::to_string(labels_[best - 1].number) + ": " + percent(one) + ")";
    } else {
      to[1] = labels_[best - 1].number;
      matched_ = ", it fits label " + std::to_string(to[1]) + " best (Dice " + percent(one) + "; all together " +
                 percent(all) + ")";
    }
    warn({WarningCode::labels_matched, file_.path,
          "the mesh has one surface and the input " + std::to_string(labels_.size()) + " labels" + matched_ +
              "; --label tells which"});
    if (!union_) keep_only(to[1]);
  }

  void by_number(const std::set<Label>& of_mesh, std::map<Label, Label>& to) {
    std::set<Label> shared, unknown;
    for (const Label l : of_mesh) (asked(l) ? shared : unknown).insert(l);
    if (shared.empty()) {
      by_overlap(of_mesh, to, "no label number of the mesh (" + list(of_mesh) + ") is one of the input");
      return;
    }
    for (const Label l : of_mesh) to[l] = asked(l) ? l : 0;
    forget(unknown);
    if (of_mesh.size() == 1 && labels_.size() > 1) {
      warn({WarningCode::labels_matched, file_.path,
            "the mesh has label " + list(of_mesh) + " alone: only that label is judged"});
      keep_only(*of_mesh.begin());
    }
  }

  /// Labels of the mesh that the input does not have, or that were not requested, are background.
  void forget(const std::set<Label>& unknown) {
    if (!unknown.empty())
      warn({WarningCode::labels_matched, file_.path,
            "labels of the mesh that are not requested or not in the input are taken as background: " + list(unknown)});
  }

  void by_name(const std::set<Label>& of_mesh, std::map<Label, Label>& to) {
    std::map<std::string, Label> known;
    for (const LabelInfo& l : labels_) {
      if (!l.name.empty()) known[plain(l.name)] = l.number;
      known.emplace(plain("label_" + std::to_string(l.number)), l.number);
    }
    std::set<Label> unknown;
    for (const LabelInfo& n : file_.names) {
      const auto it = known.find(plain(n.name));
      if (it != known.end()) to[n.number] = it->second;
    }
    for (const Label l : of_mesh)
      if (!to.count(l)) unknown.insert(l);
    if (unknown.size() == of_mesh.size()) {
      to.clear();
      by_overlap(of_mesh, to, "no set of the mesh has the name of a label of the input");
      return;
    }
    for (const Label l : unknown) to[l] = 0;
    forget(unknown);
  }

  /// Each label of the mesh stands for the one that it covers best.
  void by_overlap(const std::set<Label>& of_mesh, std::map<Label, Label>& to, const std::string& why) {
    if (!against_->meter) fail_input(why, file_.path, "renumber the labels of the mesh");
    const LabelOverlap o = against_->meter->measure(surface_);
    std::string text;
    for (std::size_t m = 0; m < o.mesh_labels.size(); ++m) {
      std::size_t best = 1;
      for (std::size_t l = 2; l < o.input_centres.size(); ++l)
        if (o.dice(m, l) > o.dice(m, best)) best = l;
      const Label target = o.dice(m, best) > 0 ? labels_[best - 1].number : 0;
      to[o.mesh_labels[m]] = target;
      if (m < 12)
        text += (m ? ", " : "") + std::to_string(o.mesh_labels[m]) + " as " + std::to_string(target) + " (Dice " +
                percent(o.dice(m, best)) + ")";
    }
    warn({WarningCode::labels_matched, file_.path,
          why + ": its labels are taken for those that they overlap best: " + text});
    if (of_mesh.size() == 1 && labels_.size() > 1 && to.begin()->second != 0) keep_only(to.begin()->second);
  }

  void rename(const std::map<Label, Label>& to) {
    const auto of = [&](Label l) {
      const auto it = to.find(l);
      return it == to.end() ? 0 : it->second;
    };
    const auto apply = [&](std::vector<InterfaceTriangle>& triangles) {
      for (InterfaceTriangle& t : triangles) t.below = of(t.below), t.above = of(t.above);
      triangles.erase(std::remove_if(triangles.begin(), triangles.end(),
                                     [](const InterfaceTriangle& t) { return t.below == t.above; }),
                      triangles.end());
    };
    const bool same = std::all_of(to.begin(), to.end(), [](const auto& p) { return p.first == p.second; });
    if (same) return;
    apply(surface_.triangles);
    if (tets_.elements() == 0) return;
    apply(tets_.faces);
    relabel(tets_, of);
  }

  // ---- checks

  void check() {
    check_mesh(report_, surface_, tets_.elements() == 0 ? nullptr : &tets_, o_.threads);
    if (against_ && against_->input.volume) check_against_labels();
  }

  void check_against_labels() {
    const LabelVolume* volume = &*against_->input.volume;
    if (union_ || labels_.size() + 1 < volume->labels.size()) {
      std::vector<std::size_t> keep;
      for (std::size_t k = 1; k < volume->labels.size(); ++k)
        if (union_ || asked(volume->labels[k].number)) keep.push_back(k);
      selected_ = select_labels(*volume, keep, union_);
      if (union_) {
        labels_.assign(selected_->labels.begin() + 1, selected_->labels.end());
        for (InterfaceTriangle& t : surface_.triangles)
          t.below = t.below ? labels_[0].number : 0, t.above = t.above ? labels_[0].number : 0;
        report_.labels.resize(1);
        report_.labels[0].label = labels_[0].number;
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
    fidelity_ = check_fidelity(surface_, *volume, options);
  }

  void verdicts() {
    Judged j;
    j.surface = &surface_;
    if (!tets_.elements() == 0) j.mesh = &tets_;
    if (against_) {
      if (against_->input.volume) j.volume = &*against_->input.volume;
      if (!against_->input.volume) j.sections = &against_->sections;
      j.axis = against_->axis;
    }
    if (!fidelity_.empty()) j.fidelity = &fidelity_;
    j.threads = o_.threads;
    complete_report(report_, j);
    if (!wrong_frame_.empty()) frame_verdict();
  }

  void frame_verdict() {
    Verdict v;
    v.id = "frame", v.title = "Frame", v.status = Status::fail;
    v.figure = mirrored_                      ? "mirrored: " + report_.mesh->space
               : report_.mesh->space == "ras" ? "taken as RAS, fits as LPS"
                                              : "taken as LPS, fits as RAS";
    v.limit = "must fit";
    v.explanation = wrong_frame_ + ".";
    const auto at =
        std::find_if(report_.verdicts.begin(), report_.verdicts.end(), [](const Verdict& o) { return !o.validity; });
    report_.verdicts.insert(at, v);
    Defect d;
    d.kind = "wrong_frame";
    Vec3 low = {1e300, 1e300, 1e300}, high = {-1e300, -1e300, -1e300};
    for (const Vec3& p : surface_.points) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    d.where = 0.5 * (low + high);
    d.text = wrong_frame_;
    report_.defects.insert(report_.defects.begin(), std::move(d));
  }

  const ValidateRunOptions& o_;
  Against* against_;
  RunReport report_;
  StageClock clock_;
  MeshFile file_;
  InterfaceComplex surface_;  // in the frame of the labels once it is known
  TetMesh tets_;
  bool has_faces_ = false, union_ = false, mirrored_ = false;
  std::vector<LabelInfo> labels_;        // of the input that are judged
  std::optional<LabelVolume> selected_;  // those, where they are not all of the input's
  std::string matched_, wrong_frame_;
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

void describe_input(const Against& against, RunReport& report) {
  report.input.path = against.input.path;
  report.input.kind = against.input.kind;
  report.warnings = against.input.warnings;
  report.input.axis = std::string(1, "xyz"[against.axis]);
  if (against.input.volume) {
    const LabelVolume& v = *against.input.volume;
    report.input.dimensions = against.stored_size;
    report.input.spacing_mm = against.stored_spacing_mm;
    report.input.effective_spacing_mm = v.spacing_mm;
    report.input.sections = static_cast<std::size_t>(v.size[against.axis]);
    report.input.space = v.anatomical ? "lps" : "none";
  } else {
    report.input.sections = against.sections.sections.size();
    report.input.space = against.input.anatomical ? "lps" : "none";
  }
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
        against->input = read_input(*o.against);
        empty_voids(against->input);
        if (!against->input.volume) {
          against->sections = drawn_sections(against->input);
          empty_voids(against->sections, against->input.voids);
        }
        if (against->input.volume) {
          against->stored_size = against->input.volume->size;
          against->stored_spacing_mm = against->input.volume->spacing_mm;
          against->stored_frame = {against->input.volume->origin_mm, against->input.volume->axes};
          if (!o.as_stored) reduce_to_true_grid(against->input, o.threads);
          against->axis = stacking_axis(*against->input.volume, o.axis);
          against->meter.emplace(*against->input.volume, against->axis, o.threads);
        }
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
