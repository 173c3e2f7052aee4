#include "run/mesh_product.h"

#include <utility>

#include "model/space.h"

namespace stackmesh {

MeshProduct mesh_product(TetMesh mesh, std::vector<LabelInfo> labels, Space to, Vec3 up, const LabelVolume* volume) {
  MeshProduct product;
  product.up = in_space(up, mesh.space, to);
  if (volume != nullptr) {
    ImageBox box;
    box.origin = in_space(volume->world(-0.5, -0.5, -0.5), mesh.space, to);
    for (int d = 0; d < 3; ++d) {
      box.axes[d] = in_space(volume->axes[d], mesh.space, to);
      box.length_mm[d] = volume->spacing_mm[d] * volume->size[d];
    }
    box.spacing_mm = volume->spacing_mm;
    product.image = box;
  }
  change_space(mesh, to);
  product.mesh = std::move(mesh);
  product.labels = std::move(labels);
  return product;
}

}  // namespace stackmesh
