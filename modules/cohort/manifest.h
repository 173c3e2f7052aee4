#pragma once
#include <string>
#include <vector>

#include "cohort/cohort_case.h"

namespace stackmesh {

/// Reads the cases of a manifest: a CSV or TSV file with the columns `id`, `input` and any long option of the command
/// by its name (an empty cell: as for all cases; a flag: yes or no; several values or inputs: separated by semicolons).
/// Relative paths are relative to the manifest's folder.
/// @throws Error(input) naming file and line for an unknown or doubled column, a missing `id` or `input`, an id that no
/// folder may have or that stands twice, an input that is not there, an option's value that the command does not take
std::vector<CohortCase> read_manifest(const std::string& path, const CaseCommand& command,
                                      const std::vector<OptionValue>& of_all);

/// The label maps of a tree in the layout of BIDS derivatives: sub-*/[ses-*/]KIND/*_dseg with a volume's ending; the id
/// is the file's name without `_dseg` and ending. @throws Error(input) where there are none
std::vector<CohortCase> read_bids_tree(const std::string& folder, const CaseCommand& command,
                                       const std::vector<OptionValue>& of_all);

/// What a glob names, in order of name; the id is the file's name without its ending, or, where two would be the same,
/// the path with '_' for '/'.
/// @param pattern with the wildcards * ? [] of the shell: "scans/*.nii.gz"
/// @param folder to which the glob is relative; empty: the working folder
/// @param command that will make the cases; its check() sees the words of each
/// @param of_all options that every case gets
/// @throws Error(input) where it names nothing
std::vector<CohortCase> read_glob(const std::string& pattern, const std::string& folder, const CaseCommand& command,
                                  const std::vector<OptionValue>& of_all);

/// Which of the cases an expression names: ids and globs of them, separated by commas.
/// @throws Error(usage) for one that names none
std::vector<CohortCase> selected_cases(const std::vector<CohortCase>& cases, const std::string& expression);

}  // namespace stackmesh
