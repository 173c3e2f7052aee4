#pragma once
#include <cstddef>
#include <functional>

namespace stackmesh {

/// Calls body(i) for every i in [0, count), on up to `threads` threads (0: all of the machine).
/// The bodies must be independent; their order is not defined. The first exception thrown is rethrown.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body);

/// The number of threads that `threads` stands for (0: all of the machine).
int thread_count(int threads);

}  // namespace stackmesh
