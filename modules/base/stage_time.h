#pragma once
#include <string>
#include <vector>

namespace stackmesh {

/// What a stage took.
struct StageTime {
  std::string name;
  double wall_s = 0, cpu_s = 0;
};

/// Adds to the time of the stage of that name, or appends it.
void add_stage_time(std::vector<StageTime>& stages, const StageTime& time);

}  // namespace stackmesh
