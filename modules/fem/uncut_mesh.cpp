#include "fem/uncut_mesh.h"

#include <algorithm>

#include "base/error.h"

namespace stackmesh {
namespace {

/// The ten nodes of the tet that eight were cut from: its corners, and the middles of its edges (kTetEdges). The child
/// at corner k has its k-th corner there, and the middles of the edges that end there in the places of their other
/// ends.
std::array<std::int32_t, 10> nodes_before(const TetMesh& mesh, std::size_t block) {
  std::array<std::int32_t, 10> node;
  const auto* child = &mesh.tets[8 * block];
  for (int k = 0; k < 4; ++k) node[k] = child[k][k];
  for (int e = 0; e < 6; ++e) {
    const int a = kTetEdges[e][0], b = kTetEdges[e][1];
    node[4 + e] = child[a][b];
    if (child[b][a] != node[4 + e])
      fail_internal("the tetrahedra from " + std::to_string(8 * block + 1) + " on were not cut from one",
                    "solver model");
  }
  return node;
}

}  // namespace

TetMesh uncut_mesh(const TetMesh& mesh) {
  if (mesh.tets.size() % 8 != 0 || mesh.faces.size() % 4 != 0 || !mesh.wedges.empty())
    fail_internal("the mesh was not cut into eight", "solver model");
  TetMesh out;
  out.space = mesh.space;
  out.points = mesh.points;
  for (std::size_t b = 0; b < mesh.tets.size() / 8; ++b) {
    const auto node = nodes_before(mesh, b);
    out.tets.push_back({node[0], node[1], node[2], node[3]});
    out.labels.push_back(mesh.labels[8 * b]);
    if (!mesh.mid.empty()) out.mid.push_back({node[4], node[5], node[6], node[7], node[8], node[9]});
  }
  for (std::size_t f = 0; f < mesh.faces.size(); f += 4) {
    out.faces.push_back(mesh.faces[f]);
    for (int k = 0; k < 3; ++k) out.faces.back().v[k] = mesh.faces[f + k].v[k];
  }
  return out;
}

std::vector<std::int32_t> uncut_faces(const TetMesh& mesh, const std::vector<BoundaryFace>& faces,
                                      const std::vector<BoundaryFace>& uncut) {
  std::vector<std::int32_t> before(mesh.tets.size() / 2, -1);  // by tet and side
  for (std::size_t i = 0; i < uncut.size(); ++i)
    before[4 * uncut[i].at.tet + uncut[i].at.face] = static_cast<std::int32_t>(i);
  std::vector<std::int32_t> out;
  out.reserve(faces.size());
  for (const BoundaryFace& f : faces) {
    const std::size_t block = static_cast<std::size_t>(f.at.tet) / 8;
    const auto node = nodes_before(mesh, block);
    std::int32_t from = -1;
    for (int side = 0; side < 4 && from < 0; ++side) {
      const auto on_side = [&](std::int32_t v) {
        for (int k = 0; k < 3; ++k)
          if (v == node[kTetFaces[side][k]] || v == node[4 + kTetFaceMids[side][k]]) return true;
        return false;
      };
      if (std::all_of(f.v.begin(), f.v.end(), on_side)) from = before[4 * block + side];
    }
    if (from < 0)
      fail_internal("a face of element " + std::to_string(f.at.tet + 1) + " lies on none of the mesh before it was cut",
                    "solver model");
    out.push_back(from);
  }
  return out;
}

}  // namespace stackmesh
