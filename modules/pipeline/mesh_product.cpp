#include "pipeline/mesh_product.h"

#include <utility>

namespace stackmesh {

void to_ras(std::vector<Vec3>& points) {
  for (Vec3& p : points) p = {-p.x, -p.y, p.z};
}

MeshProduct make_product(TetMesh mesh, const Input& input, Vec3 up, WorldSpace world) {
  MeshProduct product;
  product.mesh = std::move(mesh);
  product.labels = input.labels;
  product.space = world;
  product.up = up;
  if (input.volume) {
    const LabelVolume& v = *input.volume;
    ImageBox box;
    box.origin = v.world(-0.5, -0.5, -0.5);
    box.axes = v.axes;
    box.spacing_mm = v.spacing_mm;
    for (int d = 0; d < 3; ++d) box.length_mm[d] = v.spacing_mm[d] * v.size[d];
    product.image = box;
  }
  if (world != WorldSpace::ras) return product;
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
