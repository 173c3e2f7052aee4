#include "run/mesh_frame.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/error.h"
#include "model/space.h"

namespace stackmesh {
namespace {

class FrameFinder {
 public:
  FrameFinder(MeshToJudge& mesh, const Against* against, const std::string& mesh_space, RunReport& report)
      : m_(mesh), against_(against), mesh_space_(mesh_space), report_(report) {}

  FrameFinding run() {
    take_frame();
    return std::move(out_);
  }

 private:
  void take_frame() {
    JudgedMesh& m = *report_.mesh;
    const bool anatomical = against_ && against_->input.anatomical;
    const bool known = anatomical || !against_;
    if (mesh_space_ == "image") {
      take_image_frame(anatomical);
      return;
    }
    lies_in(known ? Space::lps : Space::none);
    if (against_ && !anatomical) {
      m.space_reason = "the input has no anatomy: coordinates are taken as they are";
      if (mesh_space_ == "ras")
        fail_usage("--mesh-space ras needs an input with anatomical axes", against_->input.path,
                   "leave --mesh-space out");
      if (against_->input.volume && overlap(Frame{}) == 0) no_overlap("as it is", {});
      return;
    }
    const std::optional<Space> told = mesh_space_ == "lps"   ? std::optional(Space::lps)
                                      : mesh_space_ == "ras" ? std::optional(Space::ras)
                                                             : m_.file.space;
    if (!against_) {
      lies_in(told.value_or(Space::none));
      m.space_reason = mesh_space_ != "auto" ? "as told by --mesh-space"
                       : told                ? "the file says so"
                                             : "the file does not say, and there are no labels to compare with";
      return;
    }
    if (!against_->input.volume) {
      take_told_frame(told);
      return;
    }
    if (told) {
      const std::string who = mesh_space_ != "auto" ? "--mesh-space tells" : "the file tells";
      const bool is_ras = told == Space::ras;
      const double dice = overlap(between(*told, Space::lps));
      lies_in(*told);
      m.space_reason = who + " " + (is_ras ? "RAS" : "LPS") + " (Dice " + three_decimals(dice) + ")";
      if (dice < 0.5) {
        const double other = overlap(between(is_ras ? Space::lps : Space::ras, Space::lps));
        if (other > 0.5 && other > 2 * dice) {
          out_.wrong = "the mesh is taken as " + std::string(is_ras ? "RAS" : "LPS") + " because " + who +
                       " so, but as " + (is_ras ? "LPS" : "RAS") + " it would fit: Dice " + three_decimals(other) +
                       " instead of " + three_decimals(dice);
        } else if (dice == 0) {
          no_overlap(is_ras ? "as RAS" : "as LPS",
                     is_ras ? "LPS: " + three_decimals(other) : "RAS: " + three_decimals(other));
        }
      }
      to_lps();
      return;
    }
    const double lps = overlap(Frame{}), ras = overlap(between(Space::ras, Space::lps));
    if (std::max(lps, ras) < 0.5 && take_mirror(std::max(lps, ras))) return;
    if (lps == 0 && ras == 0) no_overlap("neither as LPS nor as RAS", {});
    lies_in(ras > lps ? Space::ras : Space::lps);
    m.space_reason = "the file does not say; overlap with the labels: Dice " + three_decimals(lps) + " as LPS, " +
                     three_decimals(ras) + " as RAS";
    if (std::abs(lps - ras) < 0.05)
      warn({WarningCode::frame, m_.file.path,
            "the frame is uncertain (" + m.space_reason + "): tell it with --mesh-space"});
    to_lps();
  }

  /// Against drawn contours, which have no voxels to compare with.
  void take_told_frame(const std::optional<Space>& told) {
    lies_in(told.value_or(Space::lps));
    report_.mesh->space_reason = !told
                                     ? "neither the mesh nor the contours say: taken as LPS"
                                     : std::string(mesh_space_ != "auto" ? "--mesh-space tells " : "the file tells ") +
                                           (told == Space::ras ? "RAS" : "LPS");
    to_lps();
  }

  /// Coordinates are indices times spacing, 0 the centre of the first voxel: they are moved to where the voxels lie.
  void take_image_frame(bool anatomical) {
    if (!against_ || !against_->input.volume)
      fail_usage("--mesh-space image needs the image", "command line", "name the label volume with --against");
    for (std::vector<Vec3>* points : {&m_.surface.points, &m_.tets.points})
      for (Vec3& p : *points) p = against_->stored_frame.to_world(p);
    turn_round(m_, report_);  // axes may mirror
    lies_in(anatomical ? Space::lps : Space::none);
    const double dice = overlap(Frame{});
    report_.mesh->space_reason =
        "moved from indices times spacing, as --mesh-space tells (Dice " + three_decimals(dice) + ")";
    if (dice == 0) no_overlap("as indices times spacing", {});
  }

  /// The frame in which the mesh was written, as the report names it.
  void lies_in(Space space) {
    m_.surface.space = m_.tets.space = space;
    report_.mesh->space = to_text(space);
  }

  /// Into the frame of the labels.
  void to_lps() {
    change_space(m_.surface, Space::lps);
    change_space(m_.tets, Space::lps);
  }

  void scale(double x, double y, double z) {
    for (std::vector<Vec3>* points : {&m_.surface.points, &m_.tets.points})
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
      out_.mirrored = true;
      report_.mesh->space = m.text;
      report_.mesh->space_reason = "the file does not say; it fits only mirrored (Dice " + three_decimals(dice) +
                                   ", at most " + three_decimals(otherwise) + " as LPS or RAS)";
      out_.wrong = "the mesh is a mirror image: it fits the labels only as " + std::string(m.text) + ", Dice " +
                   three_decimals(dice) + "; all else is judged in that frame";
      return true;
    }
    return false;
  }

  double overlap(const Frame& frame) const {
    return against_->meter ? against_->meter->measure(m_.surface, frame, 48).dice_of_all() : 0;
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
               m_.file.path + " and " + against_->input.path, hint);
  }

  void warn(Warning w) { report_.warnings.push_back(std::move(w)); }

  MeshToJudge& m_;
  const Against* against_;
  const std::string& mesh_space_;
  RunReport& report_;
  FrameFinding out_;
};

}  // namespace

FrameFinding take_frame(MeshToJudge& mesh, const Against* against, const std::string& mesh_space, RunReport& report) {
  return FrameFinder(mesh, against, mesh_space, report).run();
}

}  // namespace stackmesh
