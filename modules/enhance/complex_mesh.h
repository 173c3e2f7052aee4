#pragma once
#include <array>
#include <boost/container/small_vector.hpp>
#include <cstdint>
#include <utility>
#include <vector>

#include "model/complex.h"

namespace stackmesh {

/// A short list of vertices or triangles, kept in place.
using ShortList = boost::container::small_vector<std::int32_t, 8>;

/// A triangle while the complex is changed: its normal points from the smaller label of its pair to the
/// larger. `patch` stands for the label pair and for lying in a flat cap; a dead triangle has patch -1.
struct MeshTriangle {
  std::array<std::int32_t, 3> v = {0, 0, 0};
  std::int32_t patch = -1;
};

/// An interface complex that can be changed. An edge is a *curve* edge when it has other than two triangles,
/// when its two differ in patch, or when it is a ridge. A vertex with no curve edge is free in its sheet, one
/// with two is bound to its curve, any other (and a pinched one) is a fixed point. Operations only change the
/// structure; whether one is allowed is asked of `can_collapse`, `can_flip` and the guard.
class ComplexMesh {
 public:
  ComplexMesh() = default;
  /// `cap_area_mm2`: connected, exactly horizontal triangles of at least this area together are a flat cap.
  /// @param inner_caps false: only the lowest and the highest plane of the complex can hold flat caps
  ComplexMesh(const InterfaceComplex& complex, double cap_area_mm2, int threads = 0, bool inner_caps = true);

  std::vector<Vec3> points;
  std::vector<MeshTriangle> triangles;
  std::vector<ShortList> star;   ///< triangles of each vertex; empty: the vertex is gone
  std::vector<ShortList> curve;  ///< neighbours along curve edges
  std::vector<char> pinned;      ///< never moves, never removed
  std::vector<char> flat;        ///< on a flat cap: keeps its z

  /// Of a part of a larger complex: triangles that may not change, and the box that vertices may not leave. Empty:
  /// none.
  std::vector<char> frozen, held;  ///< held: vertices of a frozen triangle, which may not move or go
  Vec3 low{-1e300, -1e300, -1e300}, high{1e300, 1e300, 1e300};
  bool is_frozen(std::int32_t t) const { return !frozen.empty() && frozen[t]; }
  bool is_held(std::int32_t v) const { return !held.empty() && held[v]; }
  bool contains(const Vec3& p) const {
    return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z && p.z <= high.z;
  }
  /// True for a vertex of a part that is gone or has a triangle which is not frozen.
  bool owned(std::int32_t v) const;
  /// The part with these triangles, those from `free` on frozen; `vertices` are the numbers of its vertices here.
  ComplexMesh part(const std::vector<std::int32_t>& triangles, std::size_t free,
                   std::vector<std::int32_t>& vertices) const;
  /// Numbers vertices and triangles anew without those that are gone, and finds the stars; what is held for each vertex
  /// follows.
  void compact(std::vector<double>& size, std::vector<std::int32_t>& hints);

  bool alive(std::int32_t t) const { return triangles[t].patch >= 0; }
  bool is_fixed(std::int32_t v) const { return pinned[v] || (!curve[v].empty() && curve[v].size() != 2); }
  bool is_curve_edge(std::int32_t a, std::int32_t b) const;
  bool has_edge(std::int32_t a, std::int32_t b) const;
  bool is_cap(std::int32_t patch) const { return patch & 1; }
  std::pair<Label, Label> labels_of(std::int32_t patch) const { return pairs_[patch >> 1]; }

  /// All labels, ascending; patches are below 2 * pair_count(); the two labels of a patch as numbers in `labels()`.
  const std::vector<Label>& labels() const { return labels_; }
  std::size_t pair_count() const { return pairs_.size(); }
  const std::array<std::int32_t, 2>& sides(std::int32_t patch) const { return sides_[patch >> 1]; }

  /// The (one, two or more) triangles of an edge.
  void edge_triangles(std::int32_t a, std::int32_t b, std::vector<std::int32_t>& out) const;
  /// Neighbours of a vertex, ascending.
  void neighbours(std::int32_t v, std::vector<std::int32_t>& out) const;
  /// Fan number of each triangle of v's star: fans are parts of the star not cut by curve edges.
  void fans(std::int32_t v, std::vector<std::int32_t>& out) const;
  /// Neighbours above a in number, ascending: calls visit(b) for each edge a b, a < b, once.
  template <class Visit>
  void edges_from(std::int32_t a, Visit visit) const;
  /// All edges (a < b), ascending.
  std::vector<std::array<std::int32_t, 2>> edges() const;

  /// True when `gone` may be merged into `kept` without changing the topology of any sheet or curve
  /// (link condition; \cite dey1999).
  bool can_collapse(std::int32_t gone, std::int32_t kept) const;
  /// The same for any two neighbours, fixed ones too, asked of the labels: the boundary of each (the outside's as well)
  /// is plain at both, and what holds both holds their edge, and no other common neighbours than the edge's two apexes.
  bool can_merge(std::int32_t gone, std::int32_t kept) const;
  /// Returns the numbers of the triangles that died; those of `gone` that stay now hold `kept`.
  std::vector<std::int32_t> collapse(std::int32_t gone, std::int32_t kept);

  /// The two triangles (in order t0 holds a->b) and their apexes; false for a curve edge or where c d is an
  /// edge.
  bool can_flip(std::int32_t a, std::int32_t b, std::array<std::int32_t, 2>& t,
                std::array<std::int32_t, 2>& apex) const;
  /// Turns the edge of t[0] = (a b c), t[1] = (b a d) into c d.
  void flip(std::int32_t a, std::int32_t b, std::array<std::int32_t, 2> t, std::array<std::int32_t, 2> apex);

  /// Puts a vertex at p on the edge; returns it. Triangles that were added are the last ones.
  std::int32_t split(std::int32_t a, std::int32_t b, const Vec3& p);

  /// Triangle t = (a b c) of a curve edge a b goes, its free corner c joins the curve: every other triangle of the edge
  /// is split at c.
  void absorb(std::int32_t a, std::int32_t b, std::int32_t t);

  /// The triangles of one patch on the side of `start` of the loop of edges a b c: a disc with free vertices only
  /// within. Empty where they are not one, or more than `most`.
  std::vector<std::int32_t> disc_behind(const std::array<std::int32_t, 3>& loop, std::int32_t start,
                                        std::size_t most) const;
  /// Puts triangles over the same loop of edges, no more than the disc has, in its place; they get the numbers of the
  /// disc's first and its direction.
  void replace_disc(const std::vector<std::int32_t>& disc, std::vector<std::array<std::int32_t, 3>> filling);

  /// Makes an edge a ridge (no-op if it is a curve edge already).
  void add_ridge(std::int32_t a, std::int32_t b);
  /// Finds pinched vertices anew.
  void find_pinned(int threads = 0);

  Vec3 area_vector(const std::array<std::int32_t, 3>& v) const {
    return 0.5 * cross(points[v[1]] - points[v[0]], points[v[2]] - points[v[0]]);
  }

  InterfaceComplex to_complex() const;

 private:
  void mark_caps(double cap_area_mm2, bool inner_caps);
  void find_curves(int threads);
  bool is_pinched(std::int32_t v) const;
  bool is_plain_for(std::int32_t v, std::int32_t side) const;
  std::vector<std::pair<Label, Label>> pairs_;
  std::vector<Label> labels_;
  std::vector<std::array<std::int32_t, 2>> sides_;
};

template <class Visit>
void ComplexMesh::edges_from(std::int32_t a, Visit visit) const {
  ShortList around;
  for (std::int32_t t : star[a])
    for (std::int32_t w : triangles[t].v) {
      if (w <= a) continue;
      auto at = around.end();
      while (at != around.begin() && *(at - 1) > w) --at;
      if (at == around.begin() || *(at - 1) != w) around.insert(at, w);
    }
  for (std::int32_t b : around) visit(b);
}

}  // namespace stackmesh
