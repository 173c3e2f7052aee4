#include "run/solve_with_calculix.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "base/atomic_file.h"
#include "base/cancel.h"
#include "base/error.h"
#include "base/text.h"
#include "meshio/read_frd.h"

extern char** environ;

namespace stackmesh {
namespace {

struct Folder {
  std::string path;
  Folder() {
    path = (std::filesystem::temp_directory_path() / "stackmesh_ccx_XXXXXX").string();
    if (::mkdtemp(path.data()) == nullptr)
      fail_output("no folder for the solver can be made", path, "set TMPDIR to a folder that you may write to");
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
};

[[noreturn]] void fail(const std::string& what, const std::string& folder) {
  std::ifstream log(folder + "/log");
  std::string last;
  for (std::string line; std::getline(log, line);) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    if (line.find("*ERROR") != std::string::npos) {
      last = line;
      break;
    }
    last = line;
  }
  throw Error(ErrorKind::no_result, "CalculiX " + what + (last.empty() ? "" : ": " + printable(last)), "--accuracy",
              "write the deck without --accuracy and look at what ccx says of it");
}

/// Its exit status, or -1 where it was ended.
int run(const std::string& folder, int threads, double timeout_s) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, (folder + "/log").c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  std::vector<std::string> variables;
  for (char** v = environ; *v != nullptr; ++v)
    if (std::string(*v).rfind("OMP_NUM_THREADS=", 0) != 0) variables.push_back(*v);
  variables.push_back(
      "OMP_NUM_THREADS=" +
      std::to_string(std::max(1, threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency()))));
  std::vector<char*> environment, arguments;
  for (std::string& v : variables) environment.push_back(v.data());
  environment.push_back(nullptr);
  std::string words[] = {"ccx", "-i", "model"};
  for (std::string& w : words) arguments.push_back(w.data());
  arguments.push_back(nullptr);
  pid_t child = -1;
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;  // a caller may have blocked signals on this thread
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  const int failed = posix_spawnp(&child, "ccx", &actions, &attributes, arguments.data(), environment.data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) fail("could not be started", folder);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    const Monitor* const monitor = cancelling_monitor();
    const bool cancelled = monitor != nullptr && monitor->cancelled();
    if (cancelled || std::chrono::steady_clock::now() > end) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
      stop_if_cancelled();
      return -1;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 255;
}

}  // namespace

bool has_calculix() {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    if (!folder.empty() && ::access((folder + "/ccx").c_str(), X_OK) == 0) return true;
  return false;
}

std::vector<Vec3> solve_with_calculix(const SolverModel& model, const MeshWriteOptions& write, int threads,
                                      double timeout_s) {
  const Folder folder;
  {
    AtomicFiles files;
    write_model(files, folder.path + "/model.inp", model, write);
    files.commit();
  }
  const int status = run(folder.path, threads, timeout_s);
  if (status < 0)
    fail("took longer than the " + std::to_string(static_cast<int>(timeout_s)) + " s of --timeout", folder.path);
  if (status != 0 || !std::filesystem::exists(folder.path + "/model.frd")) fail("found no solution", folder.path);
  const FrdResult result = read_frd(folder.path + "/model.frd");
  const auto field = result.fields.find("DISP");
  if (field == result.fields.end()) fail("wrote no displacements", folder.path);
  std::vector<Vec3> displacement(model.mesh.points.size());
  for (std::size_t i = 0; i < result.numbers.size(); ++i) {
    const std::int64_t node = result.numbers[i] - 1;
    if (node < 0 || node >= static_cast<std::int64_t>(displacement.size())) continue;  // of rigid points and springs
    const auto& u = field->second[i];
    displacement[node] = {u[0], u[1], u[2]};
  }
  return displacement;
}

}  // namespace stackmesh
