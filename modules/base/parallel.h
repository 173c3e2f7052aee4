#pragma once
#include <algorithm>
#include <cstddef>
#include <functional>

namespace stackmesh {

/// Calls body(i) for every i in [0, count), on up to `threads` threads (0: all of the machine).
/// The bodies must be independent; their order is not defined. The first exception thrown is rethrown.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body);

/// The same for short bodies: threads take them in runs of `run`.
template <class Body>
void for_each_index(std::size_t count, int threads, Body body, std::size_t run = 1024) {
  parallel_for((count + run - 1) / run, threads, [&](std::size_t n) {
    for (std::size_t i = n * run; i < std::min(count, (n + 1) * run); ++i) body(i);
  });
}

/// The number of threads that `threads` stands for (0: all of the machine).
int thread_count(int threads);

}  // namespace stackmesh
