// The example of docs/library.md: labels in memory to tetrahedra in memory.
#include <stackmesh/mesh.h>

#include <cmath>
#include <cstdio>
#include <vector>

int main() {
  using namespace stackmesh;
  // A ball (2) in a shell (7), 32 x 32 x 16 voxels of 1 x 1 x 2 mm; x runs fastest.
  std::vector<Label> labels;
  for (int k = 0; k < 16; ++k)
    for (int j = 0; j < 32; ++j)
      for (int i = 0; i < 32; ++i) {
        const double r = std::hypot(i - 15.5, j - 15.5, 2 * (k - 7.5));
        labels.push_back(r < 8 ? 2 : r < 13 ? 7 : 0);
      }
  LabelVolume volume = volume_of_labels(labels, {32, 32, 16}, {1, 1, 2});
  volume.origin_mm = {-15.5, -15.5, -15};  // the centre of the first voxel

  MeshOptions options;
  options.enhancement.edge_length_mm = 2.5;
  try {
    const LabelMesh mesh = mesh_labels(volume, options);
    double mm3[8] = {};
    for (std::size_t t = 0; t < mesh.tets->tets.size(); ++t) {
      const auto& v = mesh.tets->tets[t];
      const Vec3 a = mesh.tets->points[v[0]], b = mesh.tets->points[v[1]] - a, c = mesh.tets->points[v[2]] - a,
                 d = mesh.tets->points[v[3]] - a;
      mm3[mesh.tets->labels[t]] += dot(b, cross(c, d)) / 6;
    }
    std::printf("labels: %zu tetrahedra, ball %.0f mm3, shell %.0f mm3, stackmesh %s\n", mesh.tets->tets.size(), mm3[2],
                mm3[7], STACKMESH_VERSION_TEXT);
    return std::abs(mm3[2] / mesh.input_volume_mm3.at(2) - 1) < 0.005 && mesh.surface_check.self_intersections == 0 ? 0
                                                                                                                    : 1;
  } catch (const Error& e) {
    std::fprintf(stderr, "%s\n  where: %s\n  what to do: %s\n", e.problem().c_str(), e.where().c_str(),
                 e.mend().c_str());
    return 1;
  }
}
