#include "base/atomic_file.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <cstring>

#include "base/error.h"

namespace stackmesh {
namespace {

[[noreturn]] void fail(const std::string& path, int code) {
  const bool full = code == ENOSPC || code == EDQUOT || code == EFBIG;
  const char* mend = full                   ? "free some space or choose another folder"
                     : code == ENOENT       ? "create the folder or choose another one"
                     : code == EISDIR       ? "name a file, not a folder"
                     : code == ENAMETOOLONG ? "choose a shorter name"
                     : code == EACCES || code == EPERM || code == EROFS
                         ? "choose a folder and file that you may write to"
                         : "choose another folder";
  fail_output(std::string("cannot write: ") + std::strerror(code), path, mend);
}

// ---- what a signal's handler removes: no allocation, no lock ----

constexpr int kSlots = 4096;
std::array<std::atomic<char*>, kSlots> unfinished{};

int remember(const std::string& path) {
  char* const copy = ::strdup(path.c_str());
  for (int i = 0; copy != nullptr && i < kSlots; ++i) {
    char* none = nullptr;
    if (unfinished[i].compare_exchange_strong(none, copy)) return i;
  }
  std::free(copy);
  return -1;
}

/// The copy is left: a handler may be reading it.
void forget(int slot) {
  if (slot >= 0) unfinished[slot].store(nullptr);
}

void remove_and_end(int signal) {
  remove_unfinished_files();
  ::raise(signal);  // by default, as SA_RESETHAND has set it
}

/// A new file beside `path`, named so that no other run and no other file of this run has it.
int create_beside(const std::string& path, std::string& temporary) {
  for (int n = 0;; ++n) {
    temporary = path + ".part" + std::to_string(::getpid()) + "-" + std::to_string(n);
    const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0 || errno != EEXIST) return descriptor;
  }
}

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  return slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
}

/// "PID-N" behind "NAME.part": the process; 0 where it is something else.
long process_of(const std::string& rest) {
  const std::size_t dash = rest.find('-');
  if (dash == 0 || dash == std::string::npos || dash + 1 == rest.size() || dash > 10) return 0;
  if (rest.find_first_not_of("0123456789") != dash ||
      rest.find_first_not_of("0123456789", dash + 1) != std::string::npos)
    return 0;
  return std::atol(rest.c_str());
}

/// Removes what runs that have ended left beside `path`.
void remove_left_over(const std::string& path) {
  const std::string folder = folder_of(path), name = path.substr(path.find_last_of('/') + 1) + ".part";
  DIR* const list = ::opendir(folder.c_str());
  if (list == nullptr) return;
  while (const dirent* entry = ::readdir(list)) {
    const std::string found = entry->d_name;
    if (found.compare(0, name.size(), name) != 0) continue;
    const long pid = process_of(found.substr(name.size()));
    if (pid > 0 && ::kill(static_cast<pid_t>(pid), 0) != 0 && errno == ESRCH) ::unlink((folder + "/" + found).c_str());
  }
  ::closedir(list);
}

/// @return whether a file is there that will be replaced; `info` is its state
bool may_replace(const std::string& path, const std::string& target, struct stat& info) {
  if (::stat(target.c_str(), &info) != 0) return false;
  if (S_ISDIR(info.st_mode)) fail(path, EISDIR);
  if (!S_ISREG(info.st_mode))  // renaming would replace a device
    fail_output("cannot write: not a regular file", path, "name a file that does not exist or may be replaced");
  if (::access(target.c_str(), W_OK) != 0) fail(path, errno);
  return true;
}

}  // namespace

std::string behind_links(const std::string& path) {
  std::string at = path;
  for (int depth = 0; depth < 40; ++depth) {
    struct stat info;
    if (::lstat(at.c_str(), &info) != 0 || !S_ISLNK(info.st_mode)) return at;
    char named[PATH_MAX];
    const ssize_t length = ::readlink(at.c_str(), named, sizeof named - 1);
    if (length <= 0) return path;
    const std::string to(named, static_cast<std::size_t>(length));
    at = to[0] == '/' ? to : folder_of(at) + "/" + to;
  }
  return path;
}

void remove_unfinished_files() {
  const int code = errno;
  for (std::atomic<char*>& path : unfinished)
    if (char* const p = path.exchange(nullptr)) ::unlink(p);
  errno = code;
}

RemovedOnSignals::RemovedOnSignals(const std::string& path) : slot_(remember(path)) {}
RemovedOnSignals::~RemovedOnSignals() {
  forget(slot_);
}

void end_on_signals() {
  struct sigaction action {};
  action.sa_handler = remove_and_end;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  ::sigemptyset(&action.sa_mask);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGPIPE, SIGQUIT, SIGXCPU}) {
    struct sigaction before {};
    if (::sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN) continue;
    ::sigaction(signal, &action, nullptr);
  }
  ::signal(SIGXFSZ, SIG_IGN);
}

AtomicFiles::~AtomicFiles() {
  for (const Pending& p : pending_) {
    ::unlink(p.temporary.c_str());
    forget(p.slot);
  }
}

void AtomicFiles::check(const std::string& path) {
  const std::string target = behind_links(path), folder = folder_of(target);
  struct stat info;
  may_replace(path, target, info);
  if (::stat(folder.c_str(), &info) != 0) fail(path, errno);
  if (!S_ISDIR(info.st_mode)) fail(path, ENOTDIR);
  if (::access(folder.c_str(), W_OK | X_OK) != 0) fail(path, errno);
  const std::size_t name =
      target.size() - (target.find_last_of('/') == std::string::npos ? 0 : target.find_last_of('/') + 1);
  if (name > 235) fail(path, ENAMETOOLONG);  // with ".partPID-N" behind it
  remove_left_over(target);
}

void AtomicFiles::write(const std::string& path, const std::function<void(std::FILE*)>& write) {
  const std::string target = behind_links(path);
  struct stat info;
  const bool replaces = may_replace(path, target, info);
  remove_left_over(target);
  std::string temporary;
  const int descriptor = create_beside(target, temporary);
  if (descriptor < 0) fail(path, errno);
  // From here on the destructor removes the file, unless it is removed below.
  pending_.push_back({temporary, target, remember(temporary)});
  const auto drop = [&] {
    ::unlink(temporary.c_str());
    forget(pending_.back().slot);
    pending_.pop_back();
  };
  if (replaces) {
    // another owner's file: its mode is kept at least
    if (::fchown(descriptor, info.st_uid, info.st_gid) != 0) errno = 0;
    ::fchmod(descriptor, info.st_mode & 07777);
  }
  std::FILE* file = ::fdopen(descriptor, "wb");
  if (file == nullptr) {
    const int code = errno;
    ::close(descriptor);
    drop();
    fail(path, code);
  }
  try {
    errno = 0;
    write(file);
  } catch (...) {
    std::fclose(file);
    drop();
    throw;
  }
  // A failed write has left its cause in errno, unless the callback did more after it.
  int code = std::ferror(file) != 0 ? (errno != 0 ? errno : EIO) : 0;
  if (code == 0 && std::fflush(file) != 0) code = errno;
  // The bytes are on the disk before the name is; some file systems cannot say.
  if (code == 0 && ::fsync(descriptor) != 0 && errno != EINVAL && errno != ENOTSUP && errno != ENOSYS) code = errno;
  if (std::fclose(file) != 0 && code == 0) code = errno;
  if (code != 0) {
    drop();
    fail(path, code);
  }
}

void AtomicFiles::write_by_name(const std::string& path, const std::function<void(const std::string&)>& write_named) {
  write(path, [&](std::FILE*) {
    write_named(pending_.back().temporary);
    errno = 0;  // what the library left there is no failure
  });
}

void AtomicFiles::commit() {
  // In the order of writing, so that of two files of one name the last stays.
  while (!pending_.empty()) {
    const Pending p = pending_.front();
    if (std::rename(p.temporary.c_str(), p.final_path.c_str()) != 0) fail(p.final_path, errno);
    forget(p.slot);
    pending_.erase(pending_.begin());
  }
}

}  // namespace stackmesh
