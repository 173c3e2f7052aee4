#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "model/geometry.h"

namespace stackmesh::worker {

using Clock = std::chrono::steady_clock;

struct Program {
  std::string path;  // empty: find_worker()
  std::vector<std::string> args;
};

struct Request {
  std::string switches;
  const std::vector<Vec3>* points = nullptr;
  const std::vector<double>* sizes = nullptr;          // edge length wanted at each point (-m); null: none
  const std::vector<std::int32_t>* corners = nullptr;  // three a triangle
};

struct Reply {
  enum class Kind {
    done,         // the arrays are TetGen's answer
    gave_up,      // TetGen said no; `text` is what it said
    died,         // the worker crashed in TetGen or was killed; `text` says how
    timed_out,    // and was killed by us
    not_a_worker  // it could not be started, or does not speak our language
  };
  Kind kind = Kind::died;
  std::string text;     // not yet one line
  bool killed = false;  // by a signal from outside, without an answer: not TetGen's doing
  std::vector<Vec3> added_points;
  std::vector<std::int32_t> tets, neighbours, faces;
};

/// Starts the worker, sends the request, and waits for its answer until the deadline, or until `given_up`. The worker
/// is gone and reaped when this returns.
Reply run(const Program& program, const Request& request, Clock::time_point deadline,
          const std::atomic<bool>* given_up = nullptr);

}  // namespace stackmesh::worker
