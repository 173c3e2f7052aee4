// Contours of the largest real volume (512 x 512 x 630, two labels) against the time of reading it, in the same run.
#include <benchmark/benchmark.h>

#include <filesystem>

#include "image/read_labels.h"
#include "sections/extract.h"

namespace {

using namespace stackmesh;

const std::string kLungs = std::string(STACKMESH_SHARED_DATA) + "/lung_lr_cip/lungs_left_right.nrrd";

void ReadLungs(benchmark::State& state) {
  if (!std::filesystem::exists(kLungs)) {
    state.SkipWithError("no shared data");
    return;
  }
  for (auto _ : state) benchmark::DoNotOptimize(read_label_volume(kLungs).voxels.data());
}

void ContoursOfLungs(benchmark::State& state) {
  if (!std::filesystem::exists(kLungs)) {
    state.SkipWithError("no shared data");
    return;
  }
  static const LabelVolume volume = read_label_volume(kLungs);
  ContourOptions options;
  options.threads = static_cast<int>(state.range(0));
  Monitor quiet;
  std::size_t vertices = 0;
  for (auto _ : state) vertices = extract_sections(volume, options, quiet).vertices;
  state.counters["vertices"] = static_cast<double>(vertices);
}

BENCHMARK(ReadLungs)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(ContoursOfLungs)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
