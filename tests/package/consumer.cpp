// Uses the installed headers and libraries: a box of voxels to a closed surface.
#include <sections/extract.h>
#include <stitch/stitch.h>
#include <validate/check_surface.h>

#include <cmath>
#include <cstdio>

int main() {
  stackmesh::LabelVolume volume;
  volume.size = {4, 4, 3};
  volume.labels = {{0, ""}, {7, "box"}};
  volume.voxels.assign(4 * 4 * 3, 0);
  for (int k = 0; k < 3; ++k)
    for (int j = 1; j < 3; ++j)
      for (int i = 1; i < 3; ++i) volume.voxels[volume.index(i, j, k)] = 1;
  stackmesh::Monitor quiet;
  stackmesh::Stack stack = stackmesh::extract_sections(volume, {}, quiet).stack;
  const stackmesh::StitchResult result = stackmesh::stitch_sections(stack, {}, quiet);
  const stackmesh::SurfaceCheck check = stackmesh::check_surface(result.complex);
  const double volume_mm3 = check.labels.at(0).volume_mm3;
  std::printf("consumer: %zu triangles, %g mm3\n", check.triangles, volume_mm3);
  return check.open_edges == 0 && check.self_intersections == 0 && std::abs(volume_mm3 - 12) < 1e-9 ? 0 : 1;
}
