#include "base/monitor.h"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <mutex>

namespace stackmesh {
namespace {

using Clock = std::chrono::steady_clock;

/// One line a stage; on a terminal the line is rewritten in place while the stage runs.
class TerminalMonitor : public Monitor {
 public:
  explicit TerminalMonitor(bool live) : live_(live) {}
  void begin(const std::string& stage) override {
    std::lock_guard<std::mutex> lock(mutex_);
    stage_ = stage;
    start_ = shown_ = Clock::now();
    if (live_) show("\r\033[K%-10s", stage_.c_str());
  }
  void advance(double fraction) override {
    if (!live_) return;
    std::lock_guard<std::mutex> lock(mutex_);
    const auto now = Clock::now();
    if (now - shown_ < std::chrono::milliseconds(100)) return;
    shown_ = now;
    std::fprintf(stderr, "\r\033[K%-10s %3d %%", stage_.c_str(), static_cast<int>(100 * fraction));
    std::fflush(stderr);
  }
  void end() override {
    std::lock_guard<std::mutex> lock(mutex_);
    const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    std::fprintf(stderr, live_ ? "\r\033[K%-10s %6.2f s\n" : "%-10s %6.2f s\n", stage_.c_str(), seconds);
    std::fflush(stderr);
  }

 private:
  void show(const char* format, const char* text) {
    std::fprintf(stderr, format, text);
    std::fflush(stderr);
  }
  bool live_;
  std::string stage_;
  Clock::time_point start_, shown_;
  std::mutex mutex_;
};

}  // namespace

Monitor& no_monitor() {
  static Monitor silent;
  return silent;
}

std::unique_ptr<Monitor> make_terminal_monitor(ProgressMode mode) {
  const bool terminal = isatty(STDERR_FILENO) != 0;
  if (mode == ProgressMode::none || (mode == ProgressMode::automatic && !terminal)) return std::make_unique<Monitor>();
  return std::make_unique<TerminalMonitor>(mode == ProgressMode::automatic);
}

}  // namespace stackmesh
