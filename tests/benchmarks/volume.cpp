// From a closed surface to tetrahedra: TetGen with and without the improvement, second order, the check. Spheres whose
// triangles are as even as the enhancement's; the argument is the level of subdivision, 8 * 4^n triangles.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstring>
#include <map>

#include "validate/check_volume.h"
#include "volume/fill_volume.h"
#include "volume/raise_order.h"

namespace {

using namespace stackmesh;

/// An octahedron, cut in four `levels` times.
InterfaceComplex sphere(int levels) {
  InterfaceComplex c;
  c.points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (const int x : {0, 1})
    for (const int y : {2, 3})
      for (const int z : {4, 5}) {
        const bool turned = (x + y + z) % 2 == 1;
        c.triangles.push_back({{x, turned ? z : y, turned ? y : z}, 1, 0});
      }
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [at, fresh] = middles.insert({std::minmax(a, b), static_cast<int>(c.points.size())});
      if (fresh) c.points.push_back(c.points[a] + c.points[b]);
      return at->second;
    };
    std::vector<InterfaceTriangle> finer;
    for (const auto& t : c.triangles) {
      const int ab = middle(t.v[0], t.v[1]), bc = middle(t.v[1], t.v[2]), ca = middle(t.v[2], t.v[0]);
      finer.push_back({{t.v[0], ab, ca}, 1, 0});
      finer.push_back({{t.v[1], bc, ab}, 1, 0});
      finer.push_back({{t.v[2], ca, bc}, 1, 0});
      finer.push_back({{ab, bc, ca}, 1, 0});
    }
    c.triangles = finer;
    for (Vec3& p : c.points) p = (1 / norm(p)) * p;
  }
  return c;
}

FillOptions options(bool improve) {
  FillOptions o;
  o.radius_edge = 1.4;
  o.inner_growth = 2;
  o.known_sound = true;
  if (improve) o.improve_deg = 24;
  return o;
}

void fill(benchmark::State& state, bool improve) {
  const InterfaceComplex complex = sphere(static_cast<int>(state.range(0)));
  FillResult result;
  for (auto _ : state) result = fill_volume(complex, options(improve));
  if (result.status != FillResult::Status::verified) state.SkipWithError(result.message.c_str());
  const VolumeCheck check = check_volume(result.mesh);
  state.counters["tets"] = static_cast<double>(check.tets);
  state.counters["smallest_dihedral"] = check.dihedral_min_deg;
}

void BM_Fill(benchmark::State& state) {
  fill(state, false);
}
void BM_FillAndImprove(benchmark::State& state) {
  fill(state, true);
}

void BM_SecondOrder(benchmark::State& state) {
  const TetMesh mesh = fill_volume(sphere(static_cast<int>(state.range(0))), options(true)).mesh;
  for (auto _ : state) benchmark::DoNotOptimize(raise_order(mesh));
  state.counters["tets"] = static_cast<double>(mesh.tets.size());
}

void BM_CheckVolume(benchmark::State& state) {
  const TetMesh mesh = fill_volume(sphere(static_cast<int>(state.range(0))), options(true)).mesh;
  for (auto _ : state) benchmark::DoNotOptimize(check_volume(mesh));
  state.counters["tets"] = static_cast<double>(mesh.tets.size());
}

BENCHMARK(BM_Fill)->Arg(5)->Arg(6)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(BM_FillAndImprove)->Arg(5)->Arg(6)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(BM_SecondOrder)->Arg(5)->Arg(6)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(BM_CheckVolume)->Arg(5)->Arg(6)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
