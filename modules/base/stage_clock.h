#pragma once
#include <chrono>
#include <string>
#include <vector>

#include "base/beside.h"
#include "base/monitor.h"
#include "base/stage_time.h"

namespace stackmesh {

/// Times the stages of a run and tells the progress display of them. A stage that runs again adds to its time.
class StageClock {
 public:
  /// `stages` get the times; both references outlive the clock.
  StageClock(Monitor& progress, std::vector<StageTime>& stages) : progress_(progress), stages_(stages) {}
  /// Runs a stage, also when it throws, under the clock.
  /// @return what `stage` returns
  template <class F>
  auto run(const std::string& name, F stage) {
    begin(name);
    struct End {
      StageClock& clock;
      ~End() { clock.end(); }
    } at_end{*this};
    return stage();
  }

  /// Begins a piece of the stage `name` beside the stages that follow: its CPU time counts there, and of its wall time
  /// only what finish_beside() waits for. One at a time.
  void begin_beside(const std::string& name, std::function<void()> work, bool at_once);
  /// Until it is done; throws what it threw.
  void finish_beside();

 private:
  std::size_t stage(const std::string& name);
  void begin(const std::string& name);
  void end();
  Monitor& progress_;
  std::vector<StageTime>& stages_;
  std::chrono::steady_clock::time_point wall_;
  double cpu_s_ = 0;
  std::size_t current_ = 0;
  Beside beside_;
  std::size_t beside_stage_ = 0;
  double beside_cpu_s_ = 0;  // already counted
};

/// Largest resident set of this process so far, or of a child that has ended, in MB.
double peak_memory_mb();

}  // namespace stackmesh
