#include "fem/split_parts.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

namespace stackmesh {

std::vector<std::int32_t> split_parts(TetMesh& mesh, const std::vector<int>& part_of) {
  constexpr int nobody = -1;
  std::vector<int> owner(mesh.points.size(), nobody);
  for (std::size_t t = 0; t < mesh.elements(); ++t)
    each_node(mesh, t,
              [&](std::int32_t& v) { owner[v] = owner[v] == nobody ? part_of[t] : std::min(owner[v], part_of[t]); });
  std::vector<std::int32_t> original(mesh.points.size());
  std::iota(original.begin(), original.end(), 0);
  std::map<std::pair<std::int32_t, int>, std::int32_t> copies;  // ordered: numbers do not depend on the tets' order
  for (std::size_t t = 0; t < mesh.elements(); ++t)
    each_node(mesh, t, [&](std::int32_t& v) {
      if (part_of[t] != owner[v]) copies.insert({{v, part_of[t]}, 0});
    });
  for (auto& [key, node] : copies) {
    node = static_cast<std::int32_t>(mesh.points.size());
    mesh.points.push_back(mesh.points[key.first]);
    original.push_back(key.first);
  }
  for (std::size_t t = 0; t < mesh.elements(); ++t)
    each_node(mesh, t, [&](std::int32_t& v) {
      if (part_of[t] != owner[v]) v = copies.at({v, part_of[t]});
    });
  return original;
}

std::size_t join_equal_nodes(TetMesh& mesh) {
  std::vector<std::int32_t> order(mesh.points.size()), first(mesh.points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](std::int32_t v) { return std::tie(mesh.points[v].x, mesh.points[v].y, mesh.points[v].z); };
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
  std::vector<char> joined(mesh.points.size(), 0);
  const auto join = [&](auto& nodes) {
    for (std::int32_t& v : nodes) {
      joined[v] = first[v] != v;
      v = first[v];
    }
  };
  for (auto& t : mesh.tets) join(t);
  for (auto& t : mesh.mid) join(t);
  for (auto& t : mesh.wedges) join(t);
  for (auto& t : mesh.wedge_mid) join(t);
  for (InterfaceTriangle& t : mesh.faces) join(t.v);
  return static_cast<std::size_t>(std::count(joined.begin(), joined.end(), 1));
}

}  // namespace stackmesh
