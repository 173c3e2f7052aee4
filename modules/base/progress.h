#pragma once
#include <memory>
#include <string>

namespace stackmesh {

/// How progress is shown. `automatic`: a live line on a terminal, nothing in a pipe.
enum class ProgressMode { automatic, plain, none };

/// Receives what a long run is doing. The default does nothing, so a library call stays silent.
class Progress {
 public:
  virtual ~Progress() = default;
  /// A stage ("read", "contours", "stitch", ...) begins.
  virtual void begin(const std::string& stage) { (void)stage; }
  /// The stage's share that is done, in [0, 1]; may be called from any thread.
  virtual void advance(double fraction) { (void)fraction; }
  /// The stage has ended.
  virtual void end() {}
};

/// Progress on stderr.
std::unique_ptr<Progress> make_terminal_progress(ProgressMode mode);

}  // namespace stackmesh
