#include "fem/ordered_mesh.h"

#include <algorithm>
#include <numeric>

#include "base/error.h"

namespace stackmesh {

TetMesh ordered_mesh(const TetMesh& mesh) {
  std::vector<std::size_t> order(mesh.tets.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return mesh.labels[a] < mesh.labels[b]; });
  std::vector<std::int32_t> number(mesh.points.size(), -1);
  const auto use = [&](std::int32_t v) {
    if (v < 0 || static_cast<std::size_t>(v) >= number.size()) fail_internal("a tetrahedron names point " + std::to_string(v), "solver model");
    number[v] = 0;
  };
  for (const auto& t : mesh.tets)
    for (const std::int32_t v : t) use(v);
  for (const auto& t : mesh.mid)
    for (const std::int32_t v : t) use(v);
  TetMesh out;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] < 0) continue;
    number[i] = static_cast<std::int32_t>(out.points.size());
    out.points.push_back(mesh.points[i]);
  }
  out.tets.reserve(mesh.tets.size());
  out.labels.reserve(mesh.tets.size());
  for (const std::size_t t : order) {
    out.tets.push_back(mesh.tets[t]);
    for (std::int32_t& v : out.tets.back()) v = number[v];
    out.labels.push_back(mesh.labels[t]);
    if (mesh.mid.empty()) continue;
    out.mid.push_back(mesh.mid[t]);
    for (std::int32_t& v : out.mid.back()) v = number[v];
  }
  for (InterfaceTriangle f : mesh.faces) {
    bool there = true;
    for (std::int32_t& v : f.v) {
      there = there && v >= 0 && static_cast<std::size_t>(v) < number.size() && number[v] >= 0;
      if (there) v = number[v];
    }
    if (there) out.faces.push_back(f);
  }
  return out;
}

}  // namespace stackmesh
