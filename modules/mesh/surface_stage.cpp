#include <atomic>
#include <cmath>
#include <exception>
#include <utility>

#include "base/parallel.h"
#include "base/warning.h"
#include "mesh/stages.h"
#include "sections/drawn_detail.h"
#include "sections/far_sections.h"

namespace stackmesh {
namespace {

/// An edge length that is far too small is told before the surface is remeshed, which would take as long as it is
/// small.
void refuse_too_fine(const InterfaceComplex& surface, const MeshOptions& o) {
  if (o.target != Target::volume || !o.enhancement.edge_length_mm) return;
  const double edge = *o.enhancement.edge_length_mm, inner = 2 * edge;
  // of both sides; stitched steps have up to half as much again as the surface that comes of them
  double area = 0, volume = 0;
  for (const InterfaceTriangle& t : surface.triangles) {
    const Vec3 &a = surface.points[t.v[0]], &b = surface.points[t.v[1]], &c = surface.points[t.v[2]];
    area += ((t.below != 0) + (t.above != 0)) * 0.5 * norm(cross(b - a, c - a)) / 1.5;
    volume += ((t.below != 0) - (t.above != 0)) * dot(a, cross(b, c)) / 6;
  }
  refuse_too_many(1.5 * area / (0.433 * edge * edge) + std::abs(volume) / (0.12 * inner * inner * inner), o);
}

/// Whether the surface is kept as stitched, although enhancement is wanted.
bool is_too_large(const StitchedStage& stitched, const Call& call) {
  const MeshOptions& o = call.options;
  if (!stitched.far_apart.empty() && o.enhance_up_to) {
    call.warnings.push_back({WarningCode::not_enhanced, "",
                             stitched.far_apart + ": the surface is kept as stitched; look at spacing and heights"});
    return true;
  }
  if (!o.enhance_up_to || stitched.complex.triangles.size() <= *o.enhance_up_to) return false;
  call.warnings.push_back({WarningCode::not_enhanced, "",
                           "the stitched surface has " + std::to_string(stitched.complex.triangles.size()) +
                               " triangles, more than are enhanced by default (it would take minutes): it is kept as "
                               "stitched; ask for enhancement with --edge-length "
                               "or --deviation, or reduce it with --interpolate or --simplify"});
  return true;
}

EnhanceOptions enhance_options(const StitchedStage& stitched, const MeshOptions& o) {
  EnhanceOptions options = o.enhancement;
  options.pixel_mm = stitched.pixel_mm;
  options.gap_mm = stitched.gap_mm;
  if (!stitched.faired.triangles.empty()) {
    options.faired = &stitched.faired;
    // An organ that ends inside of the image ends as its faired surface does, unless flat ends were requested.
    options.inner_caps = o.stitch.caps == Caps::flat || !o.stitch.label_caps.empty();
  }
  options.drawn_gap_mm = stitched.drawn_gap_mm;
  options.drawn_bulge_mm = stitched.drawn_bulge_mm;
  options.threads = o.threads;
  options.label_volume_mm3.insert(stitched.volume_mm3.begin(), stitched.volume_mm3.end());
  return options;
}

bool accepts(const Judgement& enhanced, const SurfaceCheck& before) {
  return enhanced.is_sound() && enhanced.check.labels.size() == before.labels.size();
}

void warn_of_changes(const SurfaceCheck& before, const SurfaceCheck& after, std::vector<Warning>& warnings) {
  for (const LabelSurface& b : before.labels)
    for (const LabelSurface& a : after.labels)
      if (a.label == b.label && (a.euler != b.euler || a.components != b.components))
        warnings.push_back(warning_at(WarningCode::topology_changed, "label " + std::to_string(a.label),
                                      "enhancement changed its Euler number from " + std::to_string(b.euler) + " to " +
                                          std::to_string(a.euler) + " and its pieces from " +
                                          std::to_string(b.components) + " to " + std::to_string(a.components)));
}

/// A surface is checked beside the stage that goes on with it, whose result counts only after the check.
class CheckBeside {
 public:
  CheckBeside(const Call& call, const Frame& frame) : call_(call), frame_(frame) {}
  void begin(const InterfaceComplex& surface, bool at_once, int threads,
             std::function<void(const Judgement&)> then = {}) {
    call_.clock.begin_beside(
        "validate",
        [this, &surface, threads, then = std::move(then)] {
          judged_ = judge(surface, frame_, threads);
          if (then) then(judged_);
        },
        at_once);
  }
  Judgement finish() {
    call_.clock.run("validate", [&] { call_.clock.finish_beside(); });
    return std::move(judged_);
  }

 private:
  const Call& call_;
  const Frame& frame_;
  Judgement judged_;
};

std::exception_ptr error_of(const std::function<void()>& work) {
  try {
    work();
  } catch (...) {
    return std::current_exception();
  }
  return nullptr;
}

SurfaceStage enhance(StitchedStage stitched, const Call& call) {
  const MeshOptions& o = call.options;
  const bool two = thread_count(o.threads) > 1, fills = o.target == Target::volume;
  SurfaceStage out;
  CheckBeside beside(call, stitched.frame);
  EnhanceResult result;
  beside.begin(stitched.complex, two, 1);
  std::exception_ptr error;
  call.clock.run("enhance", [&] {
    error = error_of([&] { result = enhance_complex(stitched.complex, enhance_options(stitched, o), call.monitor); });
    stitched.faired = {};
  });
  out.judged = beside.finish();
  out.stitched_check = out.judged.check;
  if (!out.judged.is_sound()) {  // no one may enhance it
    out.complex = std::move(stitched.complex);
    return out;
  }
  if (error) std::rethrow_exception(error);
  for (const Warning& w : result.warnings) call.warnings.push_back(w);
  out.complex = std::move(result.complex);
  out.level = result.level;

  std::atomic<bool> unsound{false};
  beside.begin(out.complex, fills && two, fills ? 1 : o.threads,
               [&](const Judgement& j) { unsound = !accepts(j, out.stitched_check); });
  if (fills) call.clock.run("volume", [&] { error = error_of([&] { fill_stage(out, call, &unsound); }); });
  Judgement enhanced = beside.finish();
  if (!accepts(enhanced, out.stitched_check)) {
    call.warnings.push_back({WarningCode::not_enhanced, "",
                             "the enhanced surface did not pass the exact checks (" +
                                 std::to_string(enhanced.check.open_edges) + " open edges, " +
                                 std::to_string(enhanced.check.self_intersections) +
                                 " self-intersections): the stitched surface is used"});
    out.complex = std::move(stitched.complex);
    out.level = SurfaceLevel::stitched;
    out.filled.reset();
    out.layers.reset();
  } else {
    if (error) std::rethrow_exception(error);
    out.judged = std::move(enhanced);
  }
  if (out.level != SurfaceLevel::enhanced)
    out.lost_detail = std::string("the surface is ") + to_text(out.level) + ", not enhanced";
  warn_of_changes(out.stitched_check, out.judged.check, call.warnings);
  return out;
}

}  // namespace

StitchedStage stitch_stage(SectionStage sections, LabelMesh& out, const Call& call) {
  StitchOptions options = call.options.stitch;
  options.threads = call.options.threads;
  StitchedStage s;
  StitchResult result = stitch_sections(std::move(sections.stack), options, call.monitor);
  for (const Warning& w : result.warnings) call.warnings.push_back(w);
  s.complex = std::move(result.complex);
  s.faired = std::move(sections.faired);
  s.volume_mm3 = std::move(sections.volume_mm3);
  s.far_apart = std::move(sections.far_apart);
  if (sections.drawn) keep_pieces(s.complex, call.options.pieces, call.warnings);
  const Stack& stack = result.stack;
  s.frame = stack.frame;
  out.stitched.added_points = result.added_points;
  out.stitched.vertices = s.complex.points.size();
  out.stitched.triangles = s.complex.triangles.size();
  out.stitched.caps = std::move(result.caps);
  s.pixel_mm = stack.pixel_mm;
  const std::size_t n = stack.sections.size();
  s.gap_mm = n > 1 ? (stack.sections[n - 1].z_mm - stack.sections[0].z_mm) / static_cast<double>(n - 1) : s.pixel_mm;
  if (sections.drawn) {
    s.drawn_gap_mm = drawn_gap_mm(stack);
    s.drawn_bulge_mm = drawn_bulge_mm(stack);
    s.far_apart = far_sections(stack, s.complex);
    if (call.options.keep_judged) s.stack = std::move(result.stack);
  }
  return s;
}

SurfaceStage surface_stage(StitchedStage stitched, const Call& call) {
  SurfaceStage out;
  if (call.options.enhance) {
    if (!is_too_large(stitched, call)) {
      refuse_too_fine(stitched.complex, call.options);
      return enhance(std::move(stitched), call);
    }
    out.lost_detail = "the surface is stitched, not enhanced";
  }
  call.clock.run("validate", [&] { out.judged = judge(stitched.complex, stitched.frame, call.options.threads); });
  out.stitched_check = out.judged.check;
  out.complex = std::move(stitched.complex);
  return out;
}

}  // namespace stackmesh
