#include "volume/fill_volume.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <map>
#include <mutex>
#include <set>

#include "base/error.h"
#include "base/parallel.h"
#include "base/warning.h"
#include "volume/compact.h"
#include "volume/improve_tets.h"
#include "volume/label_tets.h"
#include "volume/relax_surface.h"
#include "volume/tetgen_call.h"
#include "volume/tetgen_words.h"
#include "volume/worker_process.h"
#include "volume/worker_protocol.h"

namespace stackmesh {
namespace {

using Status = FillResult::Status;
using Call = volume::TetgenCall;
using volume::Compact;
using worker::Clock;
using worker::Reply;

void check_input(const InterfaceComplex& complex, const FillOptions& options) {
  const auto count = static_cast<std::int64_t>(complex.points.size());
  for (std::size_t i = 0; i < complex.triangles.size(); ++i) {
    for (const std::int32_t v : complex.triangles[i].v) {
      const std::string where = "triangle " + std::to_string(i);
      if (v < 0 || v >= count) fail_internal("a surface triangle names a point that does not exist", where);
      const Vec3& p = complex.points[v];
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
        fail_internal("a surface point is not finite", where);
    }
  }
  const auto positive = [](const std::optional<double>& v, const char* name) {
    if (v && !(std::isfinite(*v) && *v > 0))
      fail_usage("a mesh size or quality is not positive", name, "give a value above 0");
  };
  positive(options.max_volume_mm3, "max-volume");
  for (const auto& [label, mm3] : options.label_max_volume_mm3) positive(mm3, "max-volume");
  positive(options.radius_edge, "radius-edge");
  positive(options.dihedral_deg, "dihedral");
  positive(options.inner_growth, "inner growth");
  positive(options.improve_deg, "dihedral");
  if (std::isnan(options.timeout_s)) fail_usage("the time limit is not a number", "timeout", "give seconds");
}

/// For tets with dihedral angles below it, points of the surface may move.
constexpr double kRelaxDeg = 20;

/// Labels that are filled together, on their own.
struct Group {
  std::set<Label> labels;
  std::optional<double> max_volume_mm3;
};

class Filler {
 public:
  Filler(const InterfaceComplex& complex, const FillOptions& options)
      : complex_(complex),
        options_(options),
        program_{options.worker_path, options.worker_args},
        deadline_(Clock::now() +
                  std::chrono::microseconds(static_cast<std::int64_t>(1e6 * std::clamp(options.timeout_s, 0.0, 1e9)))) {
  }

  FillResult run() {
    FillResult result = run_attempts();
    result.warnings = std::move(warnings_);
    return result;
  }

 private:
  FillResult run_attempts() {
    if (complex_.triangles.empty())
      return failure(Status::empty, "there is nothing to fill: the surface has no triangles");
    if (std::all_of(complex_.triangles.begin(), complex_.triangles.end(),
                    [](const InterfaceTriangle& t) { return t.below == 0 && t.above == 0; }))
      return failure(Status::empty, "there is nothing to fill: the surface bounds no label");
    input_ = volume::compact(complex_);
    volume::Finding finding = volume::check_closed({complex_.points, input_.welded});
    if (!finding.message.empty()) return failure(Status::refused, finding.message, std::move(finding.triangles));

    if (is_flat()) return failure(Status::refused, "the surface encloses nothing: it lies in one plane");

    const double scale = volume::z_scale_for_aspect(complex_);
    const bool wants_refinement = options_.radius_edge || options_.dihedral_deg || options_.max_volume_mm3 ||
                                  options_.inner_growth || !options_.label_max_volume_mm3.empty();
    // What comes first must leave time for the plain filling of the whole.
    const auto budget = std::chrono::duration_cast<Clock::duration>((deadline_ - Clock::now()) * 0.6);
    const Clock::time_point until = std::min(deadline_, Clock::now() + budget);
    std::string before;  // what was tried and failed, for the message
    bool refinement_pays = wants_refinement;
    if (wants_refinement || options_.improve_deg) {  // both take time: in groups, side by side
      if (const std::vector<Group> own = groups(); !own.empty()) {
        FillResult result = attempt({wants_refinement, "", scale}, until, own);
        if (result.status == Status::verified || killed_) return result;
        retry_is_useless_ = false;  // the whole says why
        // another mesh than it gives elsewhere
        if (result.status == Status::crashed || result.status == Status::timed_out) before = result.message;
        if (!options_.label_max_volume_mm3.empty())
          before = result.message + ", so labels have no volume bound of their own";
      }
    }
    if (wants_refinement) {
      FillResult result = attempt({true, "", scale}, until);
      if (result.status == Status::verified) return with_note(std::move(result), before);
      if (retry_is_useless_) return result;
      refinement_pays = result.status != Status::timed_out;
      before = result.message;
    }
    FillResult result = attempt({false, "", scale}, deadline_);
    if (result.status == Status::verified) return with_note(std::move(result), before);
    if (retry_is_useless_ || result.status == Status::timed_out) return result;

    FillResult first = std::move(result);
    if (!options_.known_sound && search(first)) return first;
    for (const Call& next :
         {Call{false, "", scale / 4}, Call{false, "", scale, 1}, Call{false, "", scale, 2}, Call{false, "", 4 * scale},
          Call{false, "", scale / 4, 1}, Call{false, "", scale / 4, 2}, Call{false, "", 4 * scale, 1},
          Call{false, "T1e-12", scale}, Call{false, "T1e-16", scale}, Call{false, "T1e-12", 4 * scale}}) {
      if (Clock::now() >= deadline_) break;
      result = attempt(next, deadline_);
      if (killed_) return result;
      if (result.status != Status::verified) continue;
      const std::string note = before.empty() ? first.message : before;
      if (refinement_pays) {
        FillResult refined = attempt({true, next.tolerance, next.z_scale, next.turns}, deadline_);
        if (refined.status == Status::verified) return with_note(std::move(refined), note);
      }
      return with_note(std::move(result), note);
    }
    return first;
  }

  static FillResult failure(Status status, std::string message, std::vector<std::int32_t> triangles = {}) {
    FillResult result;
    result.status = status;
    result.message = std::move(message);
    result.offending_triangles = std::move(triangles);
    return result;
  }

  static FillResult with_note(FillResult result, const std::string& before) {
    result.fallback = before;
    return result;
  }

  bool is_flat() const {
    Vec3 low = input_.points.front(), high = low;
    for (const Vec3& p : input_.points) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    return low.x == high.x || low.y == high.y || low.z == high.z;
  }

  /// By their own bounds on volume; else two, where that is faster. Empty: all labels at once.
  std::vector<Group> groups() const {
    std::map<std::optional<double>, std::set<Label>> by_bound;
    for (const InterfaceTriangle& t : input_.welded)
      for (const Label l : {t.below, t.above})
        if (l != 0) {
          const auto own = options_.label_max_volume_mm3.find(l);
          by_bound[own == options_.label_max_volume_mm3.end() ? options_.max_volume_mm3 : own->second].insert(l);
        }
    std::vector<Group> out;
    for (auto& [bound, labels] : by_bound) out.push_back({std::move(labels), bound});
    if (out.size() > 1 || out[0].max_volume_mm3 != options_.max_volume_mm3) return out;
    out.clear();
    for (std::set<Label>& half : volume::halves(input_)) out.push_back({std::move(half), options_.max_volume_mm3});
    return out;
  }

  Reply call_worker(const std::string& switches, const Call& call, bool sized, const Compact& part,
                    Clock::time_point deadline) {
    std::vector<Vec3> moved;
    const bool as_is = call.z_scale == 1 && call.turns == 0;
    if (!as_is) {
      moved = part.points;
      for (Vec3& p : moved) p = volume::turned({p.x, p.y, p.z * call.z_scale}, call.turns);
    }
    std::vector<double> edges;
    if (sized) edges = volume::inner_sizes(part, *options_.inner_growth);
    const worker::Request request{switches, as_is ? &part.points : &moved, edges.empty() ? nullptr : &edges,
                                  &part.corners};
    Reply reply = worker::run(program_, request, deadline, options_.given_up);
    if (!reply.killed) return reply;
    // Someone else ended it (an operator, the kernel for want of memory): the same call again, so that the mesh is the
    // same or none.
    const std::string how = reply.text;
    reply = worker::run(program_, request, deadline, options_.given_up);
    const std::lock_guard<std::mutex> lock(warnings_mutex_);
    if (reply.killed) retry_is_useless_ = killed_ = true;
    else warnings_.push_back({WarningCode::mesher, "", "the volume mesher was started again, as " + how});
    return reply;
  }

  FillResult attempt(const Call& call, Clock::time_point deadline) {
    const std::string name = volume::describe(call, volume::switches(call, options_, options_.max_volume_mm3));
    TetMesh mesh;
    FillResult failed = fill(call, input_, options_.max_volume_mm3, deadline, name, mesh);
    return failed.message.empty() ? assemble(std::move(mesh), name) : failed;
  }

  /// The labels of each group on their own, side by side.
  FillResult attempt(const Call& call, Clock::time_point deadline, const std::vector<Group>& own) {
    const std::string name = volume::describe(call, volume::switches(call, options_, own[0].max_volume_mm3)) + " in " +
                             std::to_string(own.size()) + " parts";
    std::vector<TetMesh> meshes(own.size());
    std::vector<FillResult> failed(own.size());
    parallel_for(own.size(), options_.threads, [&](std::size_t i) {
      failed[i] = fill(call, volume::part_of(input_, own[i].labels), own[i].max_volume_mm3, deadline, name, meshes[i]);
    });
    for (FillResult& f : failed)
      if (!f.message.empty()) return std::move(f);
    TetMesh mesh = std::move(meshes[0]);
    for (std::size_t i = 1; i < meshes.size(); ++i) {
      const auto known = static_cast<std::int32_t>(complex_.points.size()),
                 offset = static_cast<std::int32_t>(mesh.points.size()) - known;
      mesh.points.insert(mesh.points.end(), meshes[i].points.begin() + known, meshes[i].points.end());
      for (std::array<std::int32_t, 4> t : meshes[i].tets) {
        for (std::int32_t& v : t)
          if (v >= known) v += offset;
        mesh.tets.push_back(t);
      }
      mesh.labels.insert(mesh.labels.end(), meshes[i].labels.begin(), meshes[i].labels.end());
    }
    mesh.faces = input_.welded;
    // Parts that are whole for themselves may not fit (a triangle of one lay within another's tets, once): then all
    // labels are filled at once.
    if (volume::Finding finding = volume::check_filled(mesh, options_.threads); !finding.message.empty())
      return failure(Status::refused, name + ": " + finding.message, std::move(finding.triangles));
    return assemble(std::move(mesh), name);
  }

  /// Tets of a part's labels, checked against its triangles; the complex's points come first. A failure has a message.
  FillResult fill(const Call& call, const Compact& part, const std::optional<double>& max_volume_mm3,
                  Clock::time_point deadline, const std::string& name, TetMesh& mesh) {
    const auto start = Clock::now();
    Reply reply = call_worker(volume::switches(call, options_, max_volume_mm3) + "Jn", call,
                              volume::has_sizes(call, options_, max_volume_mm3), part, deadline);
    switch (reply.kind) {
      case Reply::Kind::not_a_worker:
        retry_is_useless_ = true;
        return failure(Status::crashed, reply.text);
      case Reply::Kind::timed_out: {
        const double s = std::chrono::duration<double>(Clock::now() - start).count();
        char text[32];
        std::snprintf(text, sizeof text, "%.3g", s);
        return failure(Status::timed_out, name + " was ended after " + text + " s");
      }
      case Reply::Kind::gave_up:
      case Reply::Kind::died: {
        const std::string why = volume::complaint(reply.text);
        FillResult result = why.empty() ? failure(Status::crashed, name + " died" + reason(reply))
                                        : failure(Status::refused, name + " refused the surface: " + why);
        result.offending_triangles = volume::named_triangles(reply.text, input_);
        return result;
      }
      case Reply::Kind::done:
        break;
    }
    if (reply.tets.empty()) return failure(Status::empty, name + " succeeded without a single tetrahedron");
    mesh.points = complex_.points;
    mesh.faces = part.welded;
    const auto known = static_cast<std::int32_t>(part.points.size());
    const auto offset = static_cast<std::int32_t>(complex_.points.size()) - known;
    for (const Vec3& added : reply.added_points) {
      const Vec3 p = volume::turned(added, (3 - call.turns) % 3);
      mesh.points.push_back({p.x, p.y, p.z / call.z_scale});
    }
    for (std::int32_t& v : reply.tets)
      if (v >= 0) v = v < known ? part.original[v] : v + offset;
    volume::Finding finding = volume::label_tets({std::move(reply.tets), std::move(reply.neighbours)}, mesh);
    if (!finding.message.empty()) {
      retry_is_useless_ = finding.of_input;
      return failure(Status::refused, name + ": " + finding.message, std::move(finding.triangles));
    }
    if (mesh.tets.empty()) return failure(Status::empty, name + " left no tetrahedron of any label");
    drop_unused(mesh);
    return {};
  }

  static std::string reason(const Reply& reply) {
    const bool ours = reply.text.compare(0, 10, "the worker") == 0;
    return ours ? ": " + reply.text : " without saying why";
  }

  /// Improves the tets and compares each label's volume with that of its surface.
  FillResult assemble(TetMesh mesh, const std::string& name) const {
    mesh.space = complex_.space;
    FillResult result;
    std::string improved;
    if (options_.improve_deg) {
      const std::size_t before = mesh.tets.size();
      volume::ImproveOptions improve;
      improve.goal_deg = *options_.improve_deg;
      volume::ImproveCounts counts;
      improve.threads = options_.threads;
      improve.deadline = deadline_;
      volume::improve_tets(mesh, complex_.points.size(), improve, counts);
      result.moved_points = volume::relax_surface(mesh, complex_.points.size(), std::min(improve.goal_deg, kRelaxDeg),
                                                  options_.outside_is_empty);
      const volume::Finding finding = volume::check_filled(mesh, options_.threads);
      if (!finding.message.empty()) fail_internal("the improved tets are invalid: " + finding.message, name);
      improved = ", improved from " + std::to_string(before);
    }

    double worst = 0;
    const auto expected = volume::surface_volumes({mesh.points, mesh.faces});
    const auto filled = volume::tet_volumes(mesh);
    std::set<Label> labels;
    for (const auto& [label, v] : expected) labels.insert(label);
    for (const auto& [label, v] : filled) labels.insert(label);
    for (const Label label : labels) {
      const auto e = expected.find(label), f = filled.find(label);
      const volume::Volume a = e == expected.end() ? volume::Volume{} : e->second;
      const volume::Volume b = f == filled.end() ? volume::Volume{} : f->second;
      const double larger = std::max(std::abs(a.mm3), std::abs(b.mm3));
      const double off = std::max(0.0, std::abs(a.mm3 - b.mm3) - 1e-13 * (a.terms + b.terms));
      if (off > 1e-6 * larger)
        return failure(Status::volume_mismatch, name + ": label " + std::to_string(label) + " encloses " +
                                                    volume::number(a.mm3) + " mm3 but was filled with " +
                                                    volume::number(b.mm3));
      if (larger > 0) worst = std::max(worst, off / larger);
    }

    result.status = Status::verified;
    const std::size_t added = mesh.points.size() - complex_.points.size();
    result.message = name + ": " + std::to_string(mesh.tets.size()) + " tetrahedra" + improved + ", " +
                     std::to_string(added) + " points added inside";
    if (worst > 1e-9) result.message += ", volumes within " + volume::number(worst) + " of the surface's";
    result.mesh = std::move(mesh);
    return result;
  }

  // Added points of no tet (they served the background only).
  void drop_unused(TetMesh& mesh) const {
    const std::size_t known = complex_.points.size();
    std::vector<std::int32_t> to(mesh.points.size() - known, -1);
    for (const auto& tet : mesh.tets)
      for (const std::int32_t v : tet)
        if (static_cast<std::size_t>(v) >= known) to[static_cast<std::size_t>(v) - known] = 0;
    std::size_t count = known;
    for (std::size_t i = 0; i < to.size(); ++i) {
      if (to[i] < 0) continue;
      to[i] = static_cast<std::int32_t>(count);
      mesh.points[count++] = mesh.points[known + i];
    }
    mesh.points.resize(count);
    for (auto& tet : mesh.tets)
      for (std::int32_t& v : tet)
        if (static_cast<std::size_t>(v) >= known) v = to[static_cast<std::size_t>(v) - known];
  }

  /// Asks TetGen (-d) for the triangles that intersect; true when it found some, now in `refusal`.
  bool search(FillResult& refusal) {
    const Reply reply = call_worker("pdMJ", Call{}, false, input_, deadline_);
    std::set<std::int32_t> found;
    if (reply.kind == Reply::Kind::done) {
      const auto count = static_cast<std::int32_t>(complex_.triangles.size());
      for (const std::int32_t i : reply.faces)
        if (i >= 0 && i < count) found.insert(i);
    } else {
      const auto named = volume::named_triangles(reply.text, input_);
      refusal.offending_triangles.insert(refusal.offending_triangles.end(), named.begin(), named.end());
      std::sort(refusal.offending_triangles.begin(), refusal.offending_triangles.end());
      refusal.offending_triangles.erase(
          std::unique(refusal.offending_triangles.begin(), refusal.offending_triangles.end()),
          refusal.offending_triangles.end());
    }
    if (found.empty()) return false;
    refusal.status = Status::refused;
    refusal.offending_triangles.assign(found.begin(), found.end());
    refusal.message += "; " + std::to_string(found.size()) + " surface triangles intersect";
    return true;
  }

  const InterfaceComplex& complex_;
  const FillOptions& options_;
  worker::Program program_;
  Clock::time_point deadline_;
  Compact input_;
  std::vector<Warning> warnings_;
  std::mutex warnings_mutex_;
  std::atomic<bool> killed_{false};            // twice in a row
  std::atomic<bool> retry_is_useless_{false};  // no worker to be had, or an invalid complex: trying again is no use
};

}  // namespace

FillResult fill_volume(const InterfaceComplex& complex, const FillOptions& options) {
  check_input(complex, options);
  return Filler(complex, options).run();
}

}  // namespace stackmesh
