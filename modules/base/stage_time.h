#pragma once
#include <string>
#include <vector>

namespace stackmesh {

/// What a stage took.
struct StageTime {
  std::string name;   ///< such as "read" or "stitch"
  double wall_s = 0;  ///< seconds by the clock
  double cpu_s = 0;   ///< seconds of all cores together
};

/// Adds to the time of the stage of that name, or appends it.
void add_stage_time(std::vector<StageTime>& stages, const StageTime& time);

}  // namespace stackmesh
