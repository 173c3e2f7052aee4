#pragma once
#include <array>
#include <vector>

#include "sections/fill_gap.h"
#include "sections/islands.h"
#include "sections/slice_fields.h"

namespace stackmesh::interpolate {

/// The islands of a gap's slices and their groups: by label, or of tissue against background.
struct Partition {
  Islands before, low, high, after;
  Groups groups;

  explicit Partition(const Gap& gap);
};

/// A group's signed distance at any height of its gap: a weighted sum of the fields of up to four slices.
class GroupField {
 public:
  /// @param gap_mm height of the gap, 0: not known
  GroupField(const Partition& part, std::int32_t group, int width, int height, const std::array<double, 2>& pixel_mm,
             double gap_mm);

  /// Where the values are; elsewhere the group is not.
  const Box& box() const { return box_; }

  /// The values at height t in (0, 1), times steps_per_mm, towards 0, row by row of the box. neighbours_rel: the
  /// gaps beneath and above, as a share of this one; end_at: where in the gap a group closes that one slice lacks.
  void blend(double t, double tension, const std::array<double, 2>& neighbours_rel, double end_at, double steps_per_mm,
             std::vector<int>& out) const;

 private:
  struct Slice {
    Field field;          // no value: the group is not in this slice
    double x = 0, y = 0;  // its centre, pixels
    bool present() const { return !field.value.empty(); }
  };
  template <class Belongs>
  Slice slice(const Islands& islands, int width, const Box& from, double limit_mm,
              const std::array<double, 2>& pixel_mm, const Belongs& belongs) const;
  /// Follows the centres as far as that makes the two slices overlap better, if they move far for their width.
  double share_of_motion() const;

  Box box_;
  std::array<Slice, 4> slices_;
  double peak_ = 0;     // of a group that ends in this gap
  double ends_at_ = 0;  // share of the gap at which it closes, 0: not known
  double share_ = 0;    // of the centres' motion that the slices follow
};

}  // namespace stackmesh::interpolate
