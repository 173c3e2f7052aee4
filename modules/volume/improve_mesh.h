#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/tet_mesh.h"

namespace stackmesh::volume {

/// A tet mesh that can be changed in place: corners, neighbours opposite the corners, quality. The interface triangles
/// are walls: nothing looks or moves through one, so every label is a mesh of its own.
class ImproveMesh {
 public:
  struct Tet {
    std::array<std::int32_t, 4> v = {-1, -1, -1, -1};
    std::array<std::int32_t, 4> n = {-1, -1, -1, -1};  // -1: a wall
    Label label = 0;
    bool alive() const { return v[0] >= 0; }
    int slot(std::int32_t vertex) const { return v[0] == vertex ? 0 : v[1] == vertex ? 1 : v[2] == vertex ? 2 : 3; }
    bool has(std::int32_t vertex) const { return v[0] == vertex || v[1] == vertex || v[2] == vertex || v[3] == vertex; }
  };
  using Corners = std::array<std::int32_t, 4>;

  /// Points before `kept` and points of walls stay.
  ImproveMesh(const TetMesh& mesh, std::size_t kept);

  std::vector<Vec3> points;
  std::vector<Tet> tets;
  std::vector<double> quality;  // of each tet
  std::vector<char> movable;    // of each point

  double quality_of(const Corners& v) const;
  std::int32_t tet_of(std::int32_t vertex) const { return tet_of_[vertex]; }  // -1: none; any one

  /// The tets around a movable vertex.
  void star(std::int32_t vertex, std::vector<std::int32_t>& tets_around);
  /// The tets around edge (a, b) of tet `t` and the points opposite, so that (a, b, ring[i], ring[i + 1]) is tet i.
  /// False when a wall cuts the ring, or it is longer than `limit`.
  bool ring(std::int32_t t, std::int32_t a, std::int32_t b, std::size_t limit, std::vector<std::int32_t>& around,
            std::vector<std::int32_t>& ring) const;

  /// Puts `fresh` in the place of `old`, which fill the same space; false, and nothing is changed, when they do not
  /// have the same outer faces or a tet of `fresh` is not positive (exactly).
  bool replace(const std::vector<std::int32_t>& old, const std::vector<Corners>& fresh);

  /// From now on points of tets that change are remembered; before it, every point counts as one.
  void begin_changes() { changed_.assign(points.size(), 0); }
  void note_change(std::int32_t tet) {
    if (!changed_.empty())
      for (const std::int32_t p : tets[tet].v) changed_[p] = 1;
  }
  bool near_change(std::int32_t tet) const {
    const Corners& v = tets[tet].v;
    return changed_.empty() || changed_[v[0]] || changed_[v[1]] || changed_[v[2]] || changed_[v[3]];
  }

  std::int32_t add_point(const Vec3& p);
  void drop_last_point();

  /// Marks tets; each call of begin_marks() forgets them.
  void begin_marks() { ++stamp_; }
  void mark(std::int32_t t) { stamps_[t] = stamp_; }
  bool marked(std::int32_t t) const { return stamps_[t] == stamp_; }

  /// Back to plain arrays: live tets in their order, points that no tet uses dropped from `kept` on.
  void give_back(TetMesh& mesh) const;

 private:
  struct Face {
    std::array<std::int32_t, 3> key;
    std::int32_t tet;  // index into `fresh`, or the tet outside (-1: a wall)
    int slot;
    bool fresh;
  };
  static Face face_of(const Corners& v, int slot, std::int32_t tet, bool fresh);

  std::size_t kept_;
  std::vector<std::int32_t> tet_of_, free_;
  std::vector<std::uint32_t> stamps_;
  std::vector<char> changed_;  // of each point
  std::uint32_t stamp_ = 0;
  std::vector<Face> faces_;  // of replace()
  std::vector<std::int32_t> ids_, mate_, stack_;
};

}  // namespace stackmesh::volume
