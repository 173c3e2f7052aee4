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
  std::string id;        ///< of the case, unique in the cohort, also the name of its folder
  std::string key;       ///< what its result was made of, see key_of_case(); decides whether the result stands
  bool is_done = false;  ///< the program ended well and wrote a mesh in every format; false: it failed
  int exit_code = 0;     ///< of the program; minus the signal that ended it
  std::string reason;    ///< of a failure, one line
  std::string version;   ///< of the program that made it
  std::string command;   ///< that made it: mesh, surface or fem
  std::vector<std::string> inputs;   ///< INPUT of the command, as in the plan
  std::vector<std::string> options;  ///< options as words: "--edge-length=2"
  std::string input_sha256;          ///< over the bytes of the input's files, in hexadecimal
  double wall_s = 0;                 ///< time by the clock of the try that counts, s
  double cpu_s = 0;                  ///< time on all cores of the try that counts, s
  double peak_mb = 0;                ///< largest resident set of the try that counts, MB
  double foretold_s = 0;             ///< time that the look foretold, on one free core, s; 0: was not foretold
  double foretold_mb = 0;            ///< largest resident set that the look foretold, MB; 0: was not foretold
  int tries = 1;                     ///< how often the case was begun in that run, the last try included
  std::string host;                  ///< name of the machine on which it ran
  std::string finished_utc;          ///< when it ended, in UTC: "2025-01-31T12:00:00Z"
};

/// What a cohort is to hold; the file .cohort/plan.json.
struct CohortPlan {
  std::string source;                ///< absolute path of the manifest, the tree, or the glob
  std::string source_sha256;         ///< of a manifest's bytes
  std::string version;               ///< of the program; results of another one are made anew
  std::string command;               ///< that makes each case: mesh, surface or fem
  std::vector<std::string> formats;  ///< endings of the files that each case gets: {"vtu"}
  std::vector<CohortCase> cases;     ///< in the order in which they are run and listed
};

/// @throws Error(input) for a damaged or missing file
CohortPlan read_plan(const std::string& path);

/// The folder of a cohort. A case is the folder ID/, which appears whole, with the file `done` in it; a failed one is
/// ID.failed/. Work goes on in hidden folders .ID.work-HOST-PID, which are renamed at the end; .cohort/ holds plan,
/// lock and journal.
class CohortFolder {
 public:
  /// Names the folder only: nothing is read or made, see prepare().
  explicit CohortFolder(std::string path) : path_(std::move(path)) {}
  const std::string& path() const { return path_; }  ///< as it was given, absolute or relative to the working folder
  /// Path of a file in .cohort, which holds what belongs to the cohort as a whole; with "" that folder itself.
  std::string own(const std::string& name) const { return path_ + "/.cohort/" + name; }
  /// Where the result of a case stands once it is done.
  std::string case_folder(const std::string& id) const { return path_ + "/" + id; }
  /// Where the log and `failed.json` of a case stand that failed.
  std::string failed_folder(const std::string& id) const { return path_ + "/" + id + kFailedEnding; }

  /// Makes the folder where it is missing. @throws Error(output) where that cannot be, or it holds other files than a
  /// cohort's
  void prepare() const;

  /// The plan that it holds, if it holds one. @throws Error(input) for a damaged one
  std::optional<CohortPlan> plan() const;

  /// @throws Error(usage) where the folder holds the cases of another manifest: neither of this path nor of these bytes
  void check_source(const CohortPlan& plan) const;
  /// Puts the plan into .cohort/plan.json, whole or not at all; one that is the same stays untouched. @throws
  /// Error(output)
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

/// Name of this machine as the system tells it; "unknown" where it does not.
std::string host_name();
/// Time in UTC to the second: "2025-01-31T12:00:00Z".
std::string utc_now();

/// The record as the JSON of its file; bytes that are not UTF-8 are replaced.
std::string to_json(const CaseRecord& record);
/// The record that such JSON holds. @throws nlohmann::json::exception for text that is none or lacks a member
CaseRecord case_record_of(const std::string& json);
/// The plan as the JSON of .cohort/plan.json.
std::string to_json(const CohortPlan& plan);
/// The plan that such JSON holds. @throws nlohmann::json::exception for text that is none or lacks a member
CohortPlan cohort_plan_of(const std::string& json);

}  // namespace stackmesh
