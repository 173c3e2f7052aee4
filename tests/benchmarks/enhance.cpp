// Smoothing, sizing, remeshing and guard together against CGAL's unguarded isotropic_remeshing (3 iterations, same
// target length) on the same stitched surface in the same run; a series for linearity; one thread against two.
#include "enhance/enhance.h"

#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "image/read_labels.h"
#include "sections/extract.h"
#include "sections/polygons.h"
#include "stitch/stitch.h"

namespace {

using namespace stackmesh;

struct Surface {
  InterfaceComplex complex;
  double pixel_mm = 1, gap_mm = 1, edge_mm = 1;
};

/// A tube with an inner wall that drifts and breathes; `side` sections of 2 `side` vertices, evenly spaced.
const Surface& organ(int side) {
  static std::map<int, Surface> made;
  auto [it, fresh] = made.insert({side, {}});
  if (!fresh) return it->second;
  Surface& s = it->second;
  s.pixel_mm = s.gap_mm = 2 * M_PI * 40 / side;
  s.edge_mm = 2 * s.gap_mm;
  LabelContours file;
  file.path = "organ";
  file.label = 1;
  for (int k = 0; k < side; ++k) {
    ContourSection section;
    section.z_mm = s.gap_mm * k;
    for (const double radius : {40.0, 22.0}) {
      ContourPolygon p;
      for (int i = 0; i < side; ++i) {
        const double a = 2 * M_PI * i / side, z = section.z_mm;
        const double r = radius * (1 + 0.1 * std::sin(3 * a + 0.03 * z) + 0.03 * std::sin(11 * a - 0.07 * z));
        p.points.push_back({0.1 * z + r * std::cos(a), 5 * std::sin(0.02 * z) + r * std::sin(a)});
      }
      section.polygons.push_back(p);
    }
    file.sections.push_back(section);
  }
  std::vector<Warning> warnings;
  Stack stack = sections_from_contours({file}, warnings);
  Monitor quiet;
  s.complex = stitch_sections(stack, {}, quiet).complex;
  return s;
}

const Surface* heart() {
  static Surface s;
  const std::string path = std::string(STACKMESH_SHARED_DATA) + "/heart_totalseg/heart.nii.gz";
  if (!std::filesystem::exists(path)) return nullptr;
  if (s.complex.points.empty()) {
    Monitor quiet;
    Stack stack = extract_sections(read_label_volume(path), {}, quiet).stack;
    s.pixel_mm = stack.pixel_mm;
    s.gap_mm =
        (stack.sections.back().z_mm - stack.sections.front().z_mm) / static_cast<double>(stack.sections.size() - 1);
    s.complex = stitch_sections(stack, {}, quiet).complex;
    s.edge_mm = 3;
  }
  return &s;
}

/// Side 0 is the heart at 3 mm.
const Surface* surface_of(const benchmark::State& state) {
  return state.range(0) == 0 ? heart() : &organ(static_cast<int>(state.range(0)));
}

void Enhance(benchmark::State& state) {
  const Surface* s = surface_of(state);
  if (!s) return state.SkipWithError("shared data is absent");
  EnhanceOptions o;
  o.pixel_mm = s->pixel_mm;
  o.gap_mm = s->gap_mm;
  o.edge_length_mm = s->edge_mm;
  o.threads = static_cast<int>(state.range(1));
  std::size_t triangles = 0;
  for (auto _ : state) {
    Monitor quiet;
    triangles = enhance_complex(s->complex, o, quiet).complex.triangles.size();
  }
  state.counters["from"] = static_cast<double>(s->complex.triangles.size());
  state.counters["to"] = static_cast<double>(triangles);
}

void CgalIsotropicRemeshing(benchmark::State& state) {
  namespace pmp = CGAL::Polygon_mesh_processing;
  using Point = CGAL::Simple_cartesian<double>::Point_3;
  const Surface* s = surface_of(state);
  if (!s) return state.SkipWithError("shared data is absent");
  std::vector<Point> points;
  std::vector<std::array<std::size_t, 3>> faces;
  for (const Vec3& p : s->complex.points) points.emplace_back(p.x, p.y, p.z);
  for (const InterfaceTriangle& t : s->complex.triangles) {
    std::array<std::size_t, 3> f = {static_cast<std::size_t>(t.v[0]), static_cast<std::size_t>(t.v[1]),
                                    static_cast<std::size_t>(t.v[2])};
    if (t.below == 0) std::swap(f[1], f[2]);
    faces.push_back(f);
  }
  pmp::orient_polygon_soup(points, faces);
  CGAL::Surface_mesh<Point> whole;
  pmp::polygon_soup_to_polygon_mesh(points, faces, whole);
  std::size_t triangles = 0;
  for (auto _ : state) {
    CGAL::Surface_mesh<Point> mesh = whole;
    pmp::isotropic_remeshing(mesh.faces(), s->edge_mm, mesh, CGAL::parameters::number_of_iterations(3));
    triangles = mesh.number_of_faces();
  }
  state.counters["from"] = static_cast<double>(s->complex.triangles.size());
  state.counters["to"] = static_cast<double>(triangles);
}

BENCHMARK(CgalIsotropicRemeshing)->Arg(0)->Arg(50)->Arg(158)->Unit(benchmark::kMillisecond);
BENCHMARK(Enhance)
    ->Args({0, 1})
    ->Args({0, 2})
    ->Args({50, 1})
    ->Args({158, 1})
    ->Args({158, 2})
    ->Args({500, 1})
    ->Args({500, 2})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
