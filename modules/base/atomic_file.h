#pragma once
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

namespace stackmesh {

/// Writes files that appear whole or not at all: each is written beside its final name (as NAME.partPID-N), brought to
/// the disk, and renamed by commit(). Whatever was not committed is removed by the destructor, by end_on_signals(), or,
/// after a crash or a power cut, when the same name is written or checked again. A file that is replaced leaves its
/// mode (and, where that is allowed, its owner) to the new one; behind a symbolic link the file that it names is
/// replaced, or made, and the link stays.
class AtomicFiles {
 public:
  AtomicFiles() = default;
  AtomicFiles(const AtomicFiles&) = delete;
  AtomicFiles& operator=(const AtomicFiles&) = delete;
  ~AtomicFiles();

  /// Whether a file of that name can be written: its folder is there and may be written to, it is no folder, device or
  /// file that may not be replaced. Removes what earlier runs that have ended left of it. @throws Error(output)
  static void check(const std::string& path);

  /// Writes one file: `write` gets a stdio stream open for binary writing; it need not check its writes. When it
  /// throws or a write fails, nothing of this file stays, and those written before can still be committed.
  /// @throws Error(output) naming the path when it cannot be created or written (no folder, no right, disk full,
  /// a folder or device of that name).
  void write(const std::string& path, const std::function<void(std::FILE*)>& write);

  /// The same for a library that opens files itself: `write` gets the name of the unfinished file, which it may replace
  /// in place.
  void write_by_name(const std::string& path, const std::function<void(const std::string&)>& write);

  /// Renames everything written so far to its final name. @throws Error(output)
  void commit();

 private:
  struct Pending {
    std::string temporary, final_path;
    int slot = -1;  ///< in the list of what signals remove
  };
  std::vector<Pending> pending_;
};

/// A path that signals remove, until it goes. For temporary files that are no outputs.
class RemovedOnSignals {
 public:
  /// @param path need not be there yet
  explicit RemovedOnSignals(const std::string& path);
  ~RemovedOnSignals();
  RemovedOnSignals(const RemovedOnSignals&) = delete;
  RemovedOnSignals& operator=(const RemovedOnSignals&) = delete;

 private:
  int slot_;
};

/// Lets SIGTERM, SIGINT, SIGHUP, SIGPIPE, SIGQUIT and SIGXCPU remove unfinished files before they end the program as
/// ever, and lets a write beyond the bound on a file's size fail (SIGXFSZ) in place of ending the program. Signals that
/// are ignored stay so. For a main().
void end_on_signals();

/// What a signal would remove, now: for a program that ends without unwinding.
void remove_unfinished_files();

/// The path with every symbolic link followed, also one that names nothing yet; the path itself where that fails.
std::string behind_links(const std::string& path);

}  // namespace stackmesh
