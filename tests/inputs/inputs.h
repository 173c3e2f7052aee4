#pragma once
// What the tests of inputs share: files written by another program, and the mesh that comes of them.
#include <algorithm>
#include <array>
#include <cmath>
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
    std::vector<std::string> arguments = {"mesh", input,        "--no-enhance", "-o",         out("a.vtu"),
                                          "-o",   out("a.obj"), "--report",     out("R.json")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    last_ = succeeds(arguments);
    const Json r = report();
    EXPECT_EQ(r.at("volume").at("closure"), "verified");
    return r;
  }

  static double volume(const Json& report, int label) { return row(report, label).at("tet_volume_mm3"); }

  /// What CASE.json says must be read.
  Json expected(const std::string& name) const { return Json::parse(program::read_file(in(name + ".json"))); }

  /// `info --json` of it.
  static Json info(const std::string& input, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"info", input, "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Json::parse(succeeds(arguments).out, nullptr, false);
  }

  /// Labels, names, colours and voxels that `info` gives against CASE.json. @return what `info` gave
  Json expect_labels(const std::string& name) const {
    SCOPED_TRACE(name);
    const Json wanted = expected(name), found = info(wanted.at("path"));
    EXPECT_EQ(found.at("labels").size(), wanted.at("labels").size()) << found.dump();
    for (std::size_t i = 0; i < wanted.at("labels").size() && i < found.at("labels").size(); ++i) {
      const Json &w = wanted.at("labels")[i], &f = found.at("labels")[i];
      for (const char* field : {"label", "name", "voxels"}) EXPECT_EQ(f.at(field), w.at(field)) << field;
      EXPECT_EQ(f.at("colour").is_null(), w.at("colour").is_null());
      for (std::size_t c = 0; c < 3 && !w.at("colour").is_null(); ++c)
        EXPECT_NEAR(f.at("colour")[c].get<int>(), w.at("colour")[c].get<int>(), 1) << "colour " << c;
    }
    return found;
  }

  /// The stitched surface of the first label has a vertex at every corner of its box, where a Python reader puts it.
  void expect_corners(const std::string& name) {
    SCOPED_TRACE(name);
    const Json wanted = expected(name);
    mesh(wanted.at("path"), {"--simplify", "0", "--band", "0", "--interpolate", "0", "--caps", "flat", "--label",
                             wanted.at("labels")[0].at("label").dump()});
    const std::vector<std::array<double, 3>> found = vertices();
    ASSERT_EQ(wanted.at("corners").size(), 8u);
    for (const Json& c : wanted.at("corners")) {
      double nearest = 1e300;
      for (const auto& p : found)
        nearest = std::min(nearest,
                           std::hypot(p[0] - c[0].get<double>(), p[1] - c[1].get<double>(), p[2] - c[2].get<double>()));
      EXPECT_LT(nearest, 1e-6) << c.dump();
    }
  }

  std::vector<std::array<double, 3>> vertices() const {
    std::vector<std::array<double, 3>> points;
    for (const std::string& line : program::lines_of(program::read_file(out("a.obj")))) {
      std::array<double, 3> p{};
      if (std::sscanf(line.c_str(), "v %lf %lf %lf", &p[0], &p[1], &p[2]) == 3) points.push_back(p);
    }
    return points;
  }

  /// Smallest and largest coordinates of the last mesh().
  std::array<double, 6> bounds() const {
    std::array<double, 6> b = {1e300, -1e300, 1e300, -1e300, 1e300, -1e300};
    for (const auto& p : vertices())
      for (int i = 0; i < 3; ++i) {
        b[2 * i] = std::min(b[2 * i], p[i]);
        b[2 * i + 1] = std::max(b[2 * i + 1], p[i]);
      }
    return b;
  }

  Ended last_;
};

inline void expect_bounds(const std::array<double, 6>& b, const std::array<double, 6>& wanted, double tolerance) {
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(b[i], wanted[i], tolerance) << "bound " << i;
}

}  // namespace inputs
