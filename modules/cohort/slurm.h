#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cohort/cohort_folder.h"
#include "cohort/look.h"

namespace stackmesh {

/// How the cases of a cohort are given to Slurm.
struct SlurmOptions {
  std::string program;  ///< path of the program, the same on every node
  /// for sbatch, as one text: "--partition=long --account=x"; they go before what is foretold
  std::string arguments;
  int cases_per_task = 1;               ///< that one task makes, one after the other; below 1 counts as 1
  int retries = 0;                      ///< more tries of a case that fails, see RunCasesOptions::retries
  bool failed_again = false;            ///< cases that failed before with the same key run again
  std::optional<double> timeout_s;      ///< of each case; then it decides on --time
  std::uint64_t case_memory_bytes = 0;  ///< of each case; then it decides on --mem
};

/// Cases that need about the same memory and time, as one array job.
struct SlurmArray {
  std::string name;              ///< of its files in .cohort/slurm
  std::string job_id;            ///< empty until it is submitted
  std::uint64_t memory_mb = 0;   ///< of each task, MB: its --mem, and the bound of each case
  int minutes = 0;               ///< of each task: its --time
  int tasks = 0;                 ///< numbered from 0 in Slurm
  int cases_per_task = 1;        ///< the last task may have fewer
  std::vector<std::string> ids;  ///< in the order of the tasks
};

/// @throws Error(usage) where sbatch, squeue or scontrol is not there, or the controller does not answer
void check_slurm();

/// Memory in steps of two, from 512 MB, half as much again as foretold; time in steps of four, from 5 minutes, four
/// times as long as foretold; at most `most_tasks` tasks in an array.
std::vector<SlurmArray> size_classes(const std::vector<CohortCase>& cases, const std::vector<CaseLook>& looks,
                                     const SlurmOptions& options, std::size_t most_tasks);

/// Largest number of tasks in an array on this cluster.
std::size_t most_array_tasks();

/// Writes the scripts and plans into .cohort/slurm, and submits them. What is in the queue is left out by the caller.
/// @throws Error(usage) with sbatch's own words where it refuses
void submit(std::vector<SlurmArray>& arrays, const CohortPlan& plan, const CohortFolder& folder,
            const SlurmOptions& options);

/// The script of an array, as sbatch takes it.
std::string slurm_script(const SlurmArray& array, const CohortFolder& folder, const SlurmOptions& options);

/// Every array that was submitted for the folder.
std::vector<SlurmArray> submitted_arrays(const CohortFolder& folder);

/// The state of each case that is in the queue now ("RUNNING", "PENDING: Resources"), by id.
std::map<std::string, std::string> queued_cases(const CohortFolder& folder);

/// What Slurm last said of a case that left the queue without a result: the last line "slurmstepd: ..." of its task's
/// output; "" for nothing.
std::string last_words(const CohortFolder& folder, const std::string& id);

/// The words of a text as a shell would split it: blanks separate, quotes keep together. @throws Error(usage) for an
/// open quote
std::vector<std::string> shell_words(const std::string& text);

}  // namespace stackmesh
