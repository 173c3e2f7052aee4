#pragma once
#include <memory>
#include <string>

namespace stackmesh {

/// How progress is shown. `automatic`: a live line on a terminal, nothing in a pipe.
enum class ProgressMode { automatic, plain, none };

/// Watches a long run: it is told what the run does, and may end it. The default does nothing, so a library call stays
/// silent.
class Monitor {
 public:
  virtual ~Monitor() = default;
  /// A stage ("read", "contours", "stitch", ...) begins.
  virtual void begin(const std::string& stage) { (void)stage; }
  /// The stage's share that is done, in [0, 1]; may be called from any thread.
  virtual void advance(double fraction) { (void)fraction; }
  /// The stage has ended.
  virtual void end() {}
  /// Whether the run shall end: soon after this becomes true, it throws Error(cancelled). Called often and from any
  /// thread, so it must be quick.
  virtual bool cancelled() const { return false; }
};

/// The monitor that does nothing.
Monitor& no_monitor();

/// Progress on stderr.
std::unique_ptr<Monitor> make_terminal_monitor(ProgressMode mode);

}  // namespace stackmesh
