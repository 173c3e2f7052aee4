#pragma once
// Runs the built program as a user does, and looks at what it printed and left behind.
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace program {

using Json = nlohmann::json;

struct Ended {
  int code = -1;  ///< exit code; minus the signal that ended it
  std::string out, err;
  std::vector<std::string> warnings() const;  ///< the texts of "stackmesh: warning: TEXT" lines
  bool warns_of(const std::string& part) const;
};

/// What happens around the program's start.
struct Around {
  std::string folder;                          ///< working folder
  std::function<bool()> in_child;              ///< between fork and exec; false: give up with exit code 99
  std::function<void(int pid)> while_running;  ///< called again and again until the program has ended
};

Ended run(const std::vector<std::string>& command, const Around& around = {});
/// stackmesh ARGUMENTS...
Ended stackmesh(std::vector<std::string> arguments, const Around& around = {});
/// /usr/bin/python3 tests/python/SCRIPT ARGUMENTS...
Ended python(const std::string& script, std::vector<std::string> arguments);

std::string read_file(const std::string& path);
std::string testdata(const std::string& name);
/// A file of ../shared/data; "" when it is not there (the test should then skip, and say so).
std::string shared_data(const std::string& name);
std::vector<std::string> lines_of(const std::string& text);

/// A test with a folder for inputs and one for outputs, both removed at its end.
class ProgramTest : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;
  std::string in(const std::string& name) const { return folder_ + "/in/" + name; }
  std::string out(const std::string& name) const { return folder_ + "/out/" + name; }
  std::string write(const std::string& name, const std::string& bytes) const;  ///< an input; its path
  std::vector<std::string> written() const;  ///< names in the folder of outputs, sorted
  Json report(const std::string& name = "R.json") const;
  static const Json& row(const Json& report, int label);  ///< of a label

  /// stackmesh COMMAND ARGUMENTS must end with exit 0; its run.
  static Ended succeeds(const std::vector<std::string>& arguments);
  /// It must end with that code and one line on stderr that starts `stackmesh: error: `, says how to mend it
  /// after a semicolon and holds every one of `parts`; print nothing else; and leave nothing in the folder of
  /// outputs but `left`.
  void fails(int code, const std::vector<std::string>& arguments, const std::vector<std::string>& parts,
             const std::vector<std::string>& left = {}, const Around& around = {}) const;
  /// `fails`, for `mesh INPUT... -o out/a.vtu`, with exit code 3 and the input's path in the message.
  void refuses(const std::string& input, std::vector<std::string> parts, std::vector<std::string> more = {}) const;

  std::string folder_;
};

}  // namespace program
