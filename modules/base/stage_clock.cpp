#include "base/stage_clock.h"

#include <sys/resource.h>

#include <algorithm>

namespace stackmesh {
namespace {
double cpu_seconds() {
  double total = 0;
  for (int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    getrusage(who, &usage);
    for (const timeval& t : {usage.ru_utime, usage.ru_stime})
      total += static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  }
  return total;
}
}  // namespace

void add_stage_time(std::vector<StageTime>& stages, const StageTime& time) {
  const auto at = std::find_if(stages.begin(), stages.end(), [&](const StageTime& s) { return s.name == time.name; });
  if (at == stages.end()) {
    stages.push_back(time);
    return;
  }
  at->wall_s += time.wall_s;
  at->cpu_s += time.cpu_s;
}

std::size_t StageClock::stage(const std::string& name) {
  const std::size_t at =
      std::find_if(stages_.begin(), stages_.end(), [&](const StageTime& s) { return s.name == name; }) -
      stages_.begin();
  if (at == stages_.size()) stages_.push_back({name, 0, 0});
  return at;
}

void StageClock::begin(const std::string& name) {
  current_ = stage(name);
  wall_ = std::chrono::steady_clock::now();
  cpu_s_ = cpu_seconds() - beside_.cpu_s();
  progress_.begin(name);
}

void StageClock::end() {
  stages_[current_].wall_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count();
  stages_[current_].cpu_s += cpu_seconds() - beside_.cpu_s() - cpu_s_;
  progress_.end();
}

void StageClock::begin_beside(const std::string& name, std::function<void()> work, bool at_once) {
  beside_stage_ = stage(name);
  beside_.begin(std::move(work), at_once);
}

void StageClock::finish_beside() {
  beside_.finish();
  stages_[beside_stage_].cpu_s += beside_.cpu_s() - beside_cpu_s_;
  beside_cpu_s_ = beside_.cpu_s();
}

double peak_memory_mb() {
  long peak = 0;
  for (int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    getrusage(who, &usage);
    peak = std::max(peak, usage.ru_maxrss);
  }
  return static_cast<double>(peak) / 1024;
}

}  // namespace stackmesh
