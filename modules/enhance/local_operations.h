#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "enhance/complex_mesh.h"
#include "enhance/guard.h"
#include "enhance/reference.h"
#include "enhance/remesh.h"

namespace stackmesh {

/// The single operations of the remesher: each judges shape, asks the guard, and commits or leaves all as it
/// was.
class LocalOperations {
 public:
  /// `last_faces`: for each vertex the face of the reference where it last was, or -1.
  LocalOperations(ComplexMesh& mesh, std::vector<double>& size, std::vector<std::int32_t>& last_faces,
                  const Reference& reference, const RemeshOptions& options)
      : guard(mesh, options.sheet_angle_deg),
        hints(last_faces),
        mesh_(mesh),
        size_(size),
        reference_(reference),
        o_(options) {}

  double asked(std::int32_t a, std::int32_t b) const { return 0.5 * (size_[a] + size_[b]); }
  double length(std::int32_t a, std::int32_t b) const { return norm(mesh_.points[a] - mesh_.points[b]); }
  double angle(const std::array<std::int32_t, 3>& v) const {
    return smallest_angle(mesh_.points[v[0]], mesh_.points[v[1]], mesh_.points[v[2]]);
  }

  /// At its middle.
  bool split(std::int32_t a, std::int32_t b);
  /// `gone` into `kept`; no triangle gets an angle below `floor_rad` unless one of those that go was worse.
  bool collapse(std::int32_t gone, std::int32_t kept, double floor_rad);
  /// Flips where it makes the smallest angle larger by `gain_rad`; with `valence`, also where neighbour
  /// counts gain.
  bool flip(std::int32_t a, std::int32_t b, double gain_rad, bool valence);
  /// Where a curve edge is the long side of a needle, which no flip may turn: the needle goes, its apex joins the
  /// curve.
  bool absorb(std::int32_t a, std::int32_t b);
  /// A tip that hangs on a loop of three edges, through a and b, becomes one triangle; no part of it may be further
  /// from that than an edge length.
  bool cut_tip(std::int32_t a, std::int32_t b);
  /// Where the sheet lies in a pleat at the triangle: the pleat goes, the hole gets the triangulation with the largest
  /// smallest angle. What goes is thinner than 0.3 of the edge length.
  bool unfold(std::int32_t triangle);
  /// Moves one vertex towards the middle of its neighbours, whatever the angles: it takes folds out.
  bool smooth_over(std::int32_t v);
  /// Moves one vertex to the place near it that makes the smallest angle round it largest.
  bool relocate(std::int32_t v);
  /// Where a vertex belongs when it is drawn to p: on its reference sheet or curve, on its cap; itself if it
  /// may not move.
  Vec3 drawn_to_reference(std::int32_t v, const Vec3& p) const;

  Guard guard;
  RemeshCounts counts;
  /// For the last bad triangles: operations may leave the surface further, fold it more, and merge junctions a short
  /// edge apart.
  bool lenient = false;
  /// For what is left then: sheets may come closer still.
  void set_last_resort(bool on) {
    guard.set_sheet_angle(on ? 0.3 * o_.sheet_angle_deg : o_.sheet_angle_deg);
    closer_ = on ? 0.3 : 1;
  }
  std::vector<std::int32_t>& hints;

 private:
  double clearance_rel() const { return closer_ * o_.clearance_rel; }
  double reach_rel() const { return (lenient ? 2.5 : 1) * o_.deviation_rel; }
  double fold() const { return lenient ? 0.1 : 0.35; }  ///< cosine: a triangle's normal against that of its old fan
  double smallest_round(std::int32_t v, const Vec3& at, const std::vector<Vec3>& fan_normals) const;
  void fan_normals(std::int32_t v);
  Vec3 neighbours_mean(std::int32_t v) const;
  bool move(std::int32_t v, const Vec3& to);  ///< if the block and the guard allow it
  /// nearer to a neighbour than it was, and near: thin necks are not to be drawn together
  bool crowds(std::int32_t v, const Vec3& to) const;
  /// its sheet, as far as curves, is of few triangles: one vertex could turn it inside out
  bool is_speck(std::int32_t v) const;
  bool may_vanish(std::int32_t v) const;  ///< free within its sheet
  /// Puts the best triangulation of the loop, seen along the normal, in the place of the region.
  bool fill_loop(const std::vector<std::int32_t>& region, const std::vector<std::int32_t>& loop, const Vec3& normal);
  int ideal_valence_error(std::int32_t v, int change) const;

  double closer_ = 1;
  ComplexMesh& mesh_;
  std::vector<double>& size_;
  const Reference& reference_;
  const RemeshOptions& o_;
  std::vector<std::int32_t> removed_, touched_, fan_;
  std::vector<std::array<std::int32_t, 3>> added_;
  std::vector<Vec3> normals_;  ///< unit normal of each triangle's fan, in the order of the star
};

}  // namespace stackmesh
