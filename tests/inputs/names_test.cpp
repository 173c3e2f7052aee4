// Names and colours on their way from the input to every output.
#include <filesystem>

#include "inputs.h"

namespace {

using namespace inputs;

class Names : public InputTest {
 protected:
  void expect_in_vtk(const std::string& file, const std::vector<std::string>& lines) {
    const Ended r = program::python("vtk_names.py", {file});
    if (r.code == 77) GTEST_SKIP() << r.out;
    EXPECT_EQ(r.code, 0) << r.err;
    EXPECT_EQ(program::lines_of(r.out), lines);
  }
};

TEST_F(Names, TravelFromAStructureSetToEveryOutput) {
  written_by("write_rtstruct.py", {"box", "latin"});
  if (IsSkipped() || HasFatalFailure()) return;
  const Json r =
      mesh(in("box.dcm"), {"-o", out("a.vtp"), "-o", out("a.msh"), "-o", out("a.inp"), "--names", out("names.json")});
  const Json colour = {10, 200, 30};
  EXPECT_EQ(row(r, 1).at("name"), "Lt Lung");
  EXPECT_EQ(row(r, 1).at("colour"), colour);
  const Json names = Json::parse(program::read_file(out("names.json")));
  EXPECT_EQ(names, (Json{{"labels", {{{"label", 1}, {"name", "Lt Lung"}, {"colour", colour}}}}}));
  EXPECT_NE(program::read_file(out("a.msh")).find("3 1 \"Lt Lung\""), std::string::npos);
  EXPECT_NE(program::read_file(out("a.inp")).find("ELSET=Lt_Lung"), std::string::npos);
  expect_in_vtk(out("a.vtu"), {"1 10 200 30 Lt Lung"});
  expect_in_vtk(out("a.vtp"), {"1 10 200 30 Lt Lung"});
  mesh(in("latin.dcm"));
  expect_in_vtk(out("a.vtu"), {"1 255 255 255 H\u00fcfte"});
}

TEST_F(Names, ComeFromALabelTableForPlainVolumes) {
  const std::string table = write(
      "labels.ctbl", "# Color table file\n0 Background 0 0 0 0\n1 Outer_wall 200 100 50 255\n2 Inner 1 2 3 255\n");
  const std::string file = program::testdata("femur.nii.gz");
  const Json r = mesh(file, {"--names", table, "--names", out("names.json"), "--label", "Inner", "--interpolate", "0",
                             "--simplify", "1"});
  ASSERT_EQ(r.at("labels").size(), 1u);
  EXPECT_EQ(row(r, 2).at("name"), "Inner");
  EXPECT_EQ(row(r, 2).at("colour"), (Json{1, 2, 3}));
  EXPECT_TRUE(std::filesystem::exists(out("names.json")));
  fails(2, {"mesh", file, "--names", table, "--names", "other.txt", "-o", out("b.vtu")}, {"two label tables"},
        written());
}

}  // namespace
