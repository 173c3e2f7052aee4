// Random stacks at the options that the program has when none is given: closed, nothing crosses, no component is lost,
// nothing falls back, and no stack takes far longer for a triangle than others. STACKMESH_RANDOM_STACKS sets their
// number (default 120), STACKMESH_FIRST_SEED the first one; the ten slowest are printed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "base/parallel.h"
#include "default_run.h"
#include "random_stacks.h"

using namespace stackmesh;
using namespace stackmesh::testing_support;

namespace {

/// The heart of docs/results.md takes 0.1 ms of CPU for a stitched triangle; a twentieth of its speed is the least. Of
/// a small stack, a second is little.
constexpr double kMost_s = 2e-3, kFree_s = 1;

/// Slices far apart get virtual ones between, and a few voxels become 50,000 triangles: so that thousands of stacks can
/// be run, only every 25th is as drawn, of the others a corner of at most 8 x 8 x 5 voxels with slices at most 1.4
/// pixels apart.
LabelVolume stack_of(std::size_t seed) {
  const LabelVolume whole = random_volume(seed);
  if (seed % 25 == 7) return whole;
  LabelVolume v = whole;
  v.size = {std::min(8, whole.size[0]), std::min(8, whole.size[1]), std::min(5, whole.size[2])};
  v.spacing_mm[2] = std::min(v.spacing_mm[2], 1.4);
  v.voxels.assign(static_cast<std::size_t>(v.size[0]) * v.size[1] * v.size[2], 0);
  for (int k = 0; k < v.size[2]; ++k)
    for (int j = 0; j < v.size[1]; ++j)
      for (int i = 0; i < v.size[0]; ++i) v.voxels[v.index(i, j, k)] = whole.voxels[whole.index(i, j, k)];
  if (*std::max_element(v.voxels.begin(), v.voxels.end()) == 0) v.voxels[v.index(1, 1, v.size[2] / 2)] = 1;
  return v;
}

std::size_t asked(const char* name, std::size_t usual) {
  const char* text = std::getenv(name);
  return text != nullptr ? static_cast<std::size_t>(std::strtoull(text, nullptr, 10)) : usual;
}

TEST(RandomStacksAtDefaults, AreClosedWholeAndEnhanced) {
  const std::size_t count = asked("STACKMESH_RANDOM_STACKS", 80), first = asked("STACKMESH_FIRST_SEED", 0);
  std::vector<DefaultRun> runs(count);
  parallel_for(count, 0, [&](std::size_t i) {
    runs[i] = run_at_defaults(stack_of(first + i), (first + i) % 40 == 0 ? STACKMESH_WORKER : "");
    // a long campaign tells at once
    if (!runs[i].problem.empty()) std::fprintf(stderr, "seed %zu: %s\n", first + i, runs[i].problem.c_str());
  });
  std::size_t lost = 0, others = 0;
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string& problem = runs[i].problem;
    if (problem.empty()) order.push_back(i);
    // Two pieces of noise in far slices may join, or one may split, where smooth sections between them do; a missing
    // one is a loss.
    if (problem.find("do not match") != std::string::npos) ++others;
    else if (!problem.empty() && ++lost <= 10) ADD_FAILURE() << "seed " << first + i << ": " << problem;
  }
  EXPECT_EQ(lost, 0u) << "of " << count << " stacks";
  EXPECT_LE(others, 1 + count / 100) << "stacks whose pieces join or split";

  const auto share = [&](std::size_t i) {
    return runs[i].cpu_s / static_cast<double>(std::max<std::size_t>(1, runs[i].report.stitched.triangles));
  };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return share(a) > share(b); });
  std::printf("%zu stacks from seed %zu: %zu failed, %zu with other pieces. The slowest for a triangle:\n", count,
              first, lost, others);
  for (std::size_t k = 0; k < std::min<std::size_t>(10, order.size()); ++k) {
    const DefaultRun& r = runs[order[k]];
    std::printf("  seed %zu: %.2f s, %zu stitched triangles, %zu of the surface, %.0f us a stitched triangle\n",
                first + order[k], r.cpu_s, r.report.stitched.triangles,
                r.report.surface ? r.report.surface->triangles : 0, 1e6 * share(order[k]));
  }
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  for (std::size_t i = 0; i < count; ++i)
    EXPECT_LT(runs[i].cpu_s, kFree_s + kMost_s * static_cast<double>(runs[i].report.stitched.triangles))
        << "seed " << first + i;
#endif
}

/// Seeds of the fuzzer of the pipeline, and what it found.
TEST(FuzzedStacks, AreClosedWholeAndEnhanced) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(STACKMESH_SOURCE_DIR "/tests/fuzz/stacks")) {
    std::ifstream file(entry.path(), std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
    const DefaultRun run = run_at_defaults(
        volume_of_bytes(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), STACKMESH_WORKER);
    const bool harmless = run.problem.find("do not match") != std::string::npos;
    EXPECT_TRUE(run.problem.empty() || harmless) << entry.path() << ": " << run.problem;
    ++count;
  }
  EXPECT_GT(count, 5u);
}

}  // namespace
