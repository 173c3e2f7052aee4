// Stitching against its floor: CGAL's own insertion of the same rounded constraints, in the same run.
// Sizes are those of the paper's examples (sections / vertices), one large stack, and a series for linearity.
#include "stitch/stitch.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <benchmark/benchmark.h>

#include <cmath>

#include "planar/snap_rounding.h"
#include "sections/polygons.h"

namespace {

using namespace stackmesh;

/// Sections of an organ-like tube with an inner wall: both drift and breathe from section to section.
Stack organ(int sections, int vertices) {
  const int half = vertices / sections / 2;
  LabelContours file;
  file.path = "organ";
  file.label = 1;
  for (int k = 0; k < sections; ++k) {
    ContourSection s;
    s.z_mm = 1.5 * k;
    for (const double radius : {40.0, 22.0}) {
      ContourPolygon p;
      for (int i = 0; i < half; ++i) {
        const double a = 2 * M_PI * i / half;
        const double r = radius * (1 + 0.1 * std::sin(3 * a + 0.05 * k) + 0.03 * std::sin(11 * a - 0.11 * k));
        p.points.push_back({0.2 * k + r * std::cos(a), 5 * std::sin(0.03 * k) + r * std::sin(a)});
      }
      s.polygons.push_back(p);
    }
    file.sections.push_back(s);
  }
  std::vector<Warning> warnings;
  return sections_from_contours({file}, warnings);
}

void sizes(benchmark::internal::Benchmark* b) {
  b->Args({29, 1200})->Args({87, 12200})->Args({142, 11500})->Args({500, 1000000})->Unit(benchmark::kMillisecond);
}

/// The floor: for every slab, one constrained Delaunay triangulation of both sections' rounded edges.
void FloorCdt(benchmark::State& state) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Cdt = CGAL::Constrained_Delaunay_triangulation_2<Kernel>;
  Stack stack = organ(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  snap_round(stack, 1);
  std::vector<std::vector<Cdt::Point>> points;
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> edges;
  for (std::size_t k = 0; k + 1 < stack.sections.size(); ++k) {
    points.emplace_back();
    edges.emplace_back();
    for (const Section* s : {&stack.sections[k], &stack.sections[k + 1]}) {
      const std::size_t base = points.back().size();
      for (const GridPoint p : s->points) points.back().emplace_back(p.x, p.y);
      for (const SectionEdge& e : s->edges) edges.back().emplace_back(base + e.a, base + e.b);
    }
  }
  for (auto _ : state)
    for (std::size_t k = 0; k < points.size(); ++k) {
      Cdt cdt;
      cdt.insert_constraints(points[k].begin(), points[k].end(), edges[k].begin(), edges[k].end());
      benchmark::DoNotOptimize(cdt.number_of_faces());
    }
}

void stitch(benchmark::State& state, int threads) {
  const Stack input = organ(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  StitchOptions options;
  options.threads = threads;
  Monitor quiet;
  std::size_t triangles = 0;
  for (auto _ : state) {
    state.PauseTiming();
    Stack stack = input;
    state.ResumeTiming();
    triangles = stitch_sections(stack, options, quiet).complex.triangles.size();
  }
  state.counters["triangles"] = static_cast<double>(triangles);
}

void StitchOneThread(benchmark::State& state) {
  stitch(state, 1);
}
void StitchTwoThreads(benchmark::State& state) {
  stitch(state, 2);
}
void StitchLinear(benchmark::State& state) {
  stitch(state, 1);
}

BENCHMARK(FloorCdt)->Apply(sizes);
BENCHMARK(StitchOneThread)->Apply(sizes);
BENCHMARK(StitchTwoThreads)->Apply(sizes)->UseRealTime();
BENCHMARK(StitchLinear)
    ->Args({100, 40000})
    ->Args({200, 80000})
    ->Args({400, 160000})
    ->Args({800, 320000})
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
