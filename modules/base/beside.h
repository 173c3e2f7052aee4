#pragma once
#include <atomic>
#include <exception>
#include <functional>
#include <thread>

namespace stackmesh {

/// One piece of work on a thread of its own, beside the stages of a run.
class Beside {
 public:
  Beside() = default;
  Beside(const Beside&) = delete;
  Beside& operator=(const Beside&) = delete;
  ~Beside();

  /// Begins `work`; not `at_once`: it waits for finish() and runs there.
  void begin(std::function<void()> work, bool at_once);
  /// Until the work is done; throws what it threw.
  void finish();
  /// CPU time that threads of this kind have used so far, seconds.
  double cpu_s() const;

 private:
  std::function<void()> work_;
  std::thread thread_;
  std::atomic<bool> running_{false};
  std::atomic<double> past_cpu_s_{0};
  std::exception_ptr error_;
};

}  // namespace stackmesh
