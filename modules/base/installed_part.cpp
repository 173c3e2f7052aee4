#include "base/installed_part.h"

#include <dlfcn.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>
#include <system_error>
#include <vector>

#include "base/error.h"

namespace stackmesh {
namespace {

namespace fs = std::filesystem;

/// The file that holds this code: a shared library, or the program itself.
fs::path own_file() {
  Dl_info info{};
  if (::dladdr(reinterpret_cast<const void*>(&find_installed), &info) == 0 || info.dli_fname == nullptr) return {};
  std::error_code ignored;
  return fs::canonical(info.dli_fname, ignored);
}

constexpr const char* again =
    "install stackmesh again as a whole, or let STACKMESH_PARTS name the folder that holds it";

void* load(const std::string& part, const std::string& purpose) {
  const std::string name = part + ".so";
  const char* const folder = std::getenv("STACKMESH_PARTS");
  const std::string path =
      folder != nullptr && *folder != '\0' ? (fs::path(folder) / name).string() : find_installed(name, R_OK);
  const auto fail = [&](const std::string& why) {
    throw Error(ErrorKind::no_result, "the part of stackmesh for " + purpose + " " + why, path.empty() ? name : path,
                again);
  };
  if (path.empty() || ::access(path.c_str(), R_OK) != 0) fail("is not installed");
  void* const handle = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    const char* const text = ::dlerror();
    std::string why = text != nullptr ? text : "unknown reason";
    if (why.compare(0, path.size() + 2, path + ": ") == 0) why.erase(0, path.size() + 2);  // the error names it anyway
    fail("cannot be loaded (" + why + ")");
  }
  using Version = const char* (*)();
  const auto version = reinterpret_cast<Version>(::dlsym(handle, "stackmesh_part_version"));
  if (version == nullptr || std::string(version()) != STACKMESH_PART_VERSION) {
    ::dlclose(handle);
    fail("belongs to another version than " STACKMESH_PART_VERSION);
  }
  return handle;
}

}  // namespace

std::string find_installed(const std::string& name, int mode) {
  std::error_code ignored;
  std::vector<fs::path> places;
  for (const fs::path& file : {own_file(), fs::path(fs::read_symlink("/proc/self/exe", ignored))}) {
    if (file.empty()) continue;
    places.push_back(file.parent_path() / name);
    places.push_back(file.parent_path().parent_path() / "libexec/stackmesh" / name);
  }
  places.push_back(fs::path(STACKMESH_LIBEXEC) / name);
  for (const fs::path& p : places)
    if (::access(p.c_str(), mode) == 0) return p;
  return "";
}

void* function_of_part(const std::string& part, const char* function, const std::string& purpose) {
  static std::mutex mutex;
  static std::map<std::string, void*> loaded;
  const std::lock_guard<std::mutex> lock(mutex);
  auto it = loaded.find(part);
  if (it == loaded.end()) it = loaded.emplace(part, load(part, purpose)).first;
  void* const found = ::dlsym(it->second, function);
  if (found == nullptr)
    throw Error(ErrorKind::no_result, "the part of stackmesh for " + purpose + " lacks " + function, part + ".so",
                again);
  return found;
}

}  // namespace stackmesh
