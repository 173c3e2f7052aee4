#include "fem/boundary_faces.h"

#include <algorithm>

#include "base/error.h"

namespace stackmesh {

std::array<std::int32_t, 6> outward_nodes(const TetMesh& mesh, TetFace face) {
  return outward_face_of(mesh, face);
}

std::vector<BoundaryFace> boundary_faces(const TetMesh& mesh) {
  const auto place = [](TetFace f) { return f.tet * 4 + f.face; };
  struct Side {
    std::array<std::int32_t, 3> key;
    TetFace at;
  };
  std::vector<Side> sides;
  sides.reserve(4 * mesh.tets.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (int f = 0; f < 4; ++f) {
      Side s{{}, {static_cast<std::int32_t>(t), f}};
      for (int k = 0; k < 3; ++k) s.key[k] = mesh.tets[t][kTetFaces[f][k]];
      std::sort(s.key.begin(), s.key.end());
      sides.push_back(s);
    }
  // Of wedges the two triangles; their other sides, and those of pyramids, lie within a layer. Pyramids' triangles
  // there are counted, as tets stand on them.
  for (std::size_t w = 0; w < mesh.wedges.size(); ++w) {
    const auto& v = mesh.wedges[w];
    const auto element = static_cast<std::int32_t>(mesh.tets.size() + w);
    const auto add_side = [&](std::int32_t a, std::int32_t b, std::int32_t c, int face) {
      Side s{{a, b, c}, {element, face}};
      std::sort(s.key.begin(), s.key.end());
      sides.push_back(s);
    };
    for (int f = 0; f < 2; ++f) add_side(v[kWedgeFaces[f][0]], v[kWedgeFaces[f][1]], v[kWedgeFaces[f][2]], f);
    if (is_pyramid(v)) add_side(v[1], v[2], v[4], 2), add_side(v[2], v[0], v[3], 3);
  }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return a.key != b.key ? a.key < b.key : a.at.tet < b.at.tet; });

  std::vector<BoundaryFace> faces;
  const auto add = [&](TetFace at, Label out) {
    if (at.face > 1 && mesh.is_wedge(static_cast<std::size_t>(at.tet)))
      fail_input("a layer of wedges is open at its side", "element " + std::to_string(at.tet + 1),
                 "give a mesh whose layers end in pyramids or tetrahedra");
    BoundaryFace face;
    face.at = at;
    face.in = mesh.labels[at.tet];
    face.out = out;
    const auto nodes = outward_nodes(mesh, at);
    face.v = {nodes[0], nodes[1], nodes[2]};
    const Vec3 a = mesh.points[face.v[0]], b = mesh.points[face.v[1]], c = mesh.points[face.v[2]];
    const Vec3 n = cross(b - a, c - a);
    face.area_mm2 = 0.5 * norm(n);
    face.normal = face.area_mm2 > 0 ? (0.5 / face.area_mm2) * n : Vec3{};
    face.centre = (1.0 / 3) * (a + b + c);
    faces.push_back(face);
  };
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].key == sides[i].key) ++end;
    if (end - i > 2)
      fail_input("more than two elements share a face",
                 "elements " + std::to_string(sides[i].at.tet + 1) + ", " + std::to_string(sides[i + 1].at.tet + 1) +
                     " and " + std::to_string(sides[i + 2].at.tet + 1),
                 "give a conforming mesh");
    if (end - i == 1) {
      add(sides[i].at, 0);
    } else if (mesh.labels[sides[i].at.tet] != mesh.labels[sides[i + 1].at.tet]) {
      add(sides[i].at, mesh.labels[sides[i + 1].at.tet]);
      add(sides[i + 1].at, mesh.labels[sides[i].at.tet]);
      faces[faces.size() - 2].twin = place(sides[i + 1].at);  // a place until indices are known
      faces.back().twin = place(sides[i].at);
    }
    i = end;
  }
  std::sort(faces.begin(), faces.end(),
            [&](const BoundaryFace& a, const BoundaryFace& b) { return place(a.at) < place(b.at); });
  for (BoundaryFace& f : faces) {
    if (f.twin < 0) continue;
    const auto at = std::lower_bound(faces.begin(), faces.end(), f.twin,
                                     [&](const BoundaryFace& a, std::int32_t p) { return place(a.at) < p; });
    f.twin = static_cast<std::int32_t>(at - faces.begin());
  }
  return faces;
}

std::vector<std::int32_t> nodes_of_faces(const TetMesh& mesh, const std::vector<TetFace>& faces) {
  std::vector<std::int32_t> nodes;
  for (const TetFace f : faces)
    for (const std::int32_t v : outward_nodes(mesh, f))
      if (v >= 0) nodes.push_back(v);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

}  // namespace stackmesh
