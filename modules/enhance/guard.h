#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "enhance/complex_mesh.h"
#include "model/triangle_contact.h"

namespace stackmesh {

/// Triangles by the cells of a hashed grid. Queries may run in parallel.
class TriangleGrid {
 public:
  /// Takes all triangles of the mesh that are alive, with their corners at `points`; a triangle's box is wider by half
  /// its clearance to all sides (empty: by none).
  void build(const ComplexMesh& mesh, const std::vector<Vec3>& points, double cell_mm,
             std::vector<float> clearance = {});
  void insert(std::int32_t t, const Corners3& corners);
  void remove(std::int32_t t);

  struct Box {
    std::array<float, 3> low, high;
    std::array<std::int32_t, 3> cell = {0, 0, 0};  ///< of the low corner
    bool meets(const Box& o) const {
      return low[0] <= o.high[0] && o.low[0] <= high[0] && low[1] <= o.high[1] && o.low[1] <= high[1] &&
             low[2] <= o.high[2] && o.low[2] <= high[2];
    }
    void include(const Box& o) {
      for (int k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], o.low[k]);
        high[k] = std::max(high[k], o.high[k]);
      }
    }
  };
  /// The corners' box, wider by `margin` to all sides, rounded outwards.
  static Box box_of(const Corners3& corners, double margin);
  const Box& box(std::int32_t t) const { return boxes_[t]; }

  /// Calls visit(t) for every triangle whose box meets the box; a triangle may come twice, rarely. visit returns false
  /// to stop. @return false if stopped.
  template <class Visit>
  bool query(const Box& box, Visit visit) const;

  /// Calls visit(i, j), i < j, for every two triangles whose boxes meet in cells of the buckets from first to last; a
  /// pair may come twice, rarely.
  std::size_t bucket_count() const { return mask_ + 1; }
  template <class Visit>
  void pairs(std::size_t first, std::size_t last, std::vector<std::int32_t>& buffer, Visit visit) const;

 private:
  /// A bucket's head; what does not fit is in blocks behind it.
  struct Block {
    std::int32_t count = 0, next = -1;
    std::array<std::int32_t, 6> items;
  };
  std::int32_t cell(float x) const {
    const float y = x * inverse_;
    const auto i = static_cast<std::int32_t>(y);
    return i - (static_cast<float>(i) > y);
  }
  std::size_t bucket(std::int32_t i, std::int32_t j, std::int32_t k) const {
    return (static_cast<std::uint32_t>(i) * 73856093u ^ static_cast<std::uint32_t>(j) * 19349663u ^
            static_cast<std::uint32_t>(k) * 83492791u) &
           mask_;
  }
  template <class Body>
  void each_cell(const Box& b, Body body) const {
    const std::int32_t lo[3] = {cell(b.low[0]), cell(b.low[1]), cell(b.low[2])},
                       hi[3] = {cell(b.high[0]), cell(b.high[1]), cell(b.high[2])};
    for (std::int32_t i = lo[0]; i <= hi[0]; ++i)
      for (std::int32_t j = lo[1]; j <= hi[1]; ++j)
        for (std::int32_t k = lo[2]; k <= hi[2]; ++k) body(bucket(i, j, k));
  }
  void push(std::size_t bucket, std::int32_t t);
  void drop(std::size_t bucket, std::int32_t t);

  float inverse_ = 1;
  std::size_t mask_ = 0;
  std::vector<Block> blocks_;
  std::vector<std::int32_t> spare_;  ///< blocks that are not used
  std::vector<Box> boxes_;
  std::vector<float> clearance_;
};

/// A change that is requested: triangles that go, corners of those that come, and one vertex at a new place
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
  void set_sheet_angle(double deg) { cosine_limit_ = std::cos(deg * M_PI / 180); }

  /// True when after the change no two triangles meet beyond what they share; no angle between sheets at an
  /// edge is below the limit unless the triangles that go had a narrower one; and no triangle comes closer to
  /// another that shares no corner with it than the clearance, unless those that go were as close.
  bool allows(const Change& change);

  /// After a committed change: the grid follows. `touched`: triangles that died, moved, changed or are new.
  void update(const std::vector<std::int32_t>& touched);

  std::size_t refused_contact = 0, refused_angle = 0, refused_clearance = 0;

 private:
  Corners3 corners(const std::array<std::int32_t, 3>& v, const Change* c) const;
  bool pair_allowed(const std::array<std::int32_t, 3>& v, const Corners3& s, const std::array<std::int32_t, 3>& w,
                    const Change& c);
  /// True when the new triangle turns through another one at their common edge, against the one of that edge which
  /// goes.
  bool turned_through(const std::array<std::int32_t, 3>& v, const Corners3& s, const std::array<std::int32_t, 3>& w,
                      const Corners3& t, const SharedCorners& h, double cosine, const Change& c) const;
  double narrowest_before(const Change& c) const;
  bool was_as_near(const Change& c, const std::array<std::int32_t, 3>& w, double squared) const;
  /// True for a triangle that shares a corner with those that go.
  bool is_beside_removed(const std::array<std::int32_t, 3>& w) const {
    return corner_stamp_[w[0]] == now_ || corner_stamp_[w[1]] == now_ || corner_stamp_[w[2]] == now_;
  }

  ComplexMesh& mesh_;
  TriangleGrid grid_;
  double cosine_limit_;
  std::vector<std::uint32_t> stamp_, corner_stamp_;  ///< now_: goes with the change at hand; is a corner of what goes
  std::vector<Corners3> new_corners_;
  std::vector<TriangleGrid::Box> new_boxes_;
  std::uint32_t now_ = 0;
  std::size_t known_ = 0;  ///< triangles that the grid has seen
};

/// What moves of many vertices at once must keep, each "not below, and not worse than before".
struct MoveLimits {
  double clearance_mm = 0;                       ///< between triangles without a common corner
  const std::vector<double>* size_mm = nullptr;  ///< and, if given, this share of the smallest edge length requested at
  double clearance_rel = 0;                      ///< their corners
  double sheet_angle_deg = 20;                   ///< between triangles at a common edge
  double corner_angle_deg = 0;                   ///< smallest angle of a triangle
  double turn_deg = 0;                           ///< a triangle's normal turns by no more; 0: any turn is allowed
};

/// For every triangle the distance that others have to keep from it, mm; two keep the mean of theirs.
std::vector<float> clearances(const ComplexMesh& mesh, const MoveLimits& limits);

/// Numbers of the triangles among `suspects` (and of those they meet) that cross or offend a limit with the
/// corners at `points`, `before` being the places that are known to be good; the grid holds the triangles at `points`
/// with their clearances. Ascending; independent of the thread count.
std::vector<std::int32_t> find_offenders(const ComplexMesh& mesh, const TriangleGrid& grid,
                                         const std::vector<float>& clearance, const std::vector<Vec3>& before,
                                         const std::vector<Vec3>& points, const std::vector<std::int32_t>& suspects,
                                         const MoveLimits& limits, int threads);

/// Triangles that meet another beyond what they share, or have no area: 0 for a sound complex. Exact.
std::size_t count_contacts(const ComplexMesh& mesh, int threads);

template <class Visit>
bool TriangleGrid::query(const Box& b, Visit visit) const {
  const std::int32_t lo[3] = {cell(b.low[0]), cell(b.low[1]), cell(b.low[2])},
                     hi[3] = {cell(b.high[0]), cell(b.high[1]), cell(b.high[2])};
  for (std::int32_t i = lo[0]; i <= hi[0]; ++i)
    for (std::int32_t j = lo[1]; j <= hi[1]; ++j)
      for (std::int32_t k = lo[2]; k <= hi[2]; ++k)
        for (auto n = static_cast<std::int32_t>(bucket(i, j, k)); n >= 0; n = blocks_[n].next) {
          const Block& block = blocks_[n];
          for (std::int32_t e = 0; e < block.count; ++e) {
            const std::int32_t t = block.items[e];
            const Box& o = boxes_[t];
            if (!o.meets(b)) continue;
            // Reported only by the first cell that both are in.
            if (std::max(o.cell[0], lo[0]) != i || std::max(o.cell[1], lo[1]) != j || std::max(o.cell[2], lo[2]) != k)
              continue;
            if (!visit(t)) return false;
          }
        }
  return true;
}

template <class Visit>
void TriangleGrid::pairs(std::size_t first, std::size_t last, std::vector<std::int32_t>& buffer, Visit visit) const {
  for (std::size_t h = first; h < last; ++h) {
    buffer.clear();
    for (auto n = static_cast<std::int32_t>(h); n >= 0; n = blocks_[n].next)
      buffer.insert(buffer.end(), blocks_[n].items.begin(), blocks_[n].items.begin() + blocks_[n].count);
    for (std::size_t x = 1; x < buffer.size(); ++x) {
      const Box& b = boxes_[buffer[x]];
      for (std::size_t y = 0; y < x; ++y) {
        const Box& o = boxes_[buffer[y]];
        if (!b.meets(o) || buffer[x] == buffer[y]) continue;
        if (bucket(std::max(b.cell[0], o.cell[0]), std::max(b.cell[1], o.cell[1]), std::max(b.cell[2], o.cell[2])) == h)
          visit(std::min(buffer[x], buffer[y]), std::max(buffer[x], buffer[y]));
      }
    }
  }
}

}  // namespace stackmesh
