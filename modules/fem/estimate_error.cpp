#include "fem/estimate_error.h"

#include <algorithm>
#include <cmath>

namespace stackmesh {
namespace {

struct Limit {
  double value = 0, order = 0;
};

/// What values on meshes with edges h, h/2 (and h/4) tend to. Three of them show their order, if they converge.
Limit richardson(const std::vector<double>& v, double order) {
  const std::size_t n = v.size();
  const double step = v[n - 1] - v[n - 2];
  if (n >= 3) {
    const double before = v[n - 2] - v[n - 3];
    // it does not converge yet: little is trusted
    order = step != 0 && before / step > 1 ? std::min(4.0, std::log2(before / step)) : 0.5;
    order = std::max(0.5, order);
  }
  return {v[n - 1] + step / (std::pow(2, order) - 1), order};
}

}  // namespace

Accuracy estimate_error(const std::vector<StressMeasure>& measures, int order) {
  Accuracy out;
  for (const StressMeasure& m : measures) out.zz_rel.push_back(m.zz_rel);
  const StressMeasure& last = measures.back();
  double largest_move = 0;
  for (const SetStress& s : last.sets) largest_move = std::max(largest_move, s.displacement_max_mm);
  for (const SetStress& s : last.sets) {
    SetAccuracy row;
    row.set = s.set;
    row.held = s.held;
    row.zz_rel = s.zz_rel;
    for (const StressMeasure& m : measures)
      for (const SetStress& other : m.sets)
        if (other.set == s.set) {
          row.mises_rms_mpa.push_back(other.mises_rms_mpa);
          row.mises_max_mpa.push_back(other.mises_max_mpa);
          row.displacement_max_mm.push_back(other.displacement_max_mm);
        }
    if (row.mises_rms_mpa.size() != measures.size() || measures.size() < 2) continue;
    const Limit stress = richardson(row.mises_rms_mpa, order), moved = richardson(row.displacement_max_mm, order);
    row.mises_extrapolated_mpa = stress.value;
    row.order = stress.order;
    const double scale = std::max(std::abs(stress.value), 0.05 * last.mises_rms_mpa),
                 move_scale = std::max(std::abs(moved.value), 0.05 * largest_move);
    row.error_rel = scale > 0 ? std::abs(stress.value - row.mises_rms_mpa.back()) / scale : 0;
    row.displacement_error_rel =
        move_scale > 0 ? std::abs(moved.value - row.displacement_max_mm.back()) / move_scale : 0;
    const double error = std::max(row.error_rel, row.displacement_error_rel);
    if (!row.held && error >= out.error_rel) {
      out.error_rel = error;
      out.worst_set = row.set;
    }
    out.sets.push_back(std::move(row));
  }
  return out;
}

}  // namespace stackmesh
