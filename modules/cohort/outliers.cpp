#include "cohort/outliers.h"

#include <algorithm>
#include <cmath>

namespace stackmesh {
namespace {

/// Of ascending values, between the two nearest.
double quantile(const std::vector<double>& ascending, double share) {
  const double at = share * static_cast<double>(ascending.size() - 1);
  const std::size_t below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, ascending.size() - 1);
  return ascending[below] + (at - static_cast<double>(below)) * (ascending[above] - ascending[below]);
}

double median_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return quantile(values, 0.5);
}

}  // namespace

const std::vector<Metric>& cohort_metrics() {
  static const std::vector<Metric> metrics = {
      {"volume_mm3", "Volume", "mm3", true, true, Side::both, 0.05},
      {"volume_error_rel", "Volume against the voxels, share", "", true, false, Side::high, 0.005},
      {"dice", "Dice", "", true, false, Side::low, 0.003},
      {"band_mean_mm", "Mean distance outside of the voxels' band", "mm", true, false, Side::high, 0.01},
      {"wrong_centres_share", "Voxel centres on the wrong side, share", "", true, false, Side::high, 0.002},
      {"angle_min_deg", "Smallest angle of a triangle", "degrees", true, false, Side::low, 1.5},
      {"components", "Pieces", "", true, false, Side::both, 0.5},
      {"dihedral_min_deg", "Smallest dihedral angle", "degrees", false, false, Side::low, 1.5},
      {"scaled_jacobian_min", "Smallest scaled Jacobian", "", false, false, Side::low, 0.02},
      {"tets", "Tetrahedra", "", false, true, Side::both, 0.15},
      {"wall_s", "Time", "s", false, true, Side::high, 0.5},
      {"peak_rss_mb", "Memory", "MB", false, true, Side::high, 0.2}};
  return metrics;
}

void judge_distribution(Distribution& d) {
  const Metric& metric = cohort_metrics()[d.metric];
  d.scores.assign(d.values.size(), 0);
  if (d.values.empty()) return;
  std::vector<double> ascending = d.values;
  std::sort(ascending.begin(), ascending.end());
  d.q1 = quantile(ascending, 0.25);
  d.median = quantile(ascending, 0.5);
  d.q3 = quantile(ascending, 0.75);
  const bool ratios = metric.logarithmic && d.q1 > 0;  // whiskers as the figure is compared
  const double reach = 1.5 * (ratios ? std::log(d.q3 / d.q1) : d.q3 - d.q1);
  d.low = *std::lower_bound(ascending.begin(), ascending.end(), ratios ? d.q1 * std::exp(-reach) : d.q1 - reach);
  d.high = *(std::upper_bound(ascending.begin(), ascending.end(), ratios ? d.q3 * std::exp(reach) : d.q3 + reach) - 1);
  if (d.values.size() < kFewestValues) return;

  // the median absolute deviation of a normal distribution to its standard deviation
  constexpr double kNormal = 1.4826;
  std::vector<double> scaled;
  for (const double v : d.values)
    if (!metric.logarithmic) scaled.push_back(v);
    else if (v > 0) scaled.push_back(std::log(v));
  if (scaled.empty()) return;
  const double middle = median_of(scaled);
  for (double& v : scaled) v = std::abs(v - middle);
  const double spread = std::max(metric.least_spread, kNormal * median_of(scaled));
  for (std::size_t i = 0; i < d.values.size(); ++i) {
    if (metric.logarithmic && !(d.values[i] > 0)) continue;
    const double off = (metric.logarithmic ? std::log(d.values[i]) : d.values[i]) - middle;
    const bool counts = metric.side == Side::both || (metric.side == Side::low) == (off < 0);
    if (counts) d.scores[i] = std::abs(off) / spread;
  }
}

}  // namespace stackmesh
