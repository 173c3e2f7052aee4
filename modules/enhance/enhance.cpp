#include "enhance/enhance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/parallel.h"
#include "base/warning.h"
#include "enhance/expected_tets.h"
#include "enhance/remesh.h"
#include "enhance/ridges.h"
#include "enhance/separate.h"
#include "enhance/sizing.h"
#include "enhance/smoothing.h"
#include "enhance/surface_distance.h"

namespace stackmesh {
namespace {

constexpr double kTriangleLimit = 50e6;
// Without any size requested: tetrahedra of one label, for each further one, and at most.
constexpr std::size_t kUsualTets = 150000, kMoreTets = 50000, kMostTets = 1000000;
// The edges that come out scatter about 0.95 of what the remesher aims at.
constexpr double kAim = 1.05;
// Of the deviation that was requested: sizes are chosen for this share, so that few places reach the whole of it.
constexpr double kDeviationAim = 0.33;

constexpr std::size_t kSamples = 20000;   // of the stitched surface, to tell its distance
constexpr double kSmoothingCost = 0.031;  // pixels of mean distance for which the steps of single voxels go
// of the edge length: what sheets keep apart in the end, where small moves allow it
constexpr double kSheetGap = 0.2;
constexpr int kLowPasses = 3;      // of the low-pass on the remeshed surface, by default
constexpr double kSettled = 0.01;  // pixels: vertices that near the faired surface stay where they are
constexpr double kDrawnCorner_deg = 35;
// shares of the length requested, and of the surface, from which on shorter edges are told
constexpr double kMuchShorter = 0.7, kMuchOfIt = 0.1;
// the default deviation of smooth drawn outlines: so many bulges, at least that
constexpr double kDrawnBulges = 6, kDrawnDeviation_mm = 0.15;
constexpr double kLeastSmoothing = 1e-3;  // of the smoothing's limits, for outlines without any roughness
constexpr int kSmoothPasses = 5;          // of HC-Laplacian smoothing at most; its limits are reached by then

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}

class Enhancement {
 public:
  Enhancement(const InterfaceComplex& stitched, const EnhanceOptions& options, Monitor& progress)
      : stitched_(stitched), o_(options), progress_(progress) {}

  EnhanceResult run() {
    check();
    if (stitched_.triangles.empty()) {
      result_.complex = stitched_;
      return std::move(result_);
    }
    ComplexMesh mesh(stitched_, 4 * o_.pixel_mm * o_.pixel_mm, o_.threads, o_.inner_caps);
    volumes_ = label_volumes(mesh);
    for (auto& [label, v] : volumes_) {
      const auto wanted = o_.label_volume_mm3.find(label);
      if (wanted != o_.label_volume_mm3.end()) v = wanted->second;
    }
    shell_ = shell_sizes(mesh, &shells_);
    samples_ = sample_surface(mesh, kSamples);
    result_.complex = stitched_;
    result_.counts.ridge_edges = mark_ridges(mesh, ridges());
    wall_reach_ = std::max(2 * o_.pixel_mm, o_.edge_length_mm.value_or(6 * o_.pixel_mm));
    wall_ = wall_thickness(mesh, wall_reach_, o_.threads);
    if (o_.faired != nullptr) {
      faired_ = ComplexMesh(*o_.faired, 1e300, o_.threads);
      faired_bends_ = surface_bends(*faired_, o_.threads);
      reference_.emplace(mesh, reference_cell_mm(), o_.threads, &*faired_);
      bend_ = faired_places(mesh).bend;
    } else if (o_.smooth_passes > 0) {
      smooth_mesh(mesh);
    }
    progress_.advance(0.25);
    std::vector<Vec3> smoothed = mesh.points;  // smoothing only moves points
    if (o_.remesh) {
      remesh_mesh(mesh);
      if (stands(SurfaceLevel::enhanced, mesh)) {
        result_.complex = mesh.to_complex();
        result_.complex.space = stitched_.space;
        compare_volumes(mesh);
        progress_.advance(1);
        return std::move(result_);
      }
    }
    if (o_.faired != nullptr) {
      ComplexMesh fine(stitched_, 4 * o_.pixel_mm * o_.pixel_mm, o_.threads, o_.inner_caps);
      settle(fine);
      smoothed = std::move(fine.points);
    }
    if (o_.smooth_passes > 0 || o_.faired != nullptr) {
      InterfaceComplex moved = stitched_;
      moved.points = smoothed;
      if (stands(SurfaceLevel::smoothed, ComplexMesh(moved, 0, o_.threads))) result_.complex = std::move(moved);
    }
    progress_.advance(1);
    return std::move(result_);
  }

 private:
  void check() const {
    const auto positive = [](const std::optional<double>& x, const char* what) {
      if (x && !(*x > 0 && std::isfinite(*x)))
        fail_usage(std::string(what) + " must be a positive length in mm", number(*x), "give a larger one");
    };
    positive(o_.edge_length_mm, "edge length");
    positive(o_.deviation_mm, "deviation");
    positive(o_.edge_min_mm, "smallest edge length");
    positive(o_.edge_max_mm, "largest edge length");
    positive(o_.pixel_mm, "pixel");
    positive(o_.gap_mm, "gap between sections");
    for (const auto& [label, x] : o_.label_edge_mm)
      positive(x, ("edge length of label " + std::to_string(label)).c_str());
    if (!(o_.gradation > 1)) fail_usage("gradation must be above 1", number(o_.gradation), "1.3 is the default");
    if (o_.edge_min_mm && o_.edge_max_mm && *o_.edge_min_mm > *o_.edge_max_mm)
      fail_usage("the smallest edge length is above the largest",
                 number(*o_.edge_min_mm) + " > " + number(*o_.edge_max_mm), "swap them");
  }

  static std::string text(const ShellCount& c) {
    return std::to_string(c.outer) + " pieces and " + std::to_string(c.inward) + " holes";
  }

  void warn(Warning w) { result_.warnings.push_back(std::move(w)); }

  /// True when the whole surface is as sound as the stitched one, which an exact test of all its triangles says.
  bool stands(SurfaceLevel level, const ComplexMesh& mesh) {
    std::map<Label, ShellCount> shells;
    shell_sizes(mesh, &shells);
    const std::size_t contacts = count_contacts(mesh, o_.threads);
    if (contacts == 0 && shells == shells_) {
      result_.level = level;
      return true;
    }
    std::string why = std::to_string(contacts) + " triangles meet others";
    if (contacts == 0)
      for (const auto& [label, was] : shells_)
        if (const ShellCount is = shells[label]; !(is == was))
          why = "label " + std::to_string(label) + " went from " + text(was) + " to " + text(is);
    warn({WarningCode::not_enhanced, "", "the " + std::string(to_text(level)) + " surface was given up: " + why});
    return false;
  }

  RidgeOptions ridges() const {
    RidgeOptions r;
    r.feature_deg = o_.feature_deg;
    r.length_mm = 8 * std::max(o_.pixel_mm, o_.gap_mm);
    r.threads = o_.threads;
    if (!(o_.drawn_gap_mm > 0)) return r;
    r.upright_deg = kDrawnCorner_deg;
    r.upright_length_mm = 1.9 * o_.drawn_gap_mm;
    r.upright_reach_mm = 2 * o_.pixel_mm;
    return r;
  }

  void smooth_mesh(ComplexMesh& mesh) {
    SmoothingOptions s;
    s.passes = std::min(o_.smooth_passes, kSmoothPasses);
    s.limit_xy_mm = 0.33 * roughness() * o_.pixel_mm;
    s.limit_z_mm = 0.33 * roughness() * o_.gap_mm;
    s.keep.clearance_mm = 0.02 * std::min(o_.pixel_mm, o_.gap_mm);
    s.keep.sheet_angle_deg = o_.sheet_angle_deg;
    s.threads = o_.threads;
    // What is thin or small moves less: it has no volume to spare.
    for (std::size_t v = 0; v < wall_.size(); ++v)
      s.share.push_back(
          static_cast<float>(std::min({1.0, wall_[v] / (1.5 * o_.pixel_mm), shell_[v] / (4 * o_.pixel_mm)})));
    s.volumes = volumes_;
    s.volume_limit_mm = 0.2 * o_.pixel_mm;
    const SmoothingResult r = smooth(mesh, s);
    result_.counts.smoothed = r.moved;
    result_.counts.held_back = r.held_back;
  }

  double reference_cell_mm() const {
    const double step = std::max(0.5 * o_.pixel_mm, std::min(o_.pixel_mm, o_.gap_mm));
    return 1.5 * step;
  }

  /// The nearest places on the faired interfaces of all vertices that may go there, and how much the interfaces bend
  /// there.
  struct FairedPlaces {
    std::vector<Vec3> to;
    std::vector<double> bend;  ///< -1: not known
  };
  FairedPlaces faired_places(const ComplexMesh& mesh) const {
    const double reach = 2 * std::max(o_.pixel_mm, o_.gap_mm);
    FairedPlaces out{mesh.points, std::vector<double>(mesh.points.size(), -1)};
    for_each_index(out.to.size(), o_.threads, [&](std::size_t n) {
      const auto v = static_cast<std::int32_t>(n);
      if (mesh.star[v].empty() || mesh.is_fixed(v) || mesh.flat[v]) return;
      if (!mesh.curve[v].empty()) {
        if (const auto foot =
                reference_->nearest_on_curve(out.to[v], Reference::curve_key(mesh, v, mesh.curve[v][0]), reach))
          out.to[v] = *foot;
      } else if (const auto foot =
                     reference_->nearest(out.to[v], mesh.triangles[mesh.star[v][0]].patch, reach, -1, 0)) {
        out.to[v] = foot->point;
        if (!reference_->is_faired(foot->face)) return;
        out.bend[v] = 0;
        for (std::int32_t w : faired_->triangles[foot->triangle].v) out.bend[v] += faired_bends_[w] / 3;
      }
    });
    return out;
  }

  /// Draws the vertices to the faired interfaces.
  void settle(ComplexMesh& mesh) {
    std::vector<Vec3> to = faired_places(mesh).to;
    const double least = kSettled * std::min(o_.pixel_mm, o_.gap_mm);
    for (std::size_t v = 0; v < to.size(); ++v)
      if (norm(to[v] - mesh.points[v]) < least) to[v] = mesh.points[v];
    MoveLimits keep;
    keep.clearance_mm = 0.02 * std::min(o_.pixel_mm, o_.gap_mm);
    keep.sheet_angle_deg = o_.sheet_angle_deg;
    const SmoothingResult r = move_guarded(mesh, to, keep, o_.threads);
    result_.counts.smoothed = r.moved;
    result_.counts.held_back = r.held_back;
  }

  /// How much smoothing the surface is in need of: 1 where it has steps of pixels, or outlines as rough as those, near
  /// 0 for outlines that were drawn smoothly: there it would only move what was drawn.
  double roughness() const {
    const double share = std::min(1.0, kDrawnBulges * o_.drawn_bulge_mm / (0.5 * o_.pixel_mm));
    return o_.drawn_gap_mm > 0 ? std::max(kLeastSmoothing, share * share) : 1;
  }

  /// Smooth outlines are followed more closely than a pixel asks for: triangles that hold the drawn volume stand off
  /// its surface by two thirds of what their edges bulge.
  double usual_deviation_mm() const {
    if (o_.faired != nullptr) return 0.25 * o_.pixel_mm;
    const double half = 0.5 * o_.pixel_mm;
    return o_.drawn_gap_mm > 0 ? std::min(half, std::max(kDrawnBulges * o_.drawn_bulge_mm, kDrawnDeviation_mm)) : half;
  }

  SizingOptions sizing(const ComplexMesh& mesh) {
    SizingOptions s;
    s.threads = o_.threads;
    s.shell_mm = shell_;
    s.wall_mm = wall_;
    s.bend = bend_;
    s.wall_reach_mm = wall_reach_;
    s.gradation = o_.gradation;
    s.deviation_mm = kDeviationAim * o_.deviation_mm.value_or(usual_deviation_mm());
    if (o_.deviation_mm && *o_.deviation_mm < 0.25 * o_.pixel_mm)
      warn({WarningCode::edge_length, "",
            "a deviation of " + number(*o_.deviation_mm) + " mm is far below the pixel (" + number(o_.pixel_mm) +
                " mm): it follows the steps of the voxels"});
    // As edges grow with the root of their deviation, so does the smallest one.
    s.edge_min_mm = o_.edge_min_mm.value_or(
        std::max(1.0, 1.5 * (o_.drawn_gap_mm > 0 ? std::sqrt(usual_deviation_mm() / (0.5 * o_.pixel_mm)) : 1.0)) *
        o_.pixel_mm);
    std::map<Label, std::array<Vec3, 2>> boxes;
    for (const MeshTriangle& t : mesh.triangles) {
      const auto [below, above] = mesh.labels_of(t.patch);
      for (Label l : {below, above})
        for (std::int32_t v : t.v) {
          const Vec3& p = mesh.points[v];
          auto [it, fresh] = boxes.insert({l, {p, p}});
          Vec3 &a = it->second[0], &b = it->second[1];
          a = {std::min(a.x, p.x), std::min(a.y, p.y), std::min(a.z, p.z)};
          b = {std::max(b.x, p.x), std::max(b.y, p.y), std::max(b.z, p.z)};
        }
    }
    for (auto& [label, box] : boxes) {
      const Vec3 d = box[1] - box[0];
      const double longest = std::max({d.x, d.y, d.z});
      if (label == 0) continue;
      s.label_max_mm[label] = std::max(o_.edge_max_mm.value_or(longest / 10), s.edge_min_mm);
      const auto own = o_.label_edge_mm.find(label);
      const double asked = own != o_.label_edge_mm.end() ? own->second : o_.edge_length_mm.value_or(0);
      if (asked > longest / 3) {
        s.label_edge_mm[label] = kAim * longest / 3;
        warn(warning_at(WarningCode::edge_length, "label " + std::to_string(label),
                        "an edge length of " + number(asked) + " mm is too large for its " + number(longest) + " mm; " +
                            number(longest / 3) + " mm is used"));
      } else if (own != o_.label_edge_mm.end()) {
        s.label_edge_mm[label] = kAim * asked;
      }
    }
    if (o_.edge_length_mm) {
      s.edge_length_mm = kAim * *o_.edge_length_mm;
      s.edge_min_mm = std::min(0.5 * o_.pixel_mm, *s.edge_length_mm);
    }
    s.thin_min_mm = std::max(s.edge_min_mm, o_.pixel_mm);
    return s;
  }

  /// Longer edges where more tetrahedra than the target are expected; small closed pieces stay as they are.
  /// Shorter ones only for a target that was requested.
  /// @return the triangles that go with the target.
  double coarsen(const ComplexMesh& mesh, std::vector<double>& size) {
    const std::size_t target = o_.target_tets.value_or(
        std::min(kMostTets, kUsualTets + kMoreTets * (volumes_.empty() ? 0 : volumes_.size() - 1)));
    const double longer = expected_tets(mesh, size, volumes_).times_longer_for(static_cast<double>(target));
    const double triangles = expected_triangles(mesh, size) / (longer * longer);
    if (o_.target_tets && longer < 0.98) {
      result_.coarsened = longer;
      for (double& x : size) x *= longer;
    }
    if (longer > 1.02) {
      result_.coarsened = longer;
      for (std::size_t v = 0; v < size.size(); ++v)
        size[v] = std::min(longer * size[v], std::max(size[v], kOfShell * shell_[v]));
      warn({WarningCode::edge_length, "",
            "edges were made " + number(longer) + " times longer than the default, for a target of " +
                std::to_string(target) +
                " tetrahedra; --target-tets, --edge-length or --deviation ask for finer ones"});
    }
    return triangles;
  }

  /// Says on how much of the surface edges are much shorter than requested, and why.
  void say_where_shorter(const ComplexMesh& mesh, const std::vector<double>& size) {
    if (!o_.edge_length_mm) return;
    const double least = kMuchShorter * *o_.edge_length_mm;
    double all = 0, walls = 0, pieces = 0, bends = 0;
    for (const MeshTriangle& t : mesh.triangles) {
      const auto [below, above] = mesh.labels_of(t.patch);
      if (o_.label_edge_mm.count(below) + o_.label_edge_mm.count(above) > 0) continue;  // with lengths of their own
      const double third = norm(mesh.area_vector(t.v)) / 3;
      for (std::int32_t v : t.v) {
        all += third;
        if (size[v] >= least) continue;
        const double by_wall = wall_[v] < wall_reach_ ? kAcrossWall * wall_[v] : 1e300, by_piece = kOfShell * shell_[v];
        (std::min(by_wall, by_piece) >= least ? bends : by_wall < by_piece ? walls : pieces) += third;
      }
    }
    const double share = (walls + pieces + bends) / std::max(all, 1e-300);
    if (share < kMuchOfIt) return;
    std::string why;
    for (const auto& [part, what] :
         {std::pair{walls, "where walls are thin"}, {pieces, "on small pieces"}, {bends, "where it bends"}})
      if (part > 0.005 * all) why += (why.empty() ? "" : ", ") + number(std::round(100 * part / all)) + " % " + what;
    warn({WarningCode::edge_length, "",
          "edges are shorter than the " + number(*o_.edge_length_mm) + " mm requested on " +
              number(std::round(100 * share)) + " % of the surface (" + why +
              "), as longer ones would cut off too much there"});
  }

  void refuse_giants(double triangles) const {
    if (triangles > kTriangleLimit)
      fail_usage("the edge lengths requested mean about " + number(triangles / 1e6) +
                     " million triangles, more than the 50 million allowed",
                 o_.edge_length_mm ? "edge length " + number(*o_.edge_length_mm) + " mm" : "by curvature",
                 "ask for longer edges");
  }

  void remesh_mesh(ComplexMesh& mesh) {
    const SizingOptions sizes = sizing(mesh);
    std::vector<double> size = edge_sizes(mesh, sizes);
    say_where_shorter(mesh, size);
    RemeshOptions r;
    if ((o_.target_tets || o_.usual_target) && !o_.edge_length_mm) r.most_triangles = coarsen(mesh, size);
    const double triangles = expected_triangles(mesh, size);
    result_.expected_triangles = static_cast<std::size_t>(triangles);
    result_.expected_tets = static_cast<std::size_t>(expected_tets(mesh, size, volumes_).at(1));
    refuse_giants(triangles);
    if (!reference_) reference_.emplace(mesh, reference_cell_mm(), o_.threads);
    const Reference& reference = *reference_;
    r.sheet_angle_deg = o_.sheet_angle_deg;
    r.threads = o_.threads;
    // An edge length that was requested gives way only where something would be cut off.
    r.deviation_mm = o_.edge_length_mm ? std::max(0.5 * o_.pixel_mm, 0.4 * *o_.edge_length_mm)
                                       : result_.coarsened * result_.coarsened * sizes.deviation_mm;
    r.shortest_mm = std::min(1.0, result_.coarsened) * sizes.edge_min_mm;
    r.gradation = o_.gradation;
    if (o_.faired != nullptr) r.when_coarse = [&] { settle(mesh); };  // a coarse mesh has fewer vertices to move
    const RemeshCounts c = remesh(mesh, size, reference, r, progress_);
    result_.counts.splits = c.splits;
    result_.counts.collapses = c.collapses;
    result_.counts.flips = c.flips;
    result_.counts.relocations = c.relocations;
    result_.counts.refused_contact = c.refused_contact;
    result_.counts.refused_angle = c.refused_angle;
    result_.counts.refused_clearance = c.refused_clearance;
    MoveLimits keep;
    keep.size_mm = &size;
    keep.clearance_rel = r.clearance_rel;
    keep.sheet_angle_deg = o_.sheet_angle_deg;
    keep.corner_angle_deg = 28;
    soften(mesh, size, keep);
    draw_back(mesh, size, keep);
    separate_sheets(mesh, size, kSheetGap, keep, o_.threads);
    restore(mesh, keep);
  }

  /// On even triangles a low-pass takes away what the needles of the stitched surface kept of the voxels' steps. By
  /// default it may cost little distance: single steps go for that; of larger ones (of images with finer voxels than
  /// they were taken with) only a light pass takes some. What is requested beyond the default follows, whatever it
  /// costs, with limits of its own.
  void soften(ComplexMesh& mesh, const std::vector<double>& size, const MoveLimits& keep) {
    if (o_.smooth_passes == 0) return;
    SmoothingOptions s;
    s.limit_xy_mm = 0.5 * roughness() * o_.pixel_mm;
    s.limit_z_mm = 0.5 * roughness() * o_.gap_mm;
    for (double x : size) s.share.push_back(static_cast<float>(std::min(1.0, x / (4 * o_.pixel_mm))));
    s.keep = keep;
    s.threads = o_.threads;
    SmoothingOptions light = s;
    light.passes = 1;
    light.taubin_lambda = 0.3;
    light.taubin_mu = -0.31;
    s.passes = kLowPasses;
    s.taubin_lambda = 0.5;
    s.taubin_mu = -0.53;
    const std::vector<Vec3> to = smoothed_places(mesh, s);
    const double reach = 2 * std::max(o_.pixel_mm, o_.gap_mm);
    if (distance_gained(mesh, samples_, to, reach, o_.threads) > kSmoothingCost * o_.pixel_mm) smooth(mesh, light);
    else move_guarded(mesh, to, keep, o_.threads);
    if (o_.smooth_passes <= kSmoothPasses) return;
    s.passes = o_.smooth_passes - kSmoothPasses;
    smooth(mesh, s);
  }

  /// Brings the vertices of smooth drawn outlines back onto the surface that they stand for, from which the rounds of
  /// fitting and relocation let them drift; of rough outlines not, as that would undo the smoothing.
  void draw_back(ComplexMesh& mesh, const std::vector<double>& size, const MoveLimits& keep) {
    const double share = 1 - roughness();
    if (!(share > 0)) return;
    std::vector<Vec3> to = mesh.points;
    for_each_index(to.size(), o_.threads, [&](std::size_t n) {
      const auto v = static_cast<std::int32_t>(n);
      if (mesh.star[v].empty() || mesh.is_fixed(v)) return;
      Vec3 d;
      if (!mesh.curve[v].empty()) {
        if (const auto at =
                reference_->nearest_on_curve(to[v], Reference::curve_key(mesh, v, mesh.curve[v][0]), size[v]))
          d = *at - to[v];
      } else if (const auto foot = reference_->nearest(to[v], mesh.triangles[mesh.star[v][0]].patch, size[v], -1, 0)) {
        d = foot->point - to[v];
      }
      if (mesh.flat[v]) d.z = 0;
      to[v] = to[v] + share * d;
    });
    move_guarded(mesh, to, keep, o_.threads);
  }

  /// What remeshing and smoothing took from the labels' volumes comes back by small moves.
  void restore(ComplexMesh& mesh, const MoveLimits& keep) {
    double before = 1e300;
    for (int pass = 0; pass < 12; ++pass) {
      double worst = 0, sum = 0;
      for (const auto& [label, v] : label_volumes(mesh)) {
        const double off = std::abs(v / volumes_[label] - 1);
        worst = std::max(worst, off);
        sum += off;
      }
      if (worst < (o_.drawn_gap_mm > 0 ? 0.0005 : 0.002) || sum > 0.97 * before) break;
      before = sum;
      if (restore_volumes(mesh, volumes_, 0.1 * o_.pixel_mm, keep, o_.threads).moved == 0) break;
    }
  }

  void compare_volumes(const ComplexMesh& mesh) {
    for (const auto& [label, v] : label_volumes(mesh)) {
      const double change = v / volumes_[label] - 1;
      if (std::abs(change) > 0.05)
        warn(warning_at(WarningCode::volume_changed, "label " + std::to_string(label),
                        "its volume changed by " + number(100 * change) + " % of " + number(volumes_[label]) +
                            " mm3 in the enhancement (it is small or thin for the edge length)"));
    }
  }

  const InterfaceComplex& stitched_;
  const EnhanceOptions& o_;
  Monitor& progress_;
  EnhanceResult result_;
  std::map<Label, double> volumes_;  // to be kept
  std::vector<double> shell_;        // of each vertex of the stitched complex: size of its smallest closed shell
  std::vector<double> bend_;         // how much the faired interfaces bend there
  std::vector<double> wall_;         // and how thick its walls are there, up to the reach
  double wall_reach_ = 0;
  std::map<Label, ShellCount> shells_;  // of each label
  std::optional<ComplexMesh> faired_;   // where the interfaces run
  std::vector<double> faired_bends_;    // at its vertices
  std::optional<Reference> reference_;  // the surface that the remeshed one stands for
  SurfaceSamples samples_;              // of the stitched surface
};

}  // namespace

EnhanceResult enhance_complex(const InterfaceComplex& stitched, const EnhanceOptions& options, Monitor& progress) {
  return Enhancement(stitched, options, progress).run();
}

}  // namespace stackmesh
