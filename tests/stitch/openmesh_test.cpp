// A label's surface as OpenMesh sees it: a halfedge mesh takes only what is manifold, so its refusals, boundaries and
// Euler number judge the stitched shells independently.
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Utils/vector_cast.hh>
#include <cmath>
#include <map>

#include "checks.h"

namespace stackmesh {
namespace {

using namespace testing_support;
using HalfedgeMesh = OpenMesh::TriMesh_ArrayKernelT<>;

/// The label's outward surface; faces that OpenMesh refuses are counted.
HalfedgeMesh shell_of(const InterfaceComplex& complex, Label label, std::size_t& refused) {
  HalfedgeMesh mesh;
  std::map<std::int32_t, HalfedgeMesh::VertexHandle> vertex;
  refused = 0;
  for (const InterfaceTriangle& t : complex.triangles) {
    if (t.below != label && t.above != label) continue;
    std::array<HalfedgeMesh::VertexHandle, 3> v;
    for (int i = 0; i < 3; ++i) {
      const std::int32_t id = t.v[t.below == label ? i : 2 - i];
      const auto [it, fresh] = vertex.emplace(id, HalfedgeMesh::VertexHandle());
      if (fresh) {
        const Vec3 p = complex.points[id];
        it->second = mesh.add_vertex(
            HalfedgeMesh::Point(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)));
      }
      v[i] = it->second;
    }
    if (!mesh.add_face(v[0], v[1], v[2]).is_valid()) ++refused;
  }
  return mesh;
}

/// Two touching organs, one with a cavity, on 2.5 mm slices.
LabelVolume organs() {
  LabelVolume v;
  v.size = {48, 36, 14};
  v.spacing_mm = {1, 1, 2.5};
  v.labels = {{0, ""}, {1, "left"}, {2, "right"}};
  for (int k = 0; k < v.size[2]; ++k)
    for (int j = 0; j < v.size[1]; ++j)
      for (int i = 0; i < v.size[0]; ++i) {
        const auto r = [&](double x, double y) { return std::hypot(std::hypot(i - x, j - y), 2.5 * (k - 6.6)); };
        v.voxels.push_back(r(16.2, 17.7) < 13 ? (r(16.2, 17.7) < 5 ? 0 : 1) : r(31.4, 18.3) < 11 ? 2 : 0);
      }
  return v;
}

TEST(LabelShells, AreManifoldAndClosedForOpenMesh) {
  const Stitched s = stitch_volume(organs(), 0.5);
  const SurfaceCheck check = check_surface(s.complex());
  EXPECT_EQ(check.nonmanifold_edges, 0u);
  for (const Label label : {1, 2}) {
    std::size_t refused = 0;
    const HalfedgeMesh mesh = shell_of(s.complex(), label, refused);
    EXPECT_EQ(refused, 0u) << "label " << label;
    std::size_t boundary = 0;
    for (const auto e : mesh.edges()) boundary += mesh.is_boundary(e) ? 1 : 0;
    EXPECT_EQ(boundary, 0u) << "label " << label;
    const long euler =
        static_cast<long>(mesh.n_vertices()) - static_cast<long>(mesh.n_edges()) + static_cast<long>(mesh.n_faces());
    EXPECT_EQ(euler, surface_of(check, label).euler);
    EXPECT_EQ(euler, label == 1 ? 4 : 2);  // the left organ has a cavity
  }
}

TEST(LabelShells, OpenMeshRefusesFacesJustWhereTheJudgeCountsNonManifoldEdges) {
  const Stitched s = stitch_volume(organs(), 0);  // raw cracks: corners that touch are not drawn apart
  std::size_t refused = 0;
  for (const Label label : {1, 2}) {
    std::size_t of_label = 0;
    shell_of(s.complex(), label, of_label);
    refused += of_label;
  }
  EXPECT_EQ(refused > 0, check_surface(s.complex()).nonmanifold_edges > 0);
}

}  // namespace
}  // namespace stackmesh
