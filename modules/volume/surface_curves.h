#pragma once
// Private to the module: where the mid-side nodes of a curved surface belong.
#include <cstdint>
#include <vector>

#include "model/tet_mesh.h"

namespace stackmesh::volume {

/// All edges of the elements, each once; numbered by (smaller end, larger end).
struct ElementEdges {
  std::vector<std::int64_t> begin;  // of each point as smaller end
  std::vector<std::int32_t> larger;

  explicit ElementEdges(const TetMesh& mesh);

  /// -1 when no element has it.
  std::int64_t find(std::int32_t a, std::int32_t b) const;
};

/// Where the surface wants the nodes of its edges.
class SurfaceCurves {
 public:
  /// @param ridge_deg edges of sharper dihedral angles are ridges, which are curves of their own
  SurfaceCurves(const TetMesh& mesh, const ElementEdges& edges, double ridge_deg);

  /// The way of each node from the middle of its edge: visit(edge, offset), for edges that are not straight.
  template <class Visit>
  void each_offset(Visit visit) const {
    for (const SurfaceEdge& e : edges_) {
      const Vec3 offset = offset_of(e);
      if (norm(offset) > 1e-12 * norm(mesh_.points[e.q] - mesh_.points[e.p])) visit(e.edge, offset);
    }
  }

  /// How far each point stands off the smooth surface if the flat triangles around it hold the right volume: the mean
  /// height of the surface over a triangle is that of an arc over its edges, averaged over their directions; of a curve
  /// over its chord, two thirds of the largest.
  std::vector<Vec3> stand_off() const;

 private:
  enum class Kind { straight, smooth, curve };
  struct SurfaceEdge {
    std::int64_t edge = 0;
    std::int32_t p = 0, q = 0;        // ends
    std::int32_t side[2] = {-1, -1};  // triangles
    int count = 0;                    // of triangles
    Kind kind = Kind::curve;
  };

  void measure_triangles();
  void collect_edges(const ElementEdges& edges);
  void classify();
  Vec3 offset_of(const SurfaceEdge& e) const;
  std::int32_t root(std::int32_t c);
  void collect_normals();
  void collect_tangents();
  Vec3 across(const SurfaceEdge& e, Vec3 d) const;
  Vec3 along(const SurfaceEdge& e, Vec3 d) const;

  const TetMesh& mesh_;
  const double ridge_cosine_;
  std::vector<Vec3> normals_;  // of triangles, out of the smaller label
  std::vector<char> planes_;   // 1, 2, 3: the triangle lies in a plane across x, y, z
  std::vector<SurfaceEdge> edges_;
  std::vector<std::int32_t> parent_;  // of triangle corners: the smallest of their sheet
  std::vector<Vec3> sheet_normals_, tangents_;
};

}  // namespace stackmesh::volume
