#include "base/parallel.h"

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "base/cancel.h"

namespace stackmesh {

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
  const auto loop = [&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1), [&](const auto& range) {
      const CancelScope scope(monitor);
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        stop_if_cancelled();
        body(i);
      }
    });
  };
  if (n == tbb::info::default_concurrency()) loop();  // the arena that is there already
  else tbb::task_arena(n).execute(loop);
}

}  // namespace stackmesh
