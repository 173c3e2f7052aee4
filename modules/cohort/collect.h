#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cohort/cohort_folder.h"
#include "cohort/outliers.h"

namespace stackmesh {

/// A case of the cohort's page.
struct CohortRow {
  /// changed: done with other options or by another version; missing: not run, or not to its end
  enum class State { done, failed, changed, missing };
  std::string id;
  State state = State::missing;
  std::string reason;  ///< why it failed, or has no result
  CaseRecord record;
  std::string verdict;                        ///< of a done case: "pass", "warn" or "fail", the worst of its report
  std::vector<std::string> outside, warned;   ///< verdicts that fail or warn: "Volume: 12 % off"
  std::vector<std::string> remarkable;        ///< outliers, in words, the furthest first
  double score = 0;                           ///< largest of its outlier scores
  std::vector<double> figures;                ///< of the case, beside cohort_metrics(); NaN: none
  std::map<int, std::vector<double>> labels;  ///< the same for each label
  /// name of the file in its folder that a picture is drawn of; "": none can be read
  std::string mesh;
  std::string picture;  ///< path from the cohort's folder; "": none
  bool is_outside() const { return !outside.empty(); }
  bool is_outlier() const { return score > kOutlierScore; }
};

struct CohortLabel {
  std::string name, colour;                               ///< colour as #rrggbb
  std::optional<std::array<std::uint8_t, 3>> own_colour;  ///< where the input has one
};

/// A cohort as it is.
struct Cohort {
  std::string source, version, command;
  /// failed ones first, then those outside their limits, outliers, the others as planned
  std::vector<CohortRow> rows;
  std::map<int, CohortLabel> labels;
  std::vector<Distribution> distributions;  ///< their `cases` are places in `rows`
  std::size_t count(CohortRow::State state) const;
  std::size_t outside() const, outliers() const;
  /// 4 where a case failed or has no result, else 6 where one is outside its limits, else 0.
  int exit_code() const;
};

/// Reads the records and reports of every case. @throws Error(input) where the folder holds no cohort
Cohort read_cohort(const CohortFolder& folder);

struct CollectOptions {
  bool pictures = true;
  int threads = 0;
};

/// Writes cohort.csv, cohort.json, cohort.html and the missing pictures. @throws Error(input), Error(output)
Cohort collect(const CohortFolder& folder, const CollectOptions& options);

/// A line for each label of each case, and one for each case without a result.
std::string cohort_csv(const Cohort& cohort);
std::string cohort_json(const Cohort& cohort);
std::string cohort_html(const Cohort& cohort);

const char* to_text(CohortRow::State state);

}  // namespace stackmesh
