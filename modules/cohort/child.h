#pragma once
#include <sys/types.h>

#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace stackmesh {

/// How a child process ended.
struct ChildEnd {
  int code = 0;                               ///< exit code, or minus the signal that ended it
  double wall_s = 0, cpu_s = 0, peak_mb = 0;  ///< with the processes that it has waited for
};

/// A process in a group of its own, which the kernel kills when the thread that started it ends, however that ends. The
/// whole group is killed when this object goes.
class Child {
 public:
  Child() = default;
  Child(Child&& other) noexcept;
  Child& operator=(Child&& other) noexcept;
  ~Child();

  /// Starts a program; what it prints goes to the file `log`. @throws Error(no_result) where the system gives no
  /// process
  static Child start(const std::vector<std::string>& words, const std::string& log);
  /// Runs `work` in a copy of this process, which must have one thread; what it returns can be read from text().
  static Child fork_for(const std::function<std::string()>& work);

  bool is_running() const { return pid_ > 0; }
  /// Whether it has ended; then `end` says how, once.
  bool has_ended(ChildEnd& end);
  /// Asks the group to end, and kills it where it was asked before.
  void stop();
  /// What fork_for's work returned; empty where it did not come to that.
  std::string text();
  double age_s() const;

 private:
  void kill_now();
  pid_t pid_ = -1;
  int pipe_ = -1;
  bool asked_ = false;
  std::chrono::steady_clock::time_point begun_;
};

/// What a helper program printed on stdout and stderr together, and its exit code; 127 where it is not there.
struct CommandOutput {
  int code = 127;
  std::string text;
};
CommandOutput output_of(const std::vector<std::string>& words);

/// Lets SIGCHLD wake wait_for_children(), and SIGINT, SIGTERM and SIGHUP be told by it instead of ending the program,
/// while it lives.
class ChildSignals {
 public:
  ChildSignals();
  ~ChildSignals();
  ChildSignals(const ChildSignals&) = delete;
  ChildSignals& operator=(const ChildSignals&) = delete;

  /// Until a child ends, the time is over, or a signal asks to stop. @return that signal, else 0
  int wait(double seconds);
};

}  // namespace stackmesh
