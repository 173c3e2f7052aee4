#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cohort/cohort_folder.h"
#include "cohort/look.h"

namespace stackmesh {

/// How the cases of a cohort are run on this machine.
struct RunCasesOptions {
  std::string program;                  ///< path of the program that makes a case
  int jobs = 0;                         ///< cases at once; 0: as many as this process may use cores
  std::uint64_t memory_bytes = 0;       ///< what all cases at once may be foretold to take; 0: what is free now
  std::uint64_t case_memory_bytes = 0;  ///< bound of each case (its --max-memory); 0: memory_bytes
  std::optional<double> timeout_s;      ///< of each case, wall time; unset: none
  /// more tries of a case that fails other than by its call or input (exit 2 and 3)
  int retries = 0;
  bool failed_again = false;  ///< cases that failed before with the same key run again
  /// a look that takes longer (or longer than timeout_s) is given up, and the case runs alone
  double look_timeout_s = 120;
};

/// What happened to a case.
struct CaseEvent {
  /// How far the case has come; all but `started` end it.
  enum class Kind {
    started,        ///< its process has begun, for the first time or again
    done,           ///< its result stands in the folder
    failed,         ///< no try is left; the record says why
    unchanged,      ///< done before, with the same key
    failed_before,  ///< with the same key; not run again
    adopted         ///< a former run had done all but the last rename
  };
  Kind kind = Kind::started;  ///< which of them this event tells
  CaseRecord record;          ///< as it is in the folder; of `started` the id alone
  std::size_t ended = 0;      ///< cases that have ended so far, this one included where it has
  std::size_t of = 0;         ///< cases of the run in all
};

/// How the cases of a run came out, in numbers of cases.
struct RunCasesResult {
  std::size_t done = 0;           ///< ran to their end in this run
  std::size_t failed = 0;         ///< ran in this run without a result
  std::size_t unchanged = 0;      ///< were done before with the same key
  std::size_t failed_before = 0;  ///< failed before with the same key and were not run again
  std::size_t adopted = 0;        ///< a former run had done all but the last rename
  std::size_t not_run = 0;        ///< were waiting or running when a signal stopped the run
  int stopped_by = 0;             ///< the signal that asked to stop; what ran then is not run, and leaves nothing
};

/// Makes each case by a process of the program itself, in the order given, as many at once as `jobs` and memory allow:
/// a case starts when the memory foretold for it and for those that run fits, or when it is alone. Each case is looked
/// at before it starts, by a process of its own, beside those that run. A case that the kernel killed beside others is
/// tried once more alone. Whatever ends this process ends the cases that run, and they leave hidden folders only.
/// Precondition: this process has one thread. @throws Error(output) where the folder cannot be written
RunCasesResult run_cases(const std::vector<CohortCase>& cases, const CaseCommand& command, const CohortFolder& folder,
                         const RunCasesOptions& options, const std::function<void(const CaseEvent&)>& tell);

/// The words that make a case: PROGRAM mesh INPUT... -o FOLDER/mesh.vtu --report FOLDER/report.json --report
/// FOLDER/report.html OPTIONS.
std::vector<std::string> words_of_case(const CohortCase& c, const CaseCommand& command, const std::string& program,
                                       const std::string& folder, int threads, std::uint64_t memory_bytes);

/// Looks at every case, some at once; in the order given. For --dry-run and for size classes.
std::vector<CaseLook> look_at_cases(const std::vector<CohortCase>& cases, const CaseCommand& command,
                                    const CohortFolder& folder, int jobs, double timeout_s);

/// Cores that this process may use.
int usable_cores();
/// Memory that is free now, bytes: of the machine and of this process's control group.
std::uint64_t free_memory();

}  // namespace stackmesh
