#pragma once
#include <functional>
#include <string>
#include <vector>

namespace stackmesh {

/// An option of `mesh`, `surface` or `fem` that was given.
struct OptionValue {
  std::string name;                 ///< long name without dashes: "edge-length"
  std::vector<std::string> values;  ///< empty: a flag
};

/// What may stand in a manifest's column.
struct KnownOption {
  std::string name;            ///< long name without dashes: "edge-length"
  bool is_flag = false;        ///< takes no value; a cell holds yes or no
  bool takes_several = false;  ///< a cell holds them separated by semicolons
  bool is_path = false;        ///< names a file, relative to the manifest's folder
};

/// The command that makes each case, as the program describes it.
struct CaseCommand {
  std::string name = "mesh";         ///< mesh, surface or fem
  std::string version;               ///< of the program
  std::vector<KnownOption> options;  ///< that a case may have
  std::vector<std::string> formats;  ///< endings of the files that a case gets: {"vtu"}
  /// Tells whether a call with these words would be understood. @throws Error(usage) where not
  std::function<void(const std::vector<std::string>& words)> check;
};

/// One case of a cohort: an input, and how it is meshed.
struct CohortCase {
  std::string id;                    ///< the name of its folder
  std::vector<std::string> inputs;   ///< INPUT of the command
  std::vector<OptionValue> options;  ///< those of all cases and its own, ascending by name
};

/// The words of the options as the command line takes them: "--edge-length=2".
std::vector<std::string> words_of(const std::vector<OptionValue>& options);

/// The options of all cases, with those of one case in place of the ones of the same name; ascending by name.
std::vector<OptionValue> merged(const std::vector<OptionValue>& of_all, const std::vector<OptionValue>& own);

/// What makes `id` unfit for the name of a folder ("holds a slash"); "" where nothing does.
std::string fault_of_id(const std::string& id);

}  // namespace stackmesh
