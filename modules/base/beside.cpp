#include "base/beside.h"

#include <pthread.h>
#include <time.h>

#include <utility>

#include "base/cancel.h"

namespace stackmesh {
namespace {
double seconds_of(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}
}  // namespace

Beside::~Beside() {
  if (thread_.joinable()) thread_.join();
}

void Beside::begin(std::function<void()> work, bool at_once) {
  work_ = std::move(work);
  if (!at_once) return;
  running_ = true;
  thread_ = std::thread([this, monitor = cancelling_monitor()] {
    const CancelScope scope(monitor);
    try {
      work_();
    } catch (...) {
      error_ = std::current_exception();
    }
    past_cpu_s_ = past_cpu_s_ + seconds_of(CLOCK_THREAD_CPUTIME_ID);
    running_ = false;
  });
}

void Beside::finish() {
  if (thread_.joinable()) {
    thread_.join();
  } else if (work_) {
    work_();
  }
  work_ = nullptr;
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

double Beside::cpu_s() const {
  const double past = past_cpu_s_;
  clockid_t clock;
  if (!running_ || pthread_getcpuclockid(const_cast<std::thread&>(thread_).native_handle(), &clock) != 0)
    return past_cpu_s_;
  return past + seconds_of(clock);
}

}  // namespace stackmesh
