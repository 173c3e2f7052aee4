#include "validate/verdict.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace stackmesh {
namespace {

std::string text_of(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

std::string counted(std::size_t n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

Status above(double value, double warn, double fail) {
  return value > fail ? Status::fail : value > warn ? Status::warn : Status::pass;
}
Status below(double value, double warn, double fail) {
  return value < fail ? Status::fail : value < warn ? Status::warn : Status::pass;
}
Status above(double value, const std::optional<double>& warn, const std::optional<double>& fail) {
  return fail && value > *fail ? Status::fail : warn && value > *warn ? Status::warn : Status::pass;
}
void worsen(Status& status, Status other) {
  status = std::max(status, other);
}

class Judge {
 public:
  Judge(const JudgeInput& input, const Limits& limits) : in_(input), l_(limits) {}

  std::vector<Verdict> run() {
    if (in_.surface) closed(), intersections();
    if (in_.volume && in_.volume->tets + in_.volume->wedges > 0) orientation(), conforming();
    if (in_.topology) topology();
    if (in_.fidelity && !in_.fidelity->empty()) components(), volume(), position(), fidelity();
    if (in_.bends && in_.bends->surface.edges > 0) roughness();
    if (in_.surface) quality();
    if (in_.thickness && !in_.thickness->empty()) thickness();
    return std::move(verdicts_);
  }

 private:
  Verdict& add(const char* id, const char* title, bool validity = false) {
    Verdict v;
    v.id = id, v.title = title, v.validity = validity;
    verdicts_.push_back(std::move(v));
    return verdicts_.back();
  }

  std::string name(Label label) const {
    for (const LabelInfo& i : in_.labels)
      if (i.number == label && !i.name.empty()) return "label " + std::to_string(label) + " (" + i.name + ")";
    return "label " + std::to_string(label);
  }

  void closed() {
    const SurfaceCheck& s = *in_.surface;
    Verdict& v = add("closed", "Closed", true);
    v.figure = counted(s.open_edges, "open edge", "open edges");
    v.limit = "none allowed";
    v.status = s.open_edges > 0 ? Status::fail : Status::pass;
    for (const LabelSurface& label : s.labels)
      if (!label.closed) v.labels.push_back(label.label);
    v.explanation =
        v.labels.empty()
            ? "Every edge of every label's surface is met from both sides, so each label encloses a volume."
            : "Edges at which a label's surface ends, or its triangles face against each other: " + list(v.labels) +
                  ".";
  }

  std::string list(const std::vector<Label>& labels) const {
    std::string text;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (i == 5) return text + " and " + std::to_string(labels.size() - 5) + " more";
      text += (i ? ", " : "") + name(labels[i]);
    }
    return text;
  }

  void intersections() {
    const SurfaceCheck& s = *in_.surface;
    Verdict& v = add("intersections", "Free of intersections", true);
    const std::size_t pairs = s.self_intersections - s.degenerate_triangles;
    v.figure = counted(pairs, "crossing pair", "crossing pairs");
    if (s.degenerate_triangles > 0)
      v.figure += ", " + counted(s.degenerate_triangles, "triangle without area", "triangles without area");
    v.limit = "none allowed";
    v.status = s.self_intersections > 0 ? Status::fail : Status::pass;
    v.explanation = v.status == Status::pass
                        ? "No two triangles meet but in the corners and edges they share (exact arithmetic)."
                        : "Triangles meet where they share no corner or edge, or have no area (exact arithmetic).";
  }

  void orientation() {
    Verdict& v = add("orientation", "No inverted tetrahedra", true);
    v.figure = std::to_string(in_.volume->inverted) + " of " + counted(in_.volume->tets, "tetrahedron", "tetrahedra");
    if (const std::size_t wedges = in_.volume->wedges + in_.volume->pyramids; wedges > 0)
      v.figure += " and " + counted(wedges, "wedge", "wedges");
    v.limit = "none allowed";
    v.status = in_.volume->inverted > 0 ? Status::fail : Status::pass;
    v.explanation = v.status == Status::pass
                        ? "Every tetrahedron has a positive volume (exact arithmetic)."
                        : "These have no volume or a negative one (exact arithmetic): a solver will stop at them.";
  }

  void conforming() {
    Verdict& v = add("conforming", "Conforming", true);
    v.figure = counted(in_.volume->nonconforming_faces, "face", "faces") + " that do not conform";
    if (in_.volume->order == 2) v.figure += ", " + counted(in_.volume->nonconforming_edges, "edge", "edges");
    v.limit = "none allowed";
    v.status = in_.volume->conforms ? Status::pass : Status::fail;
    v.explanation =
        v.status == Status::pass
            ? "Neighbouring tetrahedra share whole faces, and the faces between labels are the surface's triangles."
            : "Faces shared by more than two tetrahedra, or whose labels differ from the surface's.";
  }

  void topology() {
    Verdict& v = add("topology", "Topology of the slices");
    long surplus = 0, most = 0, loose_pieces = 0;
    Label most_label = 0;
    for (const LabelTopology& t : *in_.topology) {
      const bool loose = in_.fidelity == nullptr && t.pieces > t.implied_pieces && t.implied_pieces > 0;
      if (t.surplus() == 0 && !loose) continue;
      surplus += t.surplus();
      if (loose) loose_pieces += t.pieces - t.implied_pieces;
      v.labels.push_back(t.label);
      worsen(v.status, Status::warn);
      v.explanation += " " + name(t.label) + ":";
      if (t.surplus() > 0)
        v.explanation += " " + counted(static_cast<std::size_t>(t.handles), "handle", "handles") +
                         " where the slices imply at most " + std::to_string(t.implied_handles) + ";";
      if (loose)
        v.explanation += " " + counted(static_cast<std::size_t>(t.pieces), "piece", "pieces") +
                         " where the slices imply " + std::to_string(t.implied_pieces) + ";";
      if (t.surplus() > most) most = t.surplus(), most_label = t.label;
    }
    if (l_.handles_fail > 0 && surplus >= static_cast<long>(l_.handles_fail)) v.status = Status::fail;
    v.figure = counted(static_cast<std::size_t>(surplus), "handle too many", "handles too many");
    if (loose_pieces > 0)
      v.figure += ", " + counted(static_cast<std::size_t>(loose_pieces), "piece too many", "pieces too many");
    if (most_label != 0 && v.labels.size() > 1) v.figure += ", most in " + name(most_label);
    v.limit = l_.handles_fail > 0 ? "warn above 0, fail from " + std::to_string(l_.handles_fail) : "warn above 0";
    v.explanation =
        "Tunnels and loops of each label that no slice has: what lies inside an outline goes on in the next slice "
        "where it overlaps it." +
        v.explanation;
    if (v.explanation.back() == ';') v.explanation.back() = '.';
  }

  const LabelSurface* surface_of(Label label) const {
    if (in_.surface)
      for (const LabelSurface& s : in_.surface->labels)
        if (s.label == label) return &s;
    return nullptr;
  }

  void components() {
    Verdict& v = add("components", "All components there");
    std::size_t missing = 0, parts = 0, shrunk = 0;
    for (const LabelFidelity& f : *in_.fidelity) {
      missing += f.missing_components;
      parts += static_cast<std::size_t>(f.input_components);
      shrunk += f.shrunk_components;
      const bool lost = f.missing_components > 0;
      if (!lost && f.components_match) continue;
      v.labels.push_back(f.label);
      worsen(v.status, lost ? Status::fail : Status::warn);
    }
    v.figure = missing > 0 ? std::to_string(missing) + " of " + counted(parts, "component", "components") + " missing"
               : v.labels.empty()
                   ? counted(parts, "component", "components") + ", one to one"
                   : "none missing; " + counted(v.labels.size(), "label does", "labels do") + " not match one to one";
    if (shrunk > 0) v.figure += " (" + std::to_string(shrunk) + " so small that they cover no voxel centre)";
    v.limit = "none missing; one to one, else a warning";
    v.explanation = v.labels.empty()
                        ? "Every part of a label in the slices (voxels joined over faces) is one part of the mesh."
                        : "Parts are lost, joined, split or added in " + list(v.labels) + ".";
  }

  bool is_small(const LabelFidelity& f) const { return f.input_voxels < l_.small_label_voxels; }

  /// Sorts the labels by how far they are off, and caps small ones at a warning.
  struct Row {
    Label label;
    Status status;
    double badness;
  };
  void take(Verdict& v, std::vector<Row>& rows) {
    std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.badness > b.badness; });
    for (const Row& r : rows) {
      worsen(v.status, r.status);
      if (r.status != Status::pass) v.labels.push_back(r.label);
    }
  }

  void volume() {
    Verdict& v = add("volume", "Volume kept");
    std::vector<Row> rows;
    std::vector<Label> open;
    double worst = 0, sum_mesh = 0, sum_input = 0;
    Label worst_label = 0;
    for (std::size_t i = 0; i < in_.labels.size() && i < in_.input_volume_mm3.size(); ++i) {
      const LabelSurface* s = surface_of(in_.labels[i].number);
      const double input = in_.input_volume_mm3[i], mesh = s ? s->volume_mm3 : 0;
      if (!(input > 0)) continue;
      if (s && !s->closed) {
        open.push_back(in_.labels[i].number);
        continue;
      }
      sum_mesh += mesh, sum_input += input;
      const double error = mesh / input - 1;
      if (worst_label == 0 || std::abs(error) > std::abs(worst)) worst = error, worst_label = in_.labels[i].number;
      Status status = above(std::abs(error), l_.volume_warn_rel, l_.volume_fail_rel);
      for (const LabelFidelity& f : *in_.fidelity)
        if (f.label == in_.labels[i].number && is_small(f)) status = std::min(status, Status::warn);
      rows.push_back({in_.labels[i].number, status, std::abs(error)});
    }
    take(v, rows);
    const double total = sum_input > 0 ? sum_mesh / sum_input - 1 : 0;
    v.figure = rows.size() == 1 ? text_of("%+.2f %%", 100 * worst)
                                : text_of("%+.2f %% in all", 100 * total) + text_of("; worst %+.2f %%, ", 100 * worst) +
                                      name(worst_label);
    v.limit =
        text_of("warn above %g %%", 100 * l_.volume_warn_rel) + text_of(", fail above %g %%", 100 * l_.volume_fail_rel);
    v.explanation = "Volume enclosed by each label's surface against that of its voxels." + blame(v.labels);
    if (open.empty()) return;
    if (rows.empty()) v.figure = "not defined: the surface is open";
    worsen(v.status, Status::warn);
    v.explanation += " An open surface encloses none: " + list(open) + ".";
    v.labels.insert(v.labels.end(), open.begin(), open.end());
  }

  std::string blame(const std::vector<Label>& labels) const {
    return labels.empty() ? "" : " Outside: " + list(labels) + ".";
  }

  /// The whole mesh's shift: per axis, the median of the labels' shifts, by voxels.
  void position() {
    double shift[3] = {0, 0, 0};
    bool known = false;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<std::pair<double, double>> all;
      double total = 0;
      for (const LabelFidelity& f : *in_.fidelity) {
        if (!f.offset_voxels) continue;
        const double weight = static_cast<double>(f.input_voxels);
        all.push_back({axis == 0 ? f.offset_voxels->x : axis == 1 ? f.offset_voxels->y : f.offset_voxels->z, weight});
        total += weight;
      }
      std::sort(all.begin(), all.end());
      double passed = 0;
      for (const auto& [value, weight] : all) {
        passed += weight;
        if (passed < 0.5 * total) continue;
        shift[axis] = value, known = true;
        break;
      }
    }
    if (!known) return;
    const double worst = std::max({std::abs(shift[0]), std::abs(shift[1]), std::abs(shift[2])});
    Verdict& v = add("position", "In place");
    v.status = above(worst, l_.position_warn_px, l_.position_fail_px);
    v.figure =
        text_of("shifted by (%+.2f, ", shift[0]) + text_of("%+.2f, ", shift[1]) + text_of("%+.2f) voxels", shift[2]);
    v.limit = text_of("warn above %g", l_.position_warn_px) +
              text_of(", fail above %g voxels along an axis", l_.position_fail_px);
    v.explanation =
        "Rigid shift along the volume's axes that fits the mesh best to the voxels' faces. A half or whole voxel tells "
        "of a program "
        "that counts from corners instead of centres.";
  }

  void thickness() {
    Verdict& v = add("thickness", "Thick enough");
    std::vector<Row> rows;
    double worst = 0;
    Label worst_label = 0;
    for (const LabelThickness& t : *in_.thickness) {
      if (t.thin_share > worst) worst = t.thin_share, worst_label = t.label;
      rows.push_back({t.label, above(t.thin_share, l_.thin_warn_share, 2), t.thin_share});
    }
    take(v, rows);
    v.figure = text_of("%.1f %% of the surface thinner than", 100 * worst) + text_of(" %g elements", l_.thin_elements);
    if (worst_label != 0 && rows.size() > 1) v.figure += ", " + name(worst_label);
    v.limit = text_of("warn above %g %%", 100 * l_.thin_warn_share);
    v.explanation =
        "Share of a label's surface with fewer elements through its thickness: bending is too stiff there with linear "
        "elements." +
        blame(v.labels);
  }

  void fidelity() {
    Verdict& v = add("fidelity", "Fidelity");
    std::vector<Row> rows;
    double dice = 2, wrong = 0, band_mean = 0, band_max = 0, outside = 0, mean = 0, p95 = 0, most = 0;
    bool measured = false;
    for (const LabelFidelity& f : *in_.fidelity) {
      if (f.input_voxels == 0) continue;
      const double own_dice = std::isnan(f.dice) ? 0 : f.dice;
      Status status = below(own_dice, l_.dice_warn, l_.dice_fail);
      worsen(status, above(f.wrong_centres_share, l_.wrong_centres_warn_share, l_.wrong_centres_fail_share));
      double badness = f.wrong_centres_share;
      dice = std::min(dice, own_dice), wrong = std::max(wrong, f.wrong_centres_share);
      const BandDistance& band = f.band_distance_mm;
      if (!std::isnan(band.mean) && in_.voxel_mm > 0) {
        measured = true;
        const double m = band.mean / in_.voxel_mm, x = band.max / in_.voxel_mm;
        band_mean = std::max(band_mean, m), band_max = std::max(band_max, x),
        outside = std::max(outside, band.outside_share);
        worsen(status, above(m, l_.band_mean_warn_px, l_.band_mean_fail_px));
        worsen(status, above(x, l_.band_max_warn_px, l_.band_max_fail_px));
        badness += m;
      }
      const auto distance = [&](const Distance& d, double unit) {
        if (std::isnan(d.mean) || !(unit > 0)) return;
        mean = std::max(mean, d.mean / unit), p95 = std::max(p95, d.p95 / unit), most = std::max(most, d.max / unit);
        worsen(status, above(d.mean / unit, l_.mean_distance_warn_px, l_.mean_distance_fail_px));
        worsen(status, above(d.p95 / unit, l_.p95_distance_warn_px, l_.p95_distance_fail_px));
        worsen(status, above(d.max / unit, l_.max_distance_warn_px, l_.max_distance_fail_px));
      };
      distance(f.distance_mm, in_.pixel_mm);
      distance(f.reverse_distance_mm, in_.voxel_mm);
      if (is_small(f)) status = std::min(status, Status::warn);
      rows.push_back({f.label, status, badness});
    }
    take(v, rows);
    v.figure = text_of("Dice %.4f", dice > 1 ? 0 : dice) + text_of(", %.2f %% of voxel centres wrong", 100 * wrong);
    if (measured)
      v.figure += text_of("; outside the band by %.3f on average", band_mean) +
                  text_of(", at most %.2f voxels", band_max) + text_of(" (%.1f %% of the surface)", 100 * outside);
    v.limit = text_of("Dice %g", l_.dice_warn) + text_of(" (fail %g)", l_.dice_fail) +
              text_of("; wrong %g", 100 * l_.wrong_centres_warn_share) +
              text_of(" (%g) %%", 100 * l_.wrong_centres_fail_share) + text_of("; band mean %g", l_.band_mean_warn_px) +
              text_of(" (%g)", l_.band_mean_fail_px) + text_of(", largest %g", l_.band_max_warn_px) +
              text_of(" (%g) voxels", l_.band_max_fail_px);
    const auto asked = [&](const char* name, const char* figure, double value, const std::optional<double>& warn,
                           const std::optional<double>& fail) {
      if (!warn && !fail) return;
      v.figure += text_of(figure, value);
      v.limit += std::string("; ") + name + (warn ? text_of(" %g", *warn) : "") +
                 (fail ? text_of(" (%g)", *fail) : "") + " px";
    };
    asked("to faces, mean", "; to voxel faces %.2f px on average", mean, l_.mean_distance_warn_px,
          l_.mean_distance_fail_px);
    asked("to faces, 95 %", "; 95 %% within %.2f px", p95, l_.p95_distance_warn_px, l_.p95_distance_fail_px);
    asked("to faces, largest", "; at most %.2f px", most, l_.max_distance_warn_px, l_.max_distance_fail_px);
    v.explanation =
        "Worst label: voxel centres that are in the wrong label, and how far the surface leaves the cells between "
        "voxel centres of different labels" +
        text_of(" (voxels of %.3g mm).", in_.voxel_mm) +
        " A surface that parts the centres as the labels do has none of both, be it stepped or smooth." +
        blame(v.labels);
  }

  void roughness() {
    Verdict& v = add("roughness", "Smooth");
    std::vector<Row> rows;
    double worst = 0;
    Label worst_label = 0;
    for (const LabelBends& b : in_.bends->labels) {
      if (b.bends.edges == 0) continue;
      if (worst_label == 0 || b.bends.above_40_share > worst) worst = b.bends.above_40_share, worst_label = b.label;
      rows.push_back({b.label, above(b.bends.above_40_share, l_.bends_warn_share, 2.0), b.bends.above_40_share});
    }
    take(v, rows);
    v.figure = text_of("mean bend %.1f degrees", in_.bends->surface.mean_deg) +
               text_of("; %.1f %% of the edges bend by more than 40", 100 * worst);
    if (worst_label != 0 && rows.size() > 1) v.figure += ", " + name(worst_label);
    v.limit = text_of("warn above %g %%", 100 * l_.bends_warn_share);
    v.explanation =
        "Angles between neighbouring triangles of a label's surface: steps of voxels make many sharp ones, and "
        "stresses there are those of the steps." +
        blame(v.labels);
  }

  void quality() {
    const SurfaceCheck& s = *in_.surface;
    Verdict& v = add("quality", "Element quality");
    v.status = below(s.angle_min_deg, l_.angle_warn_deg, l_.angle_fail_deg);
    v.figure = text_of("smallest angle %.2f", s.angle_min_deg) + text_of(" (1 %%: %.1f) degrees", s.angle_p1_deg);
    v.limit = text_of("angle %g", l_.angle_warn_deg) + text_of(" (fail %g)", l_.angle_fail_deg);
    v.explanation = "Smallest angle of the surface's triangles";
    if (in_.volume && in_.volume->tets > 0) {
      const VolumeCheck& t = *in_.volume;
      worsen(v.status, below(t.dihedral_min_deg, l_.dihedral_warn_deg, l_.dihedral_fail_deg));
      worsen(v.status, above(t.dihedral_max_deg, l_.dihedral_max_warn_deg, l_.dihedral_max_fail_deg));
      worsen(v.status, below(t.scaled_jacobian_min, l_.jacobian_warn, l_.jacobian_fail));
      v.figure += text_of("; dihedrals %.2f", t.dihedral_min_deg) + text_of(" to %.2f", t.dihedral_max_deg) +
                  text_of("; scaled Jacobian %.3f", t.scaled_jacobian_min);
      v.limit += text_of("; dihedral %g", l_.dihedral_warn_deg) + text_of(" (%g)", l_.dihedral_fail_deg) +
                 text_of(" to %g", l_.dihedral_max_warn_deg) + text_of(" (%g)", l_.dihedral_max_fail_deg) +
                 text_of("; Jacobian %g", l_.jacobian_warn) + text_of(" (%g)", l_.jacobian_fail);
      v.explanation += ", smallest and largest dihedral angle and smallest scaled Jacobian of the tetrahedra";
    }
    v.explanation += ".";
  }

  const JudgeInput& in_;
  const Limits& l_;
  std::vector<Verdict> verdicts_;
};

}  // namespace

const char* to_text(Status status) {
  return status == Status::pass ? "pass" : status == Status::warn ? "warn" : "fail";
}

std::vector<Verdict> judge(const JudgeInput& input, const Limits& limits) {
  return Judge(input, limits).run();
}

Status overall(const std::vector<Verdict>& verdicts) {
  Status worst = Status::pass;
  for (const Verdict& v : verdicts) worst = std::max(worst, v.status);
  return worst;
}

int exit_code(const std::vector<Verdict>& verdicts) {
  int code = 0;
  for (const Verdict& v : verdicts)
    if (v.status == Status::fail) code = v.validity || code == 4 ? 4 : 6;
  return code;
}

}  // namespace stackmesh
