#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace stackmesh {

/// Which values of a figure are remarkable.
enum class Side { both, low, high };

/// A figure that is compared over a cohort.
struct Metric {
  std::string id;            ///< its name in cohort.csv and cohort.json: "volume_mm3"
  std::string title;         ///< its name on the page: "Volume"
  std::string unit;          ///< as it is printed behind a value: "mm3"; "": none
  bool per_label = false;    ///< one value for each label, else one for the case
  bool logarithmic = false;  ///< ratios count, not differences
  Side side = Side::both;    ///< on which side of the median values get a score
  double least_spread = 0;   ///< smallest spread that is believed: in the figure's unit, or the logarithm's
};

/// Every figure, in the order in which tables and charts show them.
const std::vector<Metric>& cohort_metrics();

/// A figure over the cases that have it.
struct Distribution {
  std::size_t metric = 0;          ///< in cohort_metrics()
  int label = 0;                   ///< 0: of the case
  std::vector<std::size_t> cases;  ///< beside `values`
  std::vector<double> values;      ///< finite, in the metric's unit, in the order of `cases`
  std::vector<double> scores;      ///< robust z, of the remarkable side only; 0 where there are too few values
  /// smallest value within 1.5 interquartile ranges below the box (of logarithms where these count)
  double low = 0;
  double q1 = 0;      ///< lower end of the box: a quarter of the values lie below
  double median = 0;  ///< between the two middle values where their number is even
  double q3 = 0;      ///< upper end of the box: a quarter of the values lie above
  double high = 0;    ///< largest value within the same reach above the box
};

/// A score above it marks an outlier (Iglewicz and Hoaglin 1993).
constexpr double kOutlierScore = 3.5;
/// Fewer values have no outliers.
constexpr std::size_t kFewestValues = 6;

/// Fills in scores and box: the score is the distance from the median over 1.4826 times the median absolute deviation,
/// of logarithms where the metric says so. Values must be finite; those of a logarithmic metric that are not above 0
/// have no score.
void judge_distribution(Distribution& d);

}  // namespace stackmesh
