// The judge's cost against triangles and against voxels: it should be linear in both (see docs/validation.md).
#include <benchmark/benchmark.h>

#include <cmath>

#include "validate/check_fidelity.h"
#include "validate/check_surface.h"
#include "validate/check_thickness.h"

namespace stackmesh {
namespace {

/// A ball of radius 0.4 in a unit cube, meshed by latitude and longitude, a little bumpy.
InterfaceComplex ball(int rings, double scale) {
  InterfaceComplex c;
  const int columns = 2 * rings;
  const auto point = [&](double theta, double phi) {
    const double r = scale * (0.4 + 0.02 * std::sin(5 * theta) * std::cos(4 * phi));
    return Vec3{0.5 * scale + r * std::sin(theta) * std::cos(phi), 0.5 * scale + r * std::sin(theta) * std::sin(phi),
                0.5 * scale + r * std::cos(theta)};
  };
  const double pi = std::acos(-1.0);
  for (int i = 1; i < rings; ++i)
    for (int j = 0; j < columns; ++j) c.points.push_back(point(pi * i / rings, 2 * pi * j / columns));
  const auto id = [&](int i, int j) { return (i - 1) * columns + j % columns; };
  const std::int32_t north = static_cast<std::int32_t>(c.points.size()), south = north + 1;
  c.points.push_back(point(0, 0)), c.points.push_back(point(pi, 0));
  for (int j = 0; j < columns; ++j) {
    c.triangles.push_back({{north, id(1, j), id(1, j + 1)}, 1, 0});
    c.triangles.push_back({{south, id(rings - 1, j + 1), id(rings - 1, j)}, 1, 0});
    for (int i = 1; i + 1 < rings; ++i) {
      c.triangles.push_back({{id(i, j), id(i + 1, j), id(i + 1, j + 1)}, 1, 0});
      c.triangles.push_back({{id(i, j), id(i + 1, j + 1), id(i, j + 1)}, 1, 0});
    }
  }
  return c;
}

LabelVolume voxels(int n) {
  LabelVolume v;
  v.size = {n, n, n};
  v.origin_mm = {0.5, 0.5, 0.5};
  v.labels = {{0, ""}, {1, "ball"}};
  v.voxels.assign(static_cast<std::size_t>(n) * n * n, 0);
  const double r2 = 0.16 * n * n, m = 0.5 * n - 0.5;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        v.voxels[v.index(i, j, k)] = (i - m) * (i - m) + (j - m) * (j - m) + (k - m) * (k - m) < r2;
  return v;
}

void surface_by_triangles(benchmark::State& state) {
  const InterfaceComplex c = ball(static_cast<int>(state.range(0)), 128);
  SurfaceCheckOptions o;
  o.threads = 1;
  for (auto _ : state) benchmark::DoNotOptimize(check_surface(c, o).self_intersections);
  state.counters["triangles"] = static_cast<double>(c.triangles.size());
  state.counters["us/triangle"] =
      benchmark::Counter(static_cast<double>(c.triangles.size()) * 1e-6,
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(surface_by_triangles)->Arg(75)->Arg(150)->Arg(300)->Arg(600)->Unit(benchmark::kMillisecond);

void thickness_by_triangles(benchmark::State& state) {
  const InterfaceComplex c = ball(static_cast<int>(state.range(0)), 128);
  ThicknessOptions o;
  o.threads = 1;
  for (auto _ : state) benchmark::DoNotOptimize(check_thickness(c, o).size());
  state.counters["triangles"] = static_cast<double>(c.triangles.size());
}
BENCHMARK(thickness_by_triangles)->Arg(75)->Arg(150)->Arg(300)->Arg(600)->Unit(benchmark::kMillisecond);

void fidelity_by_triangles(benchmark::State& state) {
  const LabelVolume v = voxels(128);
  const InterfaceComplex c = ball(static_cast<int>(state.range(0)), 128);
  FidelityOptions o;
  o.threads = 1;
  for (auto _ : state) benchmark::DoNotOptimize(check_fidelity(c, v, o)[0].dice);
  state.counters["triangles"] = static_cast<double>(c.triangles.size());
}
BENCHMARK(fidelity_by_triangles)->Arg(75)->Arg(150)->Arg(300)->Arg(600)->Unit(benchmark::kMillisecond);

void fidelity_by_voxels(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  const LabelVolume v = voxels(n);
  const InterfaceComplex c = ball(150, n);
  FidelityOptions o;
  o.threads = 1;
  for (auto _ : state) benchmark::DoNotOptimize(check_fidelity(c, v, o)[0].dice);
  state.counters["Mvoxels"] = 1e-6 * n * n * n;
}
BENCHMARK(fidelity_by_voxels)->Arg(64)->Arg(128)->Arg(256)->Arg(512)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stackmesh

BENCHMARK_MAIN();
