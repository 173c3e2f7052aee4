#include "model/tet_mesh.h"

#include <algorithm>

namespace stackmesh {

std::vector<std::array<std::int32_t, 4>> tets_of_wedge(const std::array<std::int32_t, 6>& w) {
  if (is_pyramid(w)) {  // base 0 3 4 1, apex 2
    const std::int32_t least = std::min({w[0], w[1], w[3], w[4]});
    if (least == w[0] || least == w[4]) return {{w[0], w[1], w[2], w[4]}, {w[0], w[4], w[2], w[3]}};
    return {{w[0], w[1], w[2], w[3]}, {w[1], w[4], w[2], w[3]}};
  }
  // Turned so that the smallest is corner 0; the side opposite decides for itself (dompierre1999).
  static constexpr int kTurned[6][6] = {{0, 1, 2, 3, 4, 5}, {1, 2, 0, 4, 5, 3}, {2, 0, 1, 5, 3, 4},
                                        {3, 5, 4, 0, 2, 1}, {4, 3, 5, 1, 0, 2}, {5, 4, 3, 2, 1, 0}};
  const auto at = std::min_element(w.begin(), w.end()) - w.begin();
  std::array<std::int32_t, 6> v;
  for (int k = 0; k < 6; ++k) v[k] = w[kTurned[at][k]];
  if (std::min(v[1], v[5]) < std::min(v[2], v[4]))
    return {{v[0], v[1], v[2], v[5]}, {v[0], v[1], v[5], v[4]}, {v[0], v[4], v[5], v[3]}};
  return {{v[0], v[1], v[2], v[4]}, {v[0], v[4], v[2], v[5]}, {v[0], v[4], v[5], v[3]}};
}

TetMesh with_tets_only(const TetMesh& mesh) {
  TetMesh out;
  out.points = mesh.points;
  out.tets = mesh.tets;
  out.faces = mesh.faces;
  out.space = mesh.space;
  out.labels.assign(mesh.labels.begin(), mesh.labels.begin() + static_cast<std::ptrdiff_t>(mesh.tets.size()));
  for (std::size_t i = 0; i < mesh.wedges.size(); ++i)
    for (const auto& tet : tets_of_wedge(mesh.wedges[i])) {
      out.tets.push_back(tet);
      out.labels.push_back(mesh.labels[mesh.tets.size() + i]);
    }
  return out;
}

}  // namespace stackmesh
