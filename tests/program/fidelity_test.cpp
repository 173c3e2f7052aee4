// apps/make_fidelity.py on one small cell: labels made, both runs judged against the true shape beside windowed sinc,
// the rest taken from the cache at the second go.
#include <filesystem>
#include <regex>

#include "program.h"

namespace program {
namespace {

namespace fs = std::filesystem;

const std::string kTools = STACKMESH_SHARED_DATA "/../tools";

class Fidelity : public ProgramTest {
 protected:
  Ended make(std::vector<std::string> more, const std::string& tools = kTools) const {
    std::vector<std::string> command = {"/usr/bin/python3", STACKMESH_SOURCE_DIR "/apps/make_fidelity.py",
                                        "--program",        STACKMESH_PROGRAM,
                                        "--tools",          tools,
                                        "--cache",          out("cache")};
    command.insert(command.end(), more.begin(), more.end());
    return run(command);
  }
};

TEST_F(Fidelity, OneCellIsMadeJudgedAndKept) {
  if (!fs::exists(kTools + "/truth.py")) GTEST_SKIP() << "NOT TESTED: needs " << kTools << "/truth.py";
  const std::vector<std::string> cell = {"--only", "sphere", "--modes", "iso2"};
  const Ended first = make(cell);
  ASSERT_EQ(first.code, 0) << first.err;
  // | sphere | limits | mm / deg | above 20 | volume | triangles | peers; bold where a limit is missed
  const std::string figure = R"(\**([-+]?[0-9.,]+)\**)";
  const std::regex edged(R"(\| sphere \| 0\.13 / 5\.8 \| )" + figure + " / " + figure + R"([^|]*\| )" + figure +
                         R"( \| )" + figure + R"( \| )" + figure + R"( \| )" + figure + " / " + figure + R"( \| )" +
                         figure + " / " + figure);
  std::smatch m;
  ASSERT_TRUE(std::regex_search(first.out, m, edged)) << first.out;
  const double mm = std::stod(m[1]), deg = std::stod(m[2]), volume = std::stod(m[4]);
  EXPECT_GT(mm, 0.01);
  EXPECT_LT(mm, 0.2);
  EXPECT_GT(deg, 0.5);
  EXPECT_LT(deg, 8);
  EXPECT_LT(std::abs(volume), 1);
  EXPECT_NEAR(std::stod(m[8]), 0.125, 0.01);  // windowed sinc 0.5 of a sphere in voxels of 2 mm
  EXPECT_NEAR(std::stod(m[9]), 3.0, 0.3);
  EXPECT_NE(first.err.find("sphere_iso2_sinc0.5: "), std::string::npos) << first.err;
  const Ended again = make(cell);
  EXPECT_EQ(again.code, 0);
  EXPECT_EQ(again.out, first.out);
  EXPECT_EQ(again.err, "");  // nothing was measured
}

TEST_F(Fidelity, WhatIsMissingIsSaidInOneLine) {
  const auto refused = [](const Ended& r, const std::string& part) {
    EXPECT_EQ(r.code, 1);
    EXPECT_EQ(r.err.rfind("make_fidelity.py: error: ", 0), 0u) << r.err;
    EXPECT_EQ(lines_of(r.err).size(), 1u) << r.err;
    EXPECT_NE(r.err.find(part), std::string::npos) << r.err;
  };
  refused(make({}, in("nowhere")), "--tools");
  refused(make({"--program", in("nowhere")}), "--program");
  refused(make({"--modes", "iso7"}), "'iso7'");
  refused(make({"--only", "cube"}), "'cube'");
}

}  // namespace
}  // namespace program
