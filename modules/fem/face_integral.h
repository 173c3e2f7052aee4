#pragma once
// Private to fem: integrals over the faces of a set, by the elements' own shape functions.
#include <array>
#include <functional>
#include <vector>

#include "model/solver_model.h"

namespace stackmesh {

/// A point of integration on a face.
struct FacePoint {
  std::array<std::int32_t, 6> nodes;  ///< of its face; -1 behind the third in a linear mesh
  std::array<double, 6> shape;        ///< their shape functions here
  Vec3 position;
  Vec3 area;  ///< outward; its length is the point's share of the area (mm2)
};

/// Seven points a face, exact to the fifth order on a plane one.
void visit_face_points(const TetMesh& mesh, const std::vector<TetFace>& faces,
                       const std::function<void(const FacePoint&)>& visit);

}  // namespace stackmesh
