// Random stacks: closed, intersection-free, volumes equal, components one to one, filled by the volume mesher.
// STACKMESH_RANDOM_STACKS sets their number (default 3,000; the build target random_stacks runs 100,000). A failing
// label stack is shrunk and stored as text; stored ones live in tests/stitch/corpus and are run first.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <sstream>

#include "base/error.h"
#include "base/parallel.h"
#include "checks.h"
#include "random_stacks.h"
#include "sections/polygons.h"
#include "validate/check_fidelity.h"

namespace stackmesh {
namespace {

using namespace testing_support;

StitchOptions options_for(std::uint64_t seed) {
  StitchOptions o;
  o.threads = 1;
  o.caps = seed % 3 == 0 ? Caps::automatic : seed % 3 == 1 ? Caps::flat : Caps::round;
  return o;
}

/// What is wrong with a stitched stack, "" if nothing; `filled` also asks the volume mesher.
std::string problem_of(const InterfaceComplex& complex, bool filled) {
  std::string text = defects(complex);
  if (!text.empty() || !filled) return text;
  const FillResult result = fill(complex);
  if (result.status != FillResult::Status::verified) return "not filled: " + result.message;
  return "";
}

/// Labels whose pieces are not the image's 6-connected components, one to one.
std::string unmatched_components(Stitched& s, const LabelVolume& volume) {
  for (Vec3& p : s.result.complex.points) p = s.stack.frame.to_world(p);  // no frame here mirrors
  FidelityOptions options;
  options.threads = 1;
  options.stack_axis = stacking_axis(volume, StackAxis::automatic);
  options.face_samples = options.surface_samples = 10;
  std::string out;
  for (const LabelFidelity& f : check_fidelity(s.complex(), volume, options))
    if (f.input_components > 0 && !f.components_match)
      out += "label " + std::to_string(f.label) + " has " + std::to_string(f.components) + " pieces for " +
             std::to_string(f.input_components) + " components; ";
  return out;
}

std::string problem_of(const LabelVolume& volume, std::uint64_t seed, bool filled) {
  try {
    Stitched s = stitch_volume(volume, (seed / 6) % 2 ? 0.0 : 0.5, options_for(seed));
    const std::string problem = problem_of(s.complex(), filled);
    return problem.empty() ? unmatched_components(s, volume) : problem;
  } catch (const std::exception& e) {
    return e.what();
  }
}

std::string problem_of_contours(std::uint64_t seed, bool filled) {
  try {
    std::vector<Warning> warnings;
    Monitor quiet;
    Stack stack = sections_from_contours(random_contours(seed), warnings);
    return problem_of(stitch_sections(stack, options_for(seed), quiet).complex, filled);
  } catch (const std::exception& e) {
    return e.what();
  }
}

LabelVolume without(const LabelVolume& v, int axis, int at) {
  LabelVolume out = v;
  out.size[axis] -= 1;
  out.voxels.assign(static_cast<std::size_t>(out.size[0]) * out.size[1] * out.size[2], 0);
  for (int k = 0; k < out.size[2]; ++k)
    for (int j = 0; j < out.size[1]; ++j)
      for (int i = 0; i < out.size[0]; ++i) {
        int from[3] = {i, j, k};
        if (from[axis] >= at) ++from[axis];
        out.voxels[out.index(i, j, k)] = v.voxels[v.index(from[0], from[1], from[2])];
      }
  return out;
}

/// Drops slices, rows, columns and voxels as long as the stack still fails.
LabelVolume shrink(LabelVolume v, const std::function<bool(const LabelVolume&)>& fails) {
  for (bool smaller = true; smaller;) {
    smaller = false;
    for (int axis = 0; axis < 3; ++axis)
      for (int at = 0; at < v.size[axis] && v.size[axis] > 2;) {
        LabelVolume next = without(v, axis, at);
        if (fails(next)) {
          v = std::move(next);
          smaller = true;
        } else {
          ++at;
        }
      }
    for (std::uint16_t& voxel : v.voxels) {
      if (voxel == 0) continue;
      const std::uint16_t old = voxel;
      voxel = 0;
      if (fails(v)) smaller = true;
      else voxel = old;
    }
  }
  return v;
}

std::string to_text(const LabelVolume& v, std::uint64_t seed) {
  std::ostringstream out;
  out.precision(17);
  out << "seed " << seed << " size " << v.size[0] << ' ' << v.size[1] << ' ' << v.size[2] << " spacing "
      << v.spacing_mm[0] << ' ' << v.spacing_mm[1] << ' ' << v.spacing_mm[2] << '\n';
  for (int k = 0; k < v.size[2]; ++k, out << '\n')
    for (int j = 0; j < v.size[1]; ++j, out << '\n')
      for (int i = 0; i < v.size[0]; ++i) out << v.voxels[v.index(i, j, k)];
  return out.str();
}

LabelVolume from_text(std::istream& in, std::uint64_t& seed) {
  LabelVolume v;
  std::string word;
  in >> word >> seed >> word >> v.size[0] >> v.size[1] >> v.size[2] >> word >> v.spacing_mm[0] >> v.spacing_mm[1] >>
      v.spacing_mm[2];
  for (int l = 0; l < 10; ++l) v.labels.push_back({l, ""});
  for (char c; in >> c;) v.voxels.push_back(static_cast<std::uint16_t>(c - '0'));
  if (v.voxels.size() != static_cast<std::size_t>(v.size[0]) * v.size[1] * v.size[2])
    throw std::runtime_error("malformed corpus file");
  return v;
}

TEST(RandomStacks, StoredStacksStayClosedAndFilled) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(STACKMESH_SOURCE_DIR "/tests/stitch/corpus")) {
    std::ifstream file(entry.path());
    std::uint64_t seed = 0;
    const LabelVolume v = from_text(file, seed);
    for (std::uint64_t mode = 0; mode < 6; ++mode)  // every shape of ends, raw and simplified
      EXPECT_EQ(problem_of(v, mode * 7, true), "") << entry.path() << " mode " << mode;
    ++count;
  }
  EXPECT_GT(count, 0u) << "the corpus is empty";
}

TEST(RandomStacks, AreClosedWithoutIntersectionsAndFilled) {
  const char* wanted = std::getenv("STACKMESH_RANDOM_STACKS");
  const std::size_t count = wanted != nullptr ? std::strtoull(wanted, nullptr, 10) : 3000;
  const char* first_text = std::getenv("STACKMESH_FIRST_SEED");
  const std::uint64_t first = first_text != nullptr ? std::strtoull(first_text, nullptr, 10) : 0;
  std::vector<std::string> problems(count);
  parallel_for(count, 0, [&](std::size_t i) {
    const std::uint64_t seed = first + i;
    problems[i] = seed % 7 == 6 ? problem_of_contours(seed, true) : problem_of(random_volume(seed), seed, true);
  });
  std::size_t failures = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (problems[i].empty()) continue;
    const std::uint64_t seed = first + i;
    if (++failures > 5) continue;
    ADD_FAILURE() << "seed " << seed << ": " << problems[i];
    if (seed % 7 == 6) continue;
    const LabelVolume small = shrink(random_volume(seed), [&](const LabelVolume& v) {
      try {
        return !problem_of(v, seed, true).empty() && count_voxels(v)[0] < v.voxels.size();
      } catch (const std::exception&) {
        return false;
      }
    });
    const std::string path = ::testing::TempDir() + "stack_" + std::to_string(seed) + ".txt";
    std::ofstream(path) << to_text(small, seed);
    ADD_FAILURE() << "shrunk to " << path << ":\n" << to_text(small, seed);
  }
  EXPECT_EQ(failures, 0u) << "of " << count << " stacks";
}

}  // namespace
}  // namespace stackmesh
