#include "base/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

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

/// The file behind a symbolic link, so that the link survives; the path itself otherwise.
std::string behind_links(const std::string& path) {
  char resolved[PATH_MAX];
  struct stat info;
  if (::lstat(path.c_str(), &info) != 0 || !S_ISLNK(info.st_mode)) return path;
  return ::realpath(path.c_str(), resolved) != nullptr ? resolved : path;
}

/// A new file beside `path`, named so that no other run and no other file of this run has it.
int create_beside(const std::string& path, std::string& temporary) {
  for (int n = 0;; ++n) {
    temporary = path + ".part" + std::to_string(::getpid()) + "-" + std::to_string(n);
    const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0 || errno != EEXIST) return descriptor;
  }
}

}  // namespace

AtomicFiles::~AtomicFiles() {
  for (const Pending& p : pending_) ::unlink(p.temporary.c_str());
}

void AtomicFiles::write(const std::string& path, const std::function<void(std::FILE*)>& write) {
  const std::string target = behind_links(path);
  struct stat info;
  if (::stat(target.c_str(), &info) == 0) {
    if (S_ISDIR(info.st_mode)) fail(path, EISDIR);
    if (!S_ISREG(info.st_mode))  // renaming would replace a device
      fail_output("cannot write: not a regular file", path,
                  "name a file that does not exist or may be replaced");
    if (::access(target.c_str(), W_OK) != 0) fail(path, errno);
  }
  std::string temporary;
  const int descriptor = create_beside(target, temporary);
  if (descriptor < 0) fail(path, errno);
  // From here on the destructor removes the file, unless it is removed below.
  pending_.push_back({temporary, target});
  const auto drop = [&] {
    ::unlink(temporary.c_str());
    pending_.pop_back();
  };
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
  if (std::fclose(file) != 0 && code == 0) code = errno;
  if (code != 0) {
    drop();
    fail(path, code);
  }
}

void AtomicFiles::commit() {
  // In the order of writing, so that of two files of one name the last stays.
  while (!pending_.empty()) {
    const Pending p = pending_.front();
    if (std::rename(p.temporary.c_str(), p.final_path.c_str()) != 0) fail(p.final_path, errno);
    pending_.erase(pending_.begin());
  }
}

}  // namespace stackmesh
