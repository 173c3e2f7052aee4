// A libFuzzer target for everything behind the readers: a small label array through sections, stitched surface,
// enhancement and the exact checks, at the program's own defaults. An open shell, a crossing, a lost component, a
// fallback or an error is a finding. Pieces of noise that join or part between far slices are none.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "default_run.h"
#include "random_stacks.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 7) return 0;
  const std::string problem =
      stackmesh::testing_support::run_at_defaults(stackmesh::testing_support::volume_of_bytes(data, size)).problem;
  if (problem.empty() || problem.find("do not match") != std::string::npos) return 0;
  std::fprintf(stderr, "finding: %s\n", problem.c_str());
  std::abort();
}
