// stackmesh as a command-line module of 3D Slicer.
#include "inputs.h"

namespace {

using namespace inputs;

class SlicerModule : public InputTest {
 protected:
  const std::string heart_ = program::testdata("heart4.nii.gz");
};

TEST_F(SlicerModule, DescribesItselfByTheRulesOfTheExecutionModel) {
  const Ended xml = succeeds({"--xml"});
  EXPECT_EQ(xml.err, "");
  const Ended r = program::python("slicer_xml.py", {write("module.xml", xml.out)});
  EXPECT_EQ(r.code, 0) << r.out << r.err;
  for (const char* flag : {"--label", "--edge-length", "--merge", "<index>1</index>"})
    EXPECT_NE(xml.out.find(flag), std::string::npos) << flag;
}

TEST_F(SlicerModule, RunsAsSlicerCallsItAndTellsItsProgress) {
  const Ended r = succeeds({"--label",
                            "1",
                            "--merge",
                            "--caps",
                            "auto",
                            "--axis",
                            "auto",
                            "--deviation",
                            "0",
                            "--gradation",
                            "1.3",
                            "--smooth",
                            "5",
                            "--interpolate",
                            "0",
                            "--noEnhance",
                            "--threads",
                            "1",
                            "--processinformationaddress",
                            "0",
                            "--returnparameterfile",
                            out("back.params"),
                            heart_,
                            out("heart.vtu")});
  EXPECT_EQ(written(), (std::vector<std::string>{"back.params", "heart.vtu"}));
  EXPECT_NE(program::read_file(out("back.params")).find("closure = verified"), std::string::npos);
  double last = -1;
  int started = 0, ended = 0;
  bool in_filter = false;
  for (const std::string& line : program::lines_of(r.out)) {
    double done = 0;
    if (line == "<filter-start>") {
      EXPECT_FALSE(in_filter);
      in_filter = true;
      ++started;
    } else if (line == "<filter-end>") {
      EXPECT_TRUE(in_filter);
      in_filter = false;
      ++ended;
    } else if (std::sscanf(line.c_str(), "<filter-progress>%lf</filter-progress>", &done) == 1) {
      EXPECT_GE(done, last);
      EXPECT_LE(done, 1);
      last = done;
    } else {
      EXPECT_EQ(line.rfind("</filter-", 0) == 0 || line.rfind("<filter-", 0) == 0, true)
          << "stdout holds '" << line << "'";
    }
  }
  EXPECT_EQ(last, 1);
  EXPECT_EQ(started, ended);
  EXPECT_GE(started, 5);
}

TEST_F(SlicerModule, GivesTheMeshOfTheSameCommand) {
  const std::string border = program::testdata("border.nii.gz");
  succeeds({"--edge-length=6", "--processinformationaddress=0", border, out("a.vtu")});
  succeeds({"mesh", border, "--edge-length", "6", "-o", out("b.vtu"), "--quiet"});
  EXPECT_EQ(program::read_file(out("a.vtu")), program::read_file(out("b.vtu")));
}

TEST_F(SlicerModule, WrongCallsAreToldInOneLine) {
  fails(2, {"--label", "1", "--processinformationaddress", "0", heart_}, {"1 files"});
  fails(2, {"--label", "1", "--nonsense", "1", heart_, out("a.vtu")}, {"--nonsense"});
  fails(2, {"--processinformationaddress", "0", heart_, out("a.vtu"), "--label"}, {"--label has no value"});
  const Ended r = program::stackmesh({"--label", "77", heart_, out("a.vtu")});
  EXPECT_EQ(r.code, 3);
  EXPECT_NE(r.err.find("label '77' is not in the input"), std::string::npos) << r.err;
  EXPECT_TRUE(written().empty());
}

}  // namespace
