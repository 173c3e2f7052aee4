// The second example of docs/library.md: drawn contours in memory to a closed surface in memory.
#include <stackmesh/mesh.h>

#include <cmath>
#include <cstdio>

int main() {
  using namespace stackmesh;
  LabelContours rod;
  rod.label = 1;
  rod.name = "rod";
  for (int k = 0; k <= 10; ++k) {
    ContourPolygon circle;
    for (int i = 0; i < 48; ++i) circle.points.push_back({5 * std::cos(i * 0.1308997), 5 * std::sin(i * 0.1308997)});
    rod.sections.push_back({2.0 * k, {circle}});
  }
  MeshOptions options;
  options.target = Target::surface;
  options.stitch.caps = Caps::flat;
  const LabelMesh mesh = mesh_contours({rod}, options);
  const double mm3 = mesh.surface_check.labels.at(0).volume_mm3;
  std::printf("drawn: %zu triangles, %.1f mm3\n", mesh.surface.triangles.size(), mm3);
  return mesh.surface_check.open_edges == 0 && std::abs(mm3 / (3.14159265 * 25 * 20) - 1) < 0.01 ? 0 : 1;
}
