#pragma once
#include <string>
#include <vector>

#include "report/run_report.h"

namespace stackmesh {

/// One figure of several meshes.
struct ComparisonRow {
  std::string id;                  ///< for programs: "dice_min"
  std::string name;                ///< for readers: "least Dice"
  std::vector<double> values;      ///< beside the reports; NaN where it was not measured
  std::vector<std::string> texts;  ///< the same, printed
  std::vector<std::size_t> best;   ///< columns with the best value; empty when all are equal or there is no better
};

/// The figures that a comparison of meshes prints, one row each, for the same input.
std::vector<ComparisonRow> compare(const std::vector<RunReport>& reports);

/// A report as aligned lines for a terminal: verdicts first, then a row for each label, then where it fails.
std::string text_summary(const RunReport& report);

/// The comparison as an aligned table; * marks the best.
std::string text_table(const std::vector<RunReport>& reports);

}  // namespace stackmesh
