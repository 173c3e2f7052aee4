#include "default_run.h"

#include <time.h>
#include <unistd.h>

#include <cstdio>
#include <map>

#include "base/error.h"
#include "base/monitor.h"
#include "run/mesh_run.h"

namespace stackmesh::testing_support {
namespace {

double thread_cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// A file in memory that goes with this object.
class NrrdInMemory {
 public:
  explicit NrrdInMemory(const LabelVolume& v) {
    static const char* const kFolder = ::access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
    path_ = std::string(kFolder) + "/stackmesh_random_XXXXXX.nrrd";
    const int file = ::mkstemps(path_.data(), 5);
    std::FILE* f = file < 0 ? nullptr : ::fdopen(file, "wb");
    if (f == nullptr) fail_internal("a file in memory cannot be made", path_);
    std::fprintf(
        f,
        "NRRD0004\ntype: uint16\nendian: little\ndimension: 3\nspace: left-posterior-superior\nsizes: %d %d %d\n"
        "space directions: (%.17g,0,0) (0,%.17g,0) (0,0,%.17g)\nspace origin: (0,0,0)\nencoding: raw\n\n",
        v.size[0], v.size[1], v.size[2], v.spacing_mm[0], v.spacing_mm[1], v.spacing_mm[2]);
    for (const std::uint16_t k : v.voxels) {
      const auto label = static_cast<std::uint16_t>(v.labels[k].number);
      std::fputc(label & 255, f), std::fputc(label >> 8, f);
    }
    std::fclose(f);
  }
  ~NrrdInMemory() { ::unlink(path_.c_str()); }
  NrrdInMemory(const NrrdInMemory&) = delete;
  NrrdInMemory& operator=(const NrrdInMemory&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace

DefaultRun run_at_defaults(const LabelVolume& volume, const std::string& worker) {
  const NrrdInMemory file(volume);
  MeshRunOptions o;  // as apps/stackmesh/mesh_command.cpp sets them
  o.mesh.target = worker.empty() ? Target::surface : Target::volume;
  o.command = worker.empty() ? "surface" : "mesh";
  o.input.paths = {file.path()};
  o.mesh.threads = o.mesh.sections.contours.threads = 1;
  o.mesh.enhance = true;
  o.mesh.enhance_up_to = 10000000;
  o.mesh.enhancement.usual_target = true;
  o.mesh.fill.worker_path = worker;
  o.mesh.fill.timeout_s = 60;
  o.strict = true;  // a fallback or a lost component is an error
  DefaultRun out;
  const double start = thread_cpu_s();
  Monitor quiet;
  try {
    out.report = run_mesh(o, quiet);
  } catch (const std::exception& e) {
    out.problem = e.what();
  }
  out.cpu_s = thread_cpu_s() - start;
  if (!out.problem.empty()) {
    if (const std::size_t at = out.problem.find(file.path()); at != std::string::npos)
      out.problem.replace(at, file.path().size(), "the stack");
    return out;
  }
  // What a strict run has let through, once more.
  const RunReport& r = out.report;
  const auto wrong = [&](const std::string& text) { out.problem += text + "; "; };
  if (r.surface_level != "enhanced") wrong("the surface is " + r.surface_level);
  if (!r.surface) return wrong("there is no surface"), out;
  if (r.surface->open_edges > 0) wrong(std::to_string(r.surface->open_edges) + " open edges");
  if (r.surface->self_intersections > 0) wrong(std::to_string(r.surface->self_intersections) + " crossings");
  if (!worker.empty() && r.closure != "verified") wrong("closure " + r.closure);
  std::map<Label, std::size_t> surface;
  for (const LabelSurface& l : r.surface->labels) {
    surface[l.label] = l.components;
    if (!l.closed) wrong("label " + std::to_string(l.label) + " is open");
  }
  for (std::size_t k = 1; k < volume.labels.size(); ++k) {
    bool there = false;
    for (const std::uint16_t v : volume.voxels) there = there || v == k;
    if (there && surface[volume.labels[k].number] == 0)
      wrong("label " + std::to_string(volume.labels[k].number) + " is gone");
  }
  return out;
}

}  // namespace stackmesh::testing_support
