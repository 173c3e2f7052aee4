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
  std::string id;                             ///< of the case, also the name of its folder
  State state = State::missing;               ///< as the folder and the plan tell it now
  std::string reason;                         ///< why it failed, or has no result
  CaseRecord record;                          ///< of its last run; as made by default where the state is missing
  std::string verdict;                        ///< of a done case: "pass", "warn" or "fail", the worst of its report
  std::vector<std::string> outside;           ///< verdicts that fail, with their figures: "Volume: 12 % off"
  std::vector<std::string> warned;            ///< verdicts that warn, likewise
  std::vector<std::string> remarkable;        ///< outliers, in words, the furthest first
  double score = 0;                           ///< largest of its outlier scores
  std::vector<double> figures;                ///< of the case, beside cohort_metrics(); NaN: none
  std::map<int, std::vector<double>> labels;  ///< the same for each label
  /// name of the file in its folder that a picture is drawn of; "": none can be read
  std::string mesh;
  std::string picture;                                       ///< path from the cohort's folder; "": none
  bool is_outside() const { return !outside.empty(); }       ///< some verdict of its report is "fail"
  bool is_outlier() const { return score > kOutlierScore; }  ///< some figure is far from those of the other cases
};

/// A label that at least one case of the cohort has.
struct CohortLabel {
  std::string name;                                       ///< from the first report that names it; "": none does
  std::string colour;                                     ///< as #rrggbb: its own, else one chosen for the page
  std::optional<std::array<std::uint8_t, 3>> own_colour;  ///< where the input has one
};

/// A cohort as it is.
struct Cohort {
  std::string source;   ///< absolute path of the manifest, the tree, or the glob
  std::string version;  ///< of the program, as the plan has it
  std::string command;  ///< that makes each case: mesh, surface or fem
  /// failed ones first, then those outside their limits, outliers, the others as planned
  std::vector<CohortRow> rows;
  std::map<int, CohortLabel> labels;                ///< of all cases, by number, without the background
  std::vector<Distribution> distributions;          ///< their `cases` are places in `rows`
  std::size_t count(CohortRow::State state) const;  ///< how many cases are in that state
  std::size_t outside() const;                      ///< how many cases have a verdict that fails
  std::size_t outliers() const;                     ///< how many cases have a score above kOutlierScore
  /// 4 where a case failed or has no result, else 6 where one is outside its limits, else 0.
  int exit_code() const;
};

/// Reads the records and reports of every case. @throws Error(input) where the folder holds no cohort
Cohort read_cohort(const CohortFolder& folder);

/// How a cohort is collected.
struct CollectOptions {
  bool pictures = true;  ///< false: no thumbnails are drawn, and the page has none
  int threads = 0;       ///< that draw thumbnails; 0: all of the machine
};

/// Writes cohort.csv, cohort.json, cohort.html and the missing pictures. @throws Error(input), Error(output)
Cohort collect(const CohortFolder& folder, const CollectOptions& options);

/// A line for each label of each case, and one for each case without a result.
std::string cohort_csv(const Cohort& cohort);
/// The same for programs: the text of cohort.json, with the distributions of all figures.
std::string cohort_json(const Cohort& cohort);
/// The text of cohort.html: one page that needs nothing but a browser and the pictures beside it.
std::string cohort_html(const Cohort& cohort);

/// The state as tables and JSON write it: "done", "failed", "changed" or "missing".
const char* to_text(CohortRow::State state);

}  // namespace stackmesh
