#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "model/complex.h"
#include "model/geometry.h"

namespace stackmesh {

/// The edges of a tet by its corners, in the order of the mid-side nodes of a 10-node tet (as VTK, Abaqus and
/// CalculiX number them).
constexpr int kTetEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

/// The edges of a wedge by its corners, in the order of the mid-side nodes of a 15-node wedge (as VTK, Abaqus and
/// CalculiX number them).
constexpr int kWedgeEdges[9][2] = {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}};

/// A tetrahedral mesh with a label per element, and the interface triangles it was filled from or keeps. Layers under
/// outer faces are wedges; elements are counted through: the tets first, then the wedges.
struct TetMesh {
  std::vector<Vec3> points;                       ///< mm; the points of the complex come first, unchanged
  std::vector<std::array<std::int32_t, 4>> tets;  ///< det(b-a, c-a, d-a) > 0
  std::vector<Label> labels;                      ///< one per element (tets, then wedges), never 0
  std::vector<InterfaceTriangle> faces;           ///< interface and boundary triangles
  std::vector<std::array<std::int32_t, 6>> mid;   ///< second order: the point on each edge, kTetEdges; else empty
  /// Corners 0 1 2, seen from 3 4 5 anticlockwise, and the corners over each of them. Where 2 and 5 are one point it is
  /// a pyramid with the base 0 3 4 1: a layer ends in them.
  std::vector<std::array<std::int32_t, 6>> wedges = {};
  /// second order: the point on each edge, kWedgeEdges (of a pyramid the last is its corner 2)
  std::vector<std::array<std::int32_t, 9>> wedge_mid = {};
  Space space = Space::stack;  ///< of the points; model/space.h brings them to another

  /// Tets and wedges together.
  std::size_t elements() const { return tets.size() + wedges.size(); }
  /// Whether the element of that number is a wedge or a pyramid; its place in `wedges` is element - tets.size().
  bool is_wedge(std::size_t element) const { return element >= tets.size(); }
};

inline bool is_pyramid(const std::array<std::int32_t, 6>& wedge) {
  return wedge[2] == wedge[5];
}

/// Visits the corners of an element (of a pyramid one of them twice).
template <class Mesh, class Visit>
void each_corner(Mesh& mesh, std::size_t element, Visit visit) {
  if (!mesh.is_wedge(element)) {
    for (auto& v : mesh.tets[element]) visit(v);
  } else {
    for (auto& v : mesh.wedges[element - mesh.tets.size()]) visit(v);
  }
}
/// And its mid-side nodes.
template <class Mesh, class Visit>
void each_node(Mesh& mesh, std::size_t element, Visit visit) {
  each_corner(mesh, element, visit);
  if (!mesh.is_wedge(element)) {
    if (!mesh.mid.empty())
      for (auto& v : mesh.mid[element]) visit(v);
  } else if (!mesh.wedge_mid.empty()) {
    for (auto& v : mesh.wedge_mid[element - mesh.tets.size()]) visit(v);
  }
}

/// The tets that a wedge is divided into: each side along the diagonal from its smallest point number, so that
/// neighbours agree.
/// @return two (of a pyramid) or three
std::vector<std::array<std::int32_t, 4>> tets_of_wedge(const std::array<std::int32_t, 6>& wedge);

/// An element as tets of its corners: itself, or those of tets_of_wedge().
inline std::vector<std::array<std::int32_t, 4>> tets_of_element(const TetMesh& mesh, std::size_t element) {
  if (!mesh.is_wedge(element)) return {mesh.tets[element]};
  return tets_of_wedge(mesh.wedges[element - mesh.tets.size()]);
}

/// The mesh with each wedge as two or three tets (linear). The tets come first, unchanged.
TetMesh with_tets_only(const TetMesh& mesh);

/// Gives every element the label that `of` makes of its own; those with 0 go.
template <class Of>
void relabel(TetMesh& mesh, Of of) {
  std::size_t tets = 0, wedges = 0, kept = 0;
  const std::size_t first_wedge = mesh.tets.size(), all = mesh.elements();
  for (std::size_t e = 0; e < all; ++e) {
    const Label label = of(mesh.labels[e]);
    if (label == 0) continue;
    if (e < first_wedge) {
      mesh.tets[tets] = mesh.tets[e];
      if (!mesh.mid.empty()) mesh.mid[tets] = mesh.mid[e];
      ++tets;
    } else {
      mesh.wedges[wedges] = mesh.wedges[e - first_wedge];
      if (!mesh.wedge_mid.empty()) mesh.wedge_mid[wedges] = mesh.wedge_mid[e - first_wedge];
      ++wedges;
    }
    mesh.labels[kept++] = label;
  }
  mesh.tets.resize(tets), mesh.wedges.resize(wedges), mesh.labels.resize(kept);
  if (!mesh.mid.empty()) mesh.mid.resize(tets);
  if (!mesh.wedge_mid.empty()) mesh.wedge_mid.resize(wedges);
}

/// A mirrored wedge is positive again: corners 0 and 1 change places, 3 and 4 too.
inline void turn_wedge_round(TetMesh& mesh, std::size_t wedge) {
  auto& w = mesh.wedges[wedge];
  std::swap(w[0], w[1]);
  std::swap(w[3], w[4]);
  if (mesh.wedge_mid.empty()) return;
  auto& m = mesh.wedge_mid[wedge];
  std::swap(m[1], m[2]);
  std::swap(m[4], m[5]);
  std::swap(m[6], m[7]);
}

/// Exchanges corners 2 and 3 of a tet, and its mid-side nodes with them: a mirrored tet is positive again.
inline void turn_round(TetMesh& mesh, std::size_t tet) {
  std::swap(mesh.tets[tet][2], mesh.tets[tet][3]);
  if (mesh.mid.empty()) return;
  std::swap(mesh.mid[tet][1], mesh.mid[tet][4]);
  std::swap(mesh.mid[tet][2], mesh.mid[tet][3]);
}

/// All elements of a mirrored mesh.
inline void turn_all_round(TetMesh& mesh) {
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) turn_round(mesh, t);
  for (std::size_t w = 0; w < mesh.wedges.size(); ++w) turn_wedge_round(mesh, w);
}

}  // namespace stackmesh
