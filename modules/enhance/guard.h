#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "enhance/complex_mesh.h"
#include "enhance/contact.h"

namespace stackmesh {

/// Triangles by the cells of a hashed grid. Queries may run in parallel.
class TriangleGrid {
 public:
  /// Takes all triangles of the mesh that are alive, with their corners at `points`.
  void build(const ComplexMesh& mesh, const std::vector<Vec3>& points, double cell_mm);
  void insert(std::int32_t t, const Corners3& corners);
  void remove(std::int32_t t);

  /// Calls visit(t) for every triangle whose box comes within `margin` of the corners' box; a triangle may
  /// come twice, rarely. visit returns false to stop. @return false if stopped.
  template <class Visit>
  bool query(const Corners3& corners, double margin, Visit visit) const;

 private:
  struct Box {
    std::array<float, 3> low, high;
  };
  static Box box_of(const Corners3& c, double margin);
  std::int32_t cell(float x) const { return static_cast<std::int32_t>(std::floor(x * inverse_)); }
  std::size_t bucket(std::int32_t i, std::int32_t j, std::int32_t k) const {
    return (static_cast<std::uint32_t>(i) * 73856093u ^ static_cast<std::uint32_t>(j) * 19349663u ^
            static_cast<std::uint32_t>(k) * 83492791u) &
           mask_;
  }
  float inverse_ = 1;
  std::size_t mask_ = 0;
  std::vector<std::vector<std::int32_t>> buckets_;
  std::vector<Box> boxes_;
};

/// A change that is asked for: triangles that go, corners of those that come, and one vertex at a new place
/// (moved == number of points: a new vertex).
struct Change {
  const std::vector<std::int32_t>* removed = nullptr;
  const std::vector<std::array<std::int32_t, 3>>* added = nullptr;
  std::int32_t moved = -1;
  Vec3 to;
  double clearance_mm = 0;
};

/// Tests changes exactly against the whole complex before they are committed.
class Guard {
 public:
  Guard(ComplexMesh& mesh, double sheet_angle_deg);
  void rebuild(double cell_mm);

  /// True when after the change no two triangles meet beyond what they share; no angle between sheets at an
  /// edge is below the limit unless the triangles that go had a narrower one; and no triangle comes closer to
  /// another that shares no corner with it than the clearance, unless those that go were as close.
  bool allows(const Change& change);

  /// After a committed change: the grid follows. `touched`: triangles that died, moved, changed or are new.
  void update(const std::vector<std::int32_t>& touched);

  std::size_t refused_contact = 0, refused_angle = 0, refused_clearance = 0;

 private:
  Corners3 corners(const std::array<std::int32_t, 3>& v, const Change* c) const;
  bool pair_allowed(const std::array<std::int32_t, 3>& v, const Corners3& s,
                    const std::array<std::int32_t, 3>& w, const Change& c);
  double narrowest_before(const Change& c) const;
  double nearest_before(const Change& c, const std::array<std::int32_t, 3>& w) const;

  ComplexMesh& mesh_;
  TriangleGrid grid_;
  double cosine_limit_;
  std::vector<std::uint32_t> stamp_;
  std::uint32_t now_ = 0;
  std::size_t known_ = 0;  ///< triangles that the grid has seen
};

/// What moves of many vertices at once must keep, each "not below, and not worse than before".
struct MoveLimits {
  double clearance_mm = 0;      ///< between triangles without a common corner
  double sheet_angle_deg = 20;  ///< between triangles at a common edge
  double corner_angle_deg = 0;  ///< smallest angle of a triangle
  double turn_deg = 0;          ///< a triangle's normal turns by no more; 0: any turn is allowed
};

/// Numbers of the triangles among `suspects` (and of those they meet) that cross or offend a limit with the
/// corners at `points`, `before` being the places that are known to be good. Ascending; independent of the
/// thread count.
std::vector<std::int32_t> find_offenders(const ComplexMesh& mesh, const TriangleGrid& grid,
                                         const std::vector<Vec3>& before, const std::vector<Vec3>& points,
                                         const std::vector<std::int32_t>& suspects, const MoveLimits& limits,
                                         int threads);

/// Triangles that meet another beyond what they share, or have no area: 0 for a sound complex. Exact.
std::size_t count_contacts(const ComplexMesh& mesh, int threads);

template <class Visit>
bool TriangleGrid::query(const Corners3& corners, double margin, Visit visit) const {
  const Box b = box_of(corners, margin);
  const std::int32_t lo[3] = {cell(b.low[0]), cell(b.low[1]), cell(b.low[2])},
                     hi[3] = {cell(b.high[0]), cell(b.high[1]), cell(b.high[2])};
  for (std::int32_t i = lo[0]; i <= hi[0]; ++i)
    for (std::int32_t j = lo[1]; j <= hi[1]; ++j)
      for (std::int32_t k = lo[2]; k <= hi[2]; ++k)
        for (std::int32_t t : buckets_[bucket(i, j, k)]) {
          const Box& o = boxes_[t];
          if (o.low[0] > b.high[0] || o.high[0] < b.low[0] || o.low[1] > b.high[1] || o.high[1] < b.low[1] ||
              o.low[2] > b.high[2] || o.high[2] < b.low[2])
            continue;
          // Reported only by the first cell that both are in.
          if (cell(std::max(o.low[0], b.low[0])) != i || cell(std::max(o.low[1], b.low[1])) != j ||
              cell(std::max(o.low[2], b.low[2])) != k)
            continue;
          if (!visit(t)) return false;
        }
  return true;
}

}  // namespace stackmesh
