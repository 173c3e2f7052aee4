#pragma once
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

namespace stackmesh {

/// Writes files that appear whole or not at all: each is written beside its final name and renamed by
/// commit(). Whatever was not committed is removed by the destructor.
class AtomicFiles {
 public:
  AtomicFiles() = default;
  AtomicFiles(const AtomicFiles&) = delete;
  AtomicFiles& operator=(const AtomicFiles&) = delete;
  ~AtomicFiles();

  /// Writes one file: `write` gets a stdio stream open for binary writing; it need not check its writes. When it
  /// throws or a write fails, nothing of this file stays, and those written before can still be committed.
  /// @throws Error(output) naming the path when it cannot be created or written (no folder, no right, disk full,
  /// a folder or device of that name).
  void write(const std::string& path, const std::function<void(std::FILE*)>& write);

  /// Renames everything written so far to its final name. @throws Error(output)
  void commit();

 private:
  struct Pending {
    std::string temporary, final_path;
  };
  std::vector<Pending> pending_;
};

}  // namespace stackmesh
