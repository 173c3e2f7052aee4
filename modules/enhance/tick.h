#pragma once
#include <chrono>
#include <cstdio>
#include <cstdlib>
namespace stackmesh {
inline void tick(const char* what) {
  static auto last = std::chrono::steady_clock::now();
  const auto now = std::chrono::steady_clock::now();
  if (std::getenv("TICK")) std::fprintf(stderr, "%7.3f %s\n", std::chrono::duration<double>(now - last).count(), what);
  last = now;
}
}
