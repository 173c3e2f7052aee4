#include "run/output_files.h"

#include <filesystem>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "meshio/write_mesh.h"
#include "run/mesh_run.h"
#include "run/report_names.h"

namespace stackmesh {
namespace {

namespace fs = std::filesystem;

bool is_one_file(const std::string& a, const std::string& b) {
  std::error_code error;
  if (a.empty() || b.empty()) return false;
  if (fs::equivalent(a, b, error) && !error) return true;  // through links, too
  const auto whole = [&](const std::string& path) {
    return fs::weakly_canonical(fs::absolute(behind_links(path), error), error);
  };
  const fs::path p = whole(a), q = whole(b);
  return !error && p == q;
}

/// The file of "LABEL=FILE", unless a file of the whole name is there.
std::string file_of(const std::string& input) {
  std::error_code ignored;
  const std::size_t equal = input.find('=');
  return equal == std::string::npos || input.find('/') < equal || fs::exists(input, ignored) ? input
                                                                                             : input.substr(equal + 1);
}

}  // namespace

void check_output_files(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      if (is_one_file(outputs[i], outputs[j]))
        fail_usage("two outputs are one file", "'" + outputs[j] + "' and '" + outputs[i] + "'",
                   "give each a name of its own");
    for (const std::string& input : inputs)
      if (is_one_file(outputs[i], file_of(input)))
        fail_usage("an output would replace an input", "'" + outputs[i] + "'", "give the output a name of its own");
  }
  for (const std::string& path : outputs) {
    AtomicFiles::check(path);
    require_writer(path);
  }
}

void check_mesh_outputs(const MeshRunOptions& o) {
  for (const std::string& path : o.outputs) {
    const bool surface = is_surface_format(path), volume = is_volume_format(path);
    if (!surface && !(volume && o.mesh.target == Target::volume))
      fail_usage(volume ? "a surface cannot be written to a volume format" : "unknown ending of an output",
                 "'" + path + "'",
                 o.mesh.target == Target::volume
                     ? "choose .vtu .msh .inp .feb .bdf .vtk .mesh, or for the surface .stl .ply .obj .off .vtp"
                     : "choose .stl .ply .obj .off .vtp");
    if (o.mesh.order == 2 && ends_with(path, ".mesh"))
      fail_usage("second-order tetrahedra are not written to Medit's .mesh", "'" + path + "' with --order 2",
                 "choose .vtu .msh .inp .feb .bdf or .vtk");
  }
  check_report_names(o.reports);
  if (o.space != "lps" && o.space != "ras")
    fail_usage("unknown space '" + o.space + "'", "--space", "choose lps or ras");
  std::vector<std::string> all = o.outputs, inputs = o.input.paths;
  all.insert(all.end(), o.reports.begin(), o.reports.end());
  all.insert(all.end(), o.names_outputs.begin(), o.names_outputs.end());
  inputs.push_back(o.input.names);
  check_output_files(all, inputs);
}

}  // namespace stackmesh
