#include "volume/layer_levels.h"

#include <numeric>

namespace stackmesh::volume {

LayerLevels::LayerLevels(const TetMesh& mesh)
    : top(mesh.points.size()), share(mesh.points.size(), 1), any(!mesh.wedges.empty()) {
  std::iota(top.begin(), top.end(), 0);
  if (!any) return;
  std::vector<std::int32_t> over(mesh.points.size(), -1), under(mesh.points.size(), -1);
  for (const auto& w : mesh.wedges)
    for (int k = 0; k < 3; ++k)
      if (w[k] != w[k + 3]) over[w[k + 3]] = w[k], under[w[k]] = w[k + 3];
  for (std::size_t p = 0; p < top.size(); ++p) {
    if (over[p] >= 0 || under[p] < 0) continue;
    int count = 0;
    for (std::int32_t at = under[p]; at >= 0; at = under[at]) ++count;
    int level = 0;
    for (std::int32_t at = under[p]; at >= 0; at = under[at]) {
      top[at] = static_cast<std::int32_t>(p);
      share[at] = 1 - static_cast<double>(++level) / count;
    }
  }
}

}  // namespace stackmesh::volume
