#include "watched_run.h"

#include <pthread.h>
#include <signal.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace stackmesh::python {
namespace {

namespace py = pybind11;
constexpr auto kLook = std::chrono::milliseconds(50);

struct Event {
  std::string stage;
  double done = 0;
};

/// Keeps what the run says until the calling thread asks for it.
class WatchedMonitor : public Monitor {
 public:
  explicit WatchedMonitor(bool told) : told_(told) {}
  void begin(const std::string& stage) override { tell(stage, 0, true); }
  void advance(double fraction) override { tell("", fraction, false); }
  void end() override { tell("", 1, false); }
  bool cancelled() const override { return cancelled_.load(std::memory_order_relaxed); }

  void cancel() { cancelled_ = true; }
  std::vector<Event> take_events() {
    std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(events_, {});
  }

 private:
  void tell(const std::string& stage, double done, bool begins) {
    if (!told_) return;
    std::lock_guard<std::mutex> lock(mutex_);
    if (begins) stage_ = stage;
    // only the latest share of a stage counts
    if (!begins && !events_.empty() && events_.back().stage == stage_) events_.back().done = done;
    else events_.push_back({stage_, done});
  }

  const bool told_;
  std::atomic<bool> cancelled_{false};
  std::mutex mutex_;
  std::string stage_;
  std::vector<Event> events_;
};

/// The work on its thread. Signals go to other threads, so that no wait of the run ends early.
class Runner {
 public:
  Runner(const std::function<void(Monitor&)>& work, Monitor& monitor) {
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    try {
      thread_ = std::thread([this, &work, &monitor] {
        try {
          work(monitor);
        } catch (...) {
          error_ = std::current_exception();
        }
        std::lock_guard<std::mutex> lock(mutex_);
        done_ = true;
        ended_.notify_all();
      });
    } catch (...) {
      pthread_sigmask(SIG_SETMASK, &before, nullptr);
      throw;
    }
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
  }
  ~Runner() {
    if (thread_.joinable()) thread_.join();
  }

  /// Waits a moment, without the GIL; whether the work has ended.
  bool wait() {
    const py::gil_scoped_release released;
    std::unique_lock<std::mutex> lock(mutex_);
    return ended_.wait_for(lock, kLook, [&] { return done_; });
  }

  /// After its end: throws what the work threw.
  void finish() {
    {
      const py::gil_scoped_release released;
      thread_.join();
    }
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  }

 private:
  std::mutex mutex_;
  std::condition_variable ended_;
  bool done_ = false;
  std::exception_ptr error_;
  std::thread thread_;  // last: it uses the others
};

/// What Python raises while the run goes on, if anything.
std::optional<py::error_already_set> look_after_python(WatchedMonitor& monitor, const py::object& progress) {
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    for (const Event& e : monitor.take_events()) progress(e.stage, e.done);
  } catch (py::error_already_set& e) {
    return std::move(e);
  }
  return std::nullopt;
}

}  // namespace

void run_watched(const std::function<void(Monitor&)>& work, const py::object& progress) {
  WatchedMonitor monitor(!progress.is_none());
  std::optional<py::error_already_set> raised;
  {
    Runner runner(work, monitor);
    bool done = false;
    while (!done) {
      done = runner.wait();
      if (!raised && (raised = look_after_python(monitor, progress))) monitor.cancel();
    }
    try {
      runner.finish();
    } catch (...) {
      if (!raised) throw;  // else the run ended because of what was raised
    }
  }
  if (raised) throw std::move(*raised);
}

}  // namespace stackmesh::python
