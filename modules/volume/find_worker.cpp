#include "volume/find_worker.h"

#include <dlfcn.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <vector>

namespace stackmesh::worker {
namespace {

namespace fs = std::filesystem;

/// The file that holds this code: a shared library, or the program itself.
fs::path own_file() {
  Dl_info info{};
  if (::dladdr(reinterpret_cast<const void*>(&find_worker), &info) == 0 || info.dli_fname == nullptr) return {};
  std::error_code ignored;
  return fs::canonical(info.dli_fname, ignored);
}

}  // namespace

std::string find_worker() {
  if (const char* set = std::getenv("STACKMESH_WORKER"); set != nullptr && *set != '\0') return set;
  std::error_code ignored;
  std::vector<fs::path> places;
  for (const fs::path& file : {own_file(), fs::path(fs::read_symlink("/proc/self/exe", ignored))}) {
    if (file.empty()) continue;
    places.push_back(file.parent_path() / "stackmesh-tetgen");
    places.push_back(file.parent_path().parent_path() / "libexec/stackmesh/stackmesh-tetgen");
  }
  places.push_back(STACKMESH_LIBEXEC "/stackmesh-tetgen");
  for (const fs::path& p : places)
    if (::access(p.c_str(), X_OK) == 0) return p;
  return "";
}

}  // namespace stackmesh::worker
