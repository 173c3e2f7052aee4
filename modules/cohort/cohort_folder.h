#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cohort/cohort_case.h"

namespace stackmesh {

constexpr char kFailedEnding[] = ".failed";               ///< of the folder that a failed case leaves
constexpr char kThumbnailFolder[] = "cohort_thumbnails";  ///< beside the cases

/// How a case came out; the content of its file `done`, or of `failed.json`.
struct CaseRecord {
  std::string id, key;
  bool is_done = false;
  int exit_code = 0;   ///< of the program; minus the signal that ended it
  std::string reason;  ///< of a failure, one line
  std::string version, command;
  std::vector<std::string> inputs, options;  ///< options as words
  std::string input_sha256;
  double wall_s = 0, cpu_s = 0, peak_mb = 0;  ///< of the try that counts
  double foretold_s = 0, foretold_mb = 0;     ///< 0: was not foretold
  int tries = 1;
  std::string host, finished_utc;
};

/// What a cohort is to hold; the file .cohort/plan.json.
struct CohortPlan {
  std::string source;         ///< absolute path of the manifest, the tree, or the glob
  std::string source_sha256;  ///< of a manifest's bytes
  std::string version, command;
  std::vector<std::string> formats;
  std::vector<CohortCase> cases;
};

/// @throws Error(input) for a damaged or missing file
CohortPlan read_plan(const std::string& path);

/// The folder of a cohort. A case is the folder ID/, which appears whole, with the file `done` in it; a failed one is
/// ID.failed/. Work goes on in hidden folders .ID.work-HOST-PID, which are renamed at the end; .cohort/ holds plan,
/// lock and journal.
class CohortFolder {
 public:
  explicit CohortFolder(std::string path) : path_(std::move(path)) {}
  const std::string& path() const { return path_; }
  std::string own(const std::string& name) const { return path_ + "/.cohort/" + name; }
  std::string case_folder(const std::string& id) const { return path_ + "/" + id; }
  std::string failed_folder(const std::string& id) const { return path_ + "/" + id + kFailedEnding; }

  /// Makes the folder where it is missing. @throws Error(output) where that cannot be, or it holds other files than a
  /// cohort's
  void prepare() const;

  /// The plan that it holds, if it holds one. @throws Error(input) for a damaged one
  std::optional<CohortPlan> plan() const;

  /// @throws Error(usage) where the folder holds the cases of another manifest: neither of this path nor of these bytes
  void check_source(const CohortPlan& plan) const;
  void write_plan(const CohortPlan& plan) const;

  /// The record of a case that is done, or, with `failed`, of one that failed; none where there is no such folder or it
  /// is not whole.
  std::optional<CaseRecord> record(const std::string& id, bool failed = false) const;

  /// An empty hidden folder for work on a case. Those that earlier runs left are removed; a whole one that only lacked
  /// its last rename is adopted first. @return its path; "" where a case with this key was adopted
  std::string begin(const std::string& id, const std::string& key) const;
  /// Ends a case: writes its record, brings files to the disk, renames the folder. What the id had before goes: an
  /// earlier result when the case is done; when it failed, an earlier result of another key moves into
  /// ID.failed/previous.
  void finish(const std::string& work, const CaseRecord& record) const;
  /// Removes the hidden folders that ended runs left.
  void remove_left_over() const;

  /// A line of .cohort/journal.tsv: UTC, host, process, event, id, key.
  void note(const std::string& event, const std::string& id, const std::string& key) const;

 private:
  std::string path_;
};

/// Held while a run works in a folder, so that no two do. Released by the system whatever ends the process.
class CohortLock {
 public:
  /// @param folder whose lock it is
  /// @param shared for a run of single cases, several of which may go on at once
  /// @throws Error(usage) naming the process that holds it
  CohortLock(const CohortFolder& folder, bool shared);
  ~CohortLock();
  CohortLock(const CohortLock&) = delete;
  CohortLock& operator=(const CohortLock&) = delete;

 private:
  int file_ = -1;
};

std::string host_name();
std::string utc_now();

/// The record as JSON, and back. @throws nlohmann::json::exception
std::string to_json(const CaseRecord& record);
CaseRecord case_record_of(const std::string& json);
std::string to_json(const CohortPlan& plan);
CohortPlan cohort_plan_of(const std::string& json);

}  // namespace stackmesh
