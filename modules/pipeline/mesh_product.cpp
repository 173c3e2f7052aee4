#include "pipeline/mesh_product.h"

#include <utility>

namespace stackmesh {

void to_ras(std::vector<Vec3>& points) {
  for (Vec3& p : points) {
    p.x = -p.x;
    p.y = -p.y;
  }
}

MeshProduct mesh_product(TetMesh mesh, std::vector<LabelInfo> labels, WorldSpace space, Vec3 up, const LabelVolume* volume) {
  MeshProduct product;
  product.mesh = std::move(mesh);
  product.labels = std::move(labels);
  product.space = space;
  product.up = up;
  if (volume != nullptr) {
    ImageBox box;
    box.origin = volume->world(-0.5, -0.5, -0.5);
    box.axes = volume->axes;
    box.spacing_mm = volume->spacing_mm;
    for (int d = 0; d < 3; ++d) box.length_mm[d] = volume->spacing_mm[d] * volume->size[d];
    product.image = box;
  }
  if (space != WorldSpace::ras) return product;
  to_ras(product.mesh.points);
  std::vector<Vec3> turned = {product.up};
  if (product.image) turned.insert(turned.end(), {product.image->origin, product.image->axes[0], product.image->axes[1], product.image->axes[2]});
  to_ras(turned);
  product.up = turned[0];
  if (product.image) {
    product.image->origin = turned[1];
    for (int d = 0; d < 3; ++d) product.image->axes[d] = turned[2 + d];
  }
  return product;
}

}  // namespace stackmesh
