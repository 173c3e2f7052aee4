#include "run/provenance.h"

#include <glob.h>
#include <sys/sysinfo.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <thread>

#include "base/sha256.h"
#include "base/text.h"

namespace stackmesh {
namespace {

namespace fs = std::filesystem;

/// The value of `key` in the lines of a text file's head: "ElementDataFile = x.raw", "data file: x.raw".
std::string header_value(const std::string& path, const std::string& key) {
  std::ifstream file(path, std::ios::binary);
  std::string line;
  for (int n = 0; n < 200 && std::getline(file, line); ++n) {
    if (line.rfind(key, 0) != 0) continue;
    const std::size_t from = line.find_first_not_of(" \t=:", key.size());
    if (from == std::string::npos) return "";
    line.erase(line.find_last_not_of(" \t\r") + 1);
    return line.substr(from);
  }
  return "";
}

void add_files(const std::string& given, std::vector<std::string>& files) {
  std::error_code none;
  std::string path = given;
  const std::size_t equals = path.find('=');
  if (!fs::exists(path, none) && equals != std::string::npos && fs::exists(path.substr(equals + 1), none))
    path = path.substr(equals + 1);
  if (fs::is_regular_file(path, none)) {
    files.push_back(path);
    const std::string key = ends_with(path, ".mhd") ? "ElementDataFile" : ends_with(path, ".nhdr") ? "data file" : "";
    const std::string data = key.empty() ? "" : header_value(path, key);
    const std::string beside = data.empty() ? "" : (fs::path(path).parent_path() / data).string();
    if (!beside.empty() && fs::is_regular_file(beside, none)) files.push_back(beside);
  } else if (fs::is_directory(path, none)) {
    for (fs::recursive_directory_iterator it(path, none), end; !none && it != end; it.increment(none))
      if (it->is_regular_file(none)) files.push_back(it->path().string());
  } else {
    glob_t found;
    if (::glob(path.c_str(), 0, nullptr, &found) == 0)
      for (std::size_t i = 0; i < found.gl_pathc; ++i)
        if (fs::is_regular_file(found.gl_pathv[i], none)) files.push_back(found.gl_pathv[i]);
    ::globfree(&found);
  }
}

std::string first_value(const char* path, const std::string& key) {
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line)) {
    if (line.rfind(key, 0) != 0) continue;
    std::size_t from = line.find_first_of(":=");
    if (from == std::string::npos) continue;
    line = line.substr(from + 1);
    line.erase(0, line.find_first_not_of(" \t\""));
    line.erase(line.find_last_not_of(" \t\"") + 1);
    return line;
  }
  return "";
}

}  // namespace

InputDigest digest_of_input(const std::vector<std::string>& input_paths) {
  std::vector<std::string> files;
  for (const std::string& path : input_paths) add_files(path, files);
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  InputDigest digest;
  digest.files = files.size();
  if (files.size() == 1) {
    digest.sha256 = sha256_of_file(files[0]);
  } else if (!files.empty()) {
    Sha256 sum;
    for (const std::string& f : files) sum.add(sha256_of_file(f) + "  " + fs::path(f).filename().string() + "\n");
    digest.sha256 = sum.hex();
  }
  return digest;
}

Provenance find_provenance(const std::vector<std::string>& input_paths) {
  Provenance p;
  const InputDigest input = digest_of_input(input_paths);
  p.input_sha256 = input.sha256;
  p.input_files = input.files;
  p.program_sha256 = sha256_of_file("/proc/self/exe");
#if defined(__clang__)
  p.compiler = "clang " __clang_version__;
#else
  p.compiler = "g++ " __VERSION__;
#endif
  p.build_type = STACKMESH_BUILD_TYPE;
  p.processor = first_value("/proc/cpuinfo", "model name");
  p.system = first_value("/etc/os-release", "PRETTY_NAME");
  p.cores = static_cast<int>(std::thread::hardware_concurrency());
  struct sysinfo info;
  if (::sysinfo(&info) == 0)
    p.memory_gib = std::round(static_cast<double>(info.totalram) * info.mem_unit / (1 << 30) * 10) / 10;
  const std::time_t now = std::time(nullptr);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
  p.finished_utc = text;
  return p;
}

}  // namespace stackmesh
