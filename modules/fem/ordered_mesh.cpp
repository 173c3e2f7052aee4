#include "fem/ordered_mesh.h"

#include <algorithm>
#include <numeric>

#include "base/error.h"

namespace stackmesh {

TetMesh ordered_mesh(const TetMesh& mesh) {
  std::vector<std::size_t> order(mesh.elements());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto by_label = [&](std::size_t a, std::size_t b) { return mesh.labels[a] < mesh.labels[b]; };
  const auto first_wedge = order.begin() + static_cast<std::ptrdiff_t>(mesh.tets.size());
  std::stable_sort(order.begin(), first_wedge, by_label);
  std::stable_sort(first_wedge, order.end(), by_label);
  std::vector<std::int32_t> number(mesh.points.size(), -1);
  for (const std::size_t e : order)
    each_node(mesh, e, [&](std::int32_t v) {
      if (v < 0 || static_cast<std::size_t>(v) >= number.size())
        fail_internal("an element names point " + std::to_string(v), "solver model");
      number[v] = 0;
    });
  TetMesh out;
  out.space = mesh.space;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] < 0) continue;
    number[i] = static_cast<std::int32_t>(out.points.size());
    out.points.push_back(mesh.points[i]);
  }
  const auto take = [&](const auto& from, std::size_t i, auto& to) {
    to.push_back(from[i]);
    for (std::int32_t& v : to.back()) v = number[v];
  };
  out.tets.reserve(mesh.tets.size());
  out.labels.reserve(mesh.elements());
  for (const std::size_t e : order) {
    out.labels.push_back(mesh.labels[e]);
    if (!mesh.is_wedge(e)) {
      take(mesh.tets, e, out.tets);
      if (!mesh.mid.empty()) take(mesh.mid, e, out.mid);
      continue;
    }
    take(mesh.wedges, e - mesh.tets.size(), out.wedges);
    if (!mesh.wedge_mid.empty()) take(mesh.wedge_mid, e - mesh.tets.size(), out.wedge_mid);
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
