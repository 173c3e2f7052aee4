#pragma once
// What the tests of inputs share: files written by another program, and the mesh that comes of them.
#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "program.h"

namespace inputs {

using program::Ended;
using program::Json;

class InputTest : public program::ProgramTest {
 protected:
  /// tests/python/SCRIPT FOLDER CASE..., which writes FOLDER/CASE.dcm or other files. Skips without its libraries.
  void written_by(const std::string& script, const std::vector<std::string>& cases) {
    std::vector<std::string> arguments = {folder_ + "/in"};
    arguments.insert(arguments.end(), cases.begin(), cases.end());
    const Ended r = program::python(script, arguments);
    if (r.code == 77) GTEST_SKIP() << r.out;
    ASSERT_EQ(r.code, 0) << r.out << r.err;
  }

  /// The report of `stackmesh mesh INPUT --no-enhance MORE... -o out/a.vtu -o out/a.obj`, which must be verified.
  Json mesh(const std::string& input, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"mesh", input, "--no-enhance", "-o", out("a.vtu"), "-o", out("a.obj"), "--report", out("R.json")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    last_ = succeeds(arguments);
    const Json r = report();
    EXPECT_EQ(r.at("volume").at("closure"), "verified");
    return r;
  }

  static double volume(const Json& report, int label) { return row(report, label).at("tet_volume_mm3"); }

  /// Smallest and largest coordinates of the last mesh().
  std::array<double, 6> bounds() const {
    std::array<double, 6> b = {1e300, -1e300, 1e300, -1e300, 1e300, -1e300};
    for (const std::string& line : program::lines_of(program::read_file(out("a.obj")))) {
      double p[3];
      if (std::sscanf(line.c_str(), "v %lf %lf %lf", p, p + 1, p + 2) != 3) continue;
      for (int i = 0; i < 3; ++i) {
        b[2 * i] = std::min(b[2 * i], p[i]);
        b[2 * i + 1] = std::max(b[2 * i + 1], p[i]);
      }
    }
    return b;
  }

  Ended last_;
};

inline void expect_bounds(const std::array<double, 6>& b, const std::array<double, 6>& wanted, double tolerance) {
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(b[i], wanted[i], tolerance) << "bound " << i;
}

}  // namespace inputs
