#pragma once
#include <stdexcept>
#include <string>

namespace stackmesh {

/// Why a run ended; the values are the exit codes of the program (docs: CONTRACT, "Exit codes").
enum class ErrorKind {
  usage = 2,           ///< the call itself is wrong
  input = 3,           ///< the input cannot be read or is invalid
  no_result = 4,       ///< no valid result exists or was found
  output = 5,          ///< the output cannot be written
  outside_limits = 6,  ///< `validate`: a valid mesh, but outside a limit
  internal = 70,       ///< a bug of ours
  cancelled = 130      ///< the monitor of the run ended it
};

/// The one exception of the library. It carries what is wrong, where (file, section, label, entities) and
/// how to mend it; what() joins them as "WHAT, WHERE; HOW TO MEND".
class Error : public std::runtime_error {
 public:
  /// Each text is a part of what(), without a full stop.
  Error(ErrorKind kind, const std::string& what_is_wrong, const std::string& where, const std::string& how_to_mend);
  ErrorKind kind() const noexcept { return kind_; }                 ///< the exit code of the program
  const std::string& problem() const noexcept { return problem_; }  ///< what is wrong
  const std::string& where() const noexcept { return where_; }      ///< file, section, label, entities or option
  const std::string& mend() const noexcept { return mend_; }        ///< what to do about it

 private:
  ErrorKind kind_;
  std::string problem_, where_, mend_;
};

/// Shorthands: throw the error of that kind.
[[noreturn]] void fail_usage(const std::string& what, const std::string& where, const std::string& mend);
[[noreturn]] void fail_input(const std::string& what, const std::string& where, const std::string& mend);
[[noreturn]] void fail_output(const std::string& what, const std::string& where, const std::string& mend);
[[noreturn]] void fail_internal(const std::string& what, const std::string& where);

}  // namespace stackmesh
