#include "volume/refine_tets.h"

#include <algorithm>
#include <unordered_map>

namespace stackmesh {
namespace {

class Refiner {
 public:
  explicit Refiner(TetMesh mesh) : old_(std::move(mesh)) {
    out_.points = std::move(old_.points);
    out_.tets.reserve(8 * old_.tets.size());
    out_.labels.reserve(8 * old_.tets.size());
    if (!old_.mid.empty()) out_.mid.reserve(8 * old_.tets.size());
    out_.faces.reserve(4 * old_.faces.size());
  }

  TetMesh run() {
    for (std::size_t t = 0; t < old_.tets.size(); ++t) cut(t);
    for (const InterfaceTriangle& f : old_.faces) cut(f);
    return std::move(out_);
  }

 private:
  /// A tet's ten nodes by their barycentric coordinates, in quarters, so that the middle between two of them is exact.
  using Place = std::array<int, 4>;
  static std::uint64_t key(std::int32_t a, std::int32_t b) {
    return static_cast<std::uint64_t>(std::min(a, b)) << 32 | static_cast<std::uint32_t>(std::max(a, b));
  }

  std::int32_t new_point(Vec3 p) {
    out_.points.push_back(p);
    return static_cast<std::int32_t>(out_.points.size()) - 1;
  }

  /// The point on an old edge: the mid-side node where there is one, else its middle.
  std::int32_t middle_of(std::int32_t a, std::int32_t b) {
    const auto [at, fresh] = middles_.insert({key(a, b), 0});
    if (fresh) at->second = new_point(0.5 * (out_.points[std::min(a, b)] + out_.points[std::max(a, b)]));
    return at->second;
  }

  void cut(std::size_t t) {
    std::array<std::int32_t, 10> node;
    std::array<Place, 10> place{};
    for (int k = 0; k < 4; ++k) {
      node[k] = old_.tets[t][k];
      place[k][k] = 4;
    }
    for (int e = 0; e < 6; ++e) {
      const int a = kTetEdges[e][0], b = kTetEdges[e][1];
      if (old_.mid.empty()) node[4 + e] = middle_of(node[a], node[b]);
      else middles_[key(node[a], node[b])] = node[4 + e] = old_.mid[t][e];
      place[4 + e][a] = place[4 + e][b] = 2;
    }
    // Nodes 4 to 9 lie on edges 01 12 02 03 13 23. Corners, then the octahedron about one of its three diagonals.
    static constexpr int corners[4][4] = {{0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3}};
    static constexpr int diagonals[3][2] = {{4, 9}, {5, 7}, {6, 8}};
    // about the diagonal, neighbours in turn
    static constexpr int rings[3][4] = {{5, 6, 7, 8}, {4, 8, 9, 6}, {4, 5, 9, 7}};
    for (const auto& c : corners) add(t, node, place, {c[0], c[1], c[2], c[3]});
    int shortest = 0;
    double least = 0;
    for (int d = 0; d < 3; ++d) {
      const double length = norm(out_.points[node[diagonals[d][1]]] - out_.points[node[diagonals[d][0]]]);
      if (d == 0 || length < least) {
        least = length;
        shortest = d;
      }
    }
    const auto& ring = rings[shortest];
    for (int k = 0; k < 4; ++k)
      add(t, node, place, {diagonals[shortest][0], diagonals[shortest][1], ring[k], ring[(k + 1) % 4]});
  }

  void add(std::size_t t, const std::array<std::int32_t, 10>& node, const std::array<Place, 10>& place,
           std::array<int, 4> c) {
    // Turned by the places within the tet, where it is a straight one: the sign is exact.
    const auto d = [&](int k, int axis) { return place[c[k]][axis + 1] - place[c[0]][axis + 1]; };
    const int det = d(1, 0) * (d(2, 1) * d(3, 2) - d(2, 2) * d(3, 1)) -
                    d(1, 1) * (d(2, 0) * d(3, 2) - d(2, 2) * d(3, 0)) +
                    d(1, 2) * (d(2, 0) * d(3, 1) - d(2, 1) * d(3, 0));
    if (det < 0) std::swap(c[2], c[3]);
    out_.tets.push_back({node[c[0]], node[c[1]], node[c[2]], node[c[3]]});
    out_.labels.push_back(old_.labels[t]);
    if (old_.mid.empty()) return;
    std::array<std::int32_t, 6> mid;
    for (int e = 0; e < 6; ++e) {
      const int a = c[kTetEdges[e][0]], b = c[kTetEdges[e][1]];
      const auto [at, fresh] = halves_.insert({key(node[a], node[b]), 0});
      if (fresh) {
        std::array<double, 4> l;
        for (int k = 0; k < 4; ++k) l[k] = (place[a][k] + place[b][k]) / 8.0;
        Vec3 p;
        for (int k = 0; k < 4; ++k) p = p + (l[k] * (2 * l[k] - 1)) * out_.points[node[k]];
        for (int k = 0; k < 6; ++k) p = p + (4 * l[kTetEdges[k][0]] * l[kTetEdges[k][1]]) * out_.points[node[4 + k]];
        at->second = new_point(p);
      }
      mid[e] = at->second;
    }
    out_.mid.push_back(mid);
  }

  void cut(const InterfaceTriangle& f) {
    std::array<std::int32_t, 3> m;
    for (int k = 0; k < 3; ++k) m[k] = middle_of(f.v[k], f.v[(k + 1) % 3]);
    const std::array<std::int32_t, 3> parts[4] = {
        {f.v[0], m[0], m[2]}, {m[0], f.v[1], m[1]}, {m[2], m[1], f.v[2]}, {m[0], m[1], m[2]}};
    for (const auto& v : parts) {
      InterfaceTriangle part = f;
      part.v = v;
      out_.faces.push_back(part);
    }
  }

  TetMesh old_, out_;
  std::unordered_map<std::uint64_t, std::int32_t> middles_, halves_;  // by the edge's ends; numbered as they are met
};

}  // namespace

TetMesh refine_tets(TetMesh mesh, int times) {
  for (int i = 0; i < times; ++i) mesh = Refiner(std::move(mesh)).run();
  return mesh;
}

InterfaceComplex surface_of(const TetMesh& mesh) {
  std::vector<std::int32_t> number(mesh.points.size(), -1);
  for (const InterfaceTriangle& f : mesh.faces)
    for (const std::int32_t v : f.v) number[v] = 0;
  InterfaceComplex surface;
  surface.space = mesh.space;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<std::int32_t>(surface.points.size());
    surface.points.push_back(mesh.points[v]);
  }
  surface.triangles = mesh.faces;
  for (InterfaceTriangle& f : surface.triangles)
    for (std::int32_t& v : f.v) v = number[v];
  return surface;
}

}  // namespace stackmesh
