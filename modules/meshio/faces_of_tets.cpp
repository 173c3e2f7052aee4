#include <algorithm>
#include <utility>

#include "meshio/read_mesh.h"

namespace stackmesh {

TetMesh take_elements(MeshFile& file) {
  TetMesh mesh;
  mesh.points = std::move(file.points);
  mesh.tets = std::move(file.tets);
  mesh.labels = std::move(file.tet_labels);
  mesh.mid = std::move(file.midside);
  mesh.wedges = std::move(file.wedges);
  mesh.wedge_mid = std::move(file.wedge_midside);
  return mesh;
}

TetMesh tet_mesh_of(MeshFile file) {
  TetMesh mesh = take_elements(file);
  mesh.space = file.space.value_or(Space::none);
  mesh.faces = file.triangles.empty() ? faces_of_tets(mesh) : std::move(file.triangles);
  return mesh;
}

std::vector<InterfaceTriangle> faces_of_tets(const TetMesh& mesh) {
  struct Face {
    std::int32_t middle, high, tet;
    bool even;
  };
  static constexpr int kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};    // outwards
  static constexpr int kOfWedge[4][3] = {{0, 2, 1}, {3, 4, 5}, {1, 2, 4}, {2, 0, 3}};  // the last two of a pyramid
  const auto each = [&](auto visit) {
    const auto side = [&](std::int32_t a, std::int32_t b, std::int32_t c, std::size_t element) {
      std::int32_t v[3] = {a, b, c};
      bool even = true;
      const auto order = [&](int i, int j) {
        if (v[i] > v[j]) std::swap(v[i], v[j]), even = !even;
      };
      order(0, 1), order(1, 2), order(0, 1);
      visit(v[0], Face{v[1], v[2], static_cast<std::int32_t>(element), even});
    };
    for (std::size_t t = 0; t < mesh.tets.size(); ++t)
      for (const auto& f : kFaces) side(mesh.tets[t][f[0]], mesh.tets[t][f[1]], mesh.tets[t][f[2]], t);
    for (std::size_t w = 0; w < mesh.wedges.size(); ++w)
      for (int f = 0; f < (is_pyramid(mesh.wedges[w]) ? 4 : 2); ++f)
        side(mesh.wedges[w][kOfWedge[f][0]], mesh.wedges[w][kOfWedge[f][1]], mesh.wedges[w][kOfWedge[f][2]],
             mesh.tets.size() + w);
  };
  std::vector<std::int64_t> start(mesh.points.size() + 1, 0);
  each([&](std::int32_t low, const Face&) { ++start[low + 1]; });
  for (std::size_t p = 0; p < mesh.points.size(); ++p) start[p + 1] += start[p];
  std::vector<Face> faces(static_cast<std::size_t>(start.back()));
  each([&](std::int32_t low, const Face& face) { faces[start[low]++] = face; });

  // start[low] is now where the faces of `low` end.
  std::vector<signed char> against(mesh.elements(), 0);
  const auto groups = [&](auto visit) {
    std::int64_t begin = 0;
    for (std::size_t low = 0; low < mesh.points.size(); ++low) {
      for (std::int64_t i = begin, j; i < start[low]; i = j) {
        for (j = i; j < start[low] && faces[j].middle == faces[i].middle && faces[j].high == faces[i].high; ++j) {
        }
        visit(static_cast<std::int32_t>(low), &faces[i], static_cast<int>(j - i));
      }
      begin = start[low];
    }
  };
  std::int64_t begin = 0;
  for (std::size_t low = 0; low < mesh.points.size(); ++low) {
    std::sort(faces.begin() + begin, faces.begin() + start[low], [](const Face& a, const Face& b) {
      return a.middle != b.middle ? a.middle < b.middle : a.high != b.high ? a.high < b.high : a.tet < b.tet;
    });
    begin = start[low];
  }
  groups([&](std::int32_t, const Face* f, int n) {
    if (n != 2) return;
    const signed char step = f[0].even == f[1].even ? 1 : -1;
    against[f[0].tet] = static_cast<signed char>(against[f[0].tet] + step),
    against[f[1].tet] = static_cast<signed char>(against[f[1].tet] + step);
  });
  std::vector<InterfaceTriangle> result;
  groups([&](std::int32_t low, const Face* f, int n) {
    if (n > 2 || (n == 2 && mesh.labels[f[0].tet] == mesh.labels[f[1].tet])) return;
    InterfaceTriangle t;
    const Face& from = n == 2 && against[f[0].tet] > 0 ? f[1] : f[0];
    const bool outwards = from.even == (against[from.tet] <= 0);
    t.v = {low, outwards ? from.middle : from.high, outwards ? from.high : from.middle};
    t.below = mesh.labels[from.tet];
    t.above = n == 2 ? mesh.labels[(&from == &f[0] ? f[1] : f[0]).tet] : 0;
    result.push_back(t);
  });
  return result;
}

}  // namespace stackmesh
