#include "base/parallel.h"

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "base/cancel.h"
#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace stackmesh {
namespace {

/// What TBB orders (the caller before the bodies, the bodies before the return), said to the thread sanitizer, which
/// does not see into Debian's TBB. Without the sanitizer it does nothing.
class Order {
 public:
#ifdef __SANITIZE_THREAD__
  Order() {
    __tsan_release(&begun_);
  }
  void body_begins() {
    __tsan_acquire(&begun_);
  }
  void body_ends() {
    __tsan_release(&ended_);
  }
  void all_ended() {
    __tsan_acquire(&ended_);
  }

 private:
  char begun_ = 0, ended_ = 0;
#else
  void body_begins() {}
  void body_ends() {}
  void all_ended() {}
#endif
};

}  // namespace

int thread_count(int threads) {
  return threads > 0 ? threads : tbb::info::default_concurrency();
}

void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body) {
  const int n = std::min(thread_count(threads), thread_count(0));  // for more, TBB would print a warning
  if (n == 1 || count < 2) {
    for (std::size_t i = 0; i < count; ++i) {
      stop_if_cancelled();
      body(i);
    }
    return;
  }
  const Monitor* monitor = cancelling_monitor();
  Order order;
  const auto loop = [&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1), [&](const auto& range) {
      order.body_begins();
      const CancelScope scope(monitor);
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        stop_if_cancelled();
        body(i);
      }
      order.body_ends();
    });
  };
  if (n == tbb::info::default_concurrency()) loop();  // the arena that is there already
  else tbb::task_arena(n).execute(loop);
  order.all_ended();
}

}  // namespace stackmesh
