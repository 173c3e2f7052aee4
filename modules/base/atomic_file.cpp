#include "base/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"

namespace stackmesh {
namespace {
[[noreturn]] void fail(const std::string& path, int code) {
  const char* mend = code == ENOSPC   ? "free some space or choose another folder"
                     : code == ENOENT ? "create the folder or choose another one"
                                      : "choose a folder that you may write to";
  fail_output(std::string("cannot write: ") + std::strerror(code), path, mend);
}
}  // namespace

AtomicFiles::~AtomicFiles() {
  for (const Pending& p : pending_) ::unlink(p.temporary.c_str());
}

void AtomicFiles::write(const std::string& path, const std::function<void(std::FILE*)>& write) {
  struct stat info;
  if (::stat(path.c_str(), &info) == 0 && S_ISDIR(info.st_mode)) fail(path, EISDIR);
  const std::string temporary = path + ".part" + std::to_string(::getpid());
  std::FILE* file = std::fopen(temporary.c_str(), "wb");
  if (file == nullptr) fail(path, errno);
  pending_.push_back({temporary, path});
  try {
    write(file);
  } catch (...) {
    std::fclose(file);
    throw;
  }
  const bool bad = std::ferror(file) != 0;
  errno = bad && errno == 0 ? EIO : errno;
  const int code = errno;
  if (std::fclose(file) != 0) fail(path, errno);
  if (bad) fail(path, code);
}

void AtomicFiles::commit() {
  while (!pending_.empty()) {
    const Pending p = pending_.back();
    if (std::rename(p.temporary.c_str(), p.final_path.c_str()) != 0) fail(p.final_path, errno);
    pending_.pop_back();
  }
}

}  // namespace stackmesh
