// Wrong calls (exit 2) and the answers of --help and --version.
#include "program.h"

namespace program {
namespace {

class Usage : public ProgramTest {
 protected:
  /// `mesh border.nii.gz -o out/a.vtu OPTIONS...` is wrong usage.
  void wrong(const std::vector<std::string>& options, const std::vector<std::string>& parts) const {
    std::vector<std::string> arguments = {"mesh", testdata("border.nii.gz"), "-o", out("a.vtu")};
    arguments.insert(arguments.end(), options.begin(), options.end());
    fails(2, arguments, parts);
  }
};

TEST_F(Usage, NoCommandOrAnUnknownOne) {
  fails(2, {}, {"no command", "mesh, surface, fem, contours, info, validate"});
  fails(2, {""}, {"unknown command ''"});
  fails(2, {"frobnicate"}, {"unknown command 'frobnicate'", "mesh, surface"});
  fails(2, {"frobnicate", "--help"}, {"unknown command 'frobnicate'"});
  fails(2, {testdata("border.nii.gz"), "-o", out("a.vtu")}, {"unknown command"});
  fails(2, {"me\nsh"}, {"unknown command 'me sh'"});
}

TEST_F(Usage, MissingInputOrOutput) {
  for (const char* command : {"mesh", "surface", "contours"}) {
    fails(2, {command}, {"is required"});
    fails(2, {command, testdata("border.nii.gz")}, {"--output is required"});
    fails(2, {command, "-o", out("a.stl")}, {"INPUT is required"});
  }
  fails(2, {"info"}, {"INPUT is required"});
}

TEST_F(Usage, UnknownOption) {
  wrong({"--frobnicate"}, {"--frobnicate"});
  wrong({"--frobnicate", "7"}, {"--frobnicate"});
  wrong({"-q"}, {"-q"});
  fails(2, {"info", testdata("border.nii.gz"), "--merge"}, {"--merge"});
  wrong({"--edge-lenght", "3"}, {"--edge-lenght", "did you mean --edge-length?"});
  wrong({"--refin=1"}, {"did you mean --refine?"});
}

TEST_F(Usage, TwoWordsOnTheNumberOfElements) {
  wrong({"--target-tets", "5000", "--edge-length", "3"}, {"--target-tets and --edge-length", "give one"});
  wrong({"--target-tets", "5000", "--no-enhance"}, {"--target-tets and --no-enhance", "give one"});
}

TEST_F(Usage, BadNumbers) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> bad = {
      {"--simplify", {"abc", "", "nan", "inf", "-1", "0.5x"}},
      {"--snap", {"nan", "-0.5"}},
      {"--threads", {"0", "1.5", "many", "99999"}},
      {"--timeout", {"0", "inf"}},
      {"--max-volume", {"0", "nan", "1=0", "1=2,3"}},
      {"--radius-edge", {"0.5"}},
      {"--dihedral", {"-1", "60"}},
      {"--deviation", {"0"}},
      {"--gradation", {"0.9"}},
      {"--smooth", {"-1", "x"}},
      {"--target-tets", {"0"}},
      {"--order", {"3"}},
      {"--refine", {"-1", "9", "x"}},
      {"--interpolate", {"x", "-1", "1.5"}},
      {"--edge-length", {"x", "0", "1=2,3", "1,2", "=2", "1="}}};
  for (const auto& [option, values] : bad)
    for (const std::string& value : values) wrong({option + "=" + value}, {option});
}

TEST_F(Usage, NumbersOfTheSpacing) {
  for (const char* bad : {"1,1", "1,1,1,1", "1,1,0", "1,-1,1", "1,x,1", "1,nan,1"})
    fails(2, {"mesh", testdata("slices_png"), "--spacing", bad, "-o", out("a.vtu")}, {"--spacing"});
}

TEST_F(Usage, BadWords) {
  wrong({"--caps", "square"}, {"'square'", "auto, flat or round"});
  wrong({"--caps", "1=flat,2"}, {"--caps"});
  wrong({"--caps", "1=square"}, {"'square'"});
  wrong({"--axis", "w"}, {"--axis", "x, y or z"});
  wrong({"--space", "lpi"}, {"--space", "lps or ras"});
  wrong({"--progress", "fancy"}, {"--progress", "plain"});
  wrong({"--label", ","}, {"--label"});
  wrong({"--label", "1,,2"}, {"--label"});
}

TEST_F(Usage, UnknownEndings) {
  const std::string input = testdata("border.nii.gz");
  for (const char* name : {"a.xyz", "a", "vtu", "a.vtu.gz", "a.json"})
    fails(2, {"mesh", input, "-o", out(name)}, {out(name), ".vtu"});
  fails(2, {"mesh", input, "-o", ""}, {"unknown ending"});
  fails(2, {"mesh", input, "-o", out("a.vtu"), "-o", out("a.xyz")}, {out("a.xyz")});
  fails(2, {"mesh", input, "-o", out("a.vtu"), "--report", out("R.txt")}, {out("R.txt"), ".json"});
  fails(2, {"contours", input, "-o", out("a.vtu")}, {out("a.vtu"), ".json, .svg or .cnt"});
}

TEST_F(Usage, ASurfaceIsNoVolume) {
  for (const char* name : {"a.vtu", "a.msh", "a.inp", "a.vtk", "a.mesh"})
    fails(2, {"surface", testdata("border.nii.gz"), "-o", out(name)}, {out(name), "surface", ".stl"});
}

TEST_F(Usage, RasNeedsAnatomy) {
  fails(2, {"mesh", testdata("slices_png"), "--spacing", "1,1,2", "--space", "ras", "-o", out("a.vtu")},
        {"--space ras", "slices_png"});
  fails(2, {"surface", testdata("tube.cnt"), "--space", "ras", "-o", out("a.stl")}, {"--space ras", "tube.cnt"});
}

TEST_F(Usage, MoreThanOneVolumeAndContoursAlongAnotherAxis) {
  fails(2, {"mesh", testdata("border.nii.gz"), testdata("noise.nii.gz"), "-o", out("a.vtu")},
        {"more than one input", "noise"});
  fails(2, {"mesh", testdata("tube.cnt"), "--axis", "x", "-o", out("a.vtu")}, {"--axis", "as they are drawn"});
}

// ---- help ----

struct Help {
  const char* command;
  std::vector<std::string> options;
};

const std::vector<std::string> both = {
    "INPUT",         "--spacing",  "--output",   "--report",      "--label",     "--merge",    "--deviation",
    "--edge-length", "--edge-min", "--edge-max", "--interpolate", "--gradation", "--simplify", "--band",
    "--as-stored",   "--snap",     "--smooth",   "--no-enhance",  "--caps",      "--axis",     "--space",
    "--per-label",   "--strict",   "--threads",  "--progress",    "--quiet",     "--verbose"};

TEST_F(Usage, HelpNamesEveryOption) {
  std::vector<std::string> mesh = both, surface = both;
  mesh.insert(mesh.end(),
              {"--target-tets", "--max-volume", "--radius-edge", "--dihedral", "--order", "--timeout", "--msh2", ".vtu",
               ".msh", ".inp", ".feb", ".bdf", ".vtk", ".mesh", ".stl", ".ply", ".obj", ".off", ".vtp"});
  surface.insert(surface.end(), {"--raw", ".stl", ".ply", ".obj", ".off", ".vtp"});
  for (const Help& help :
       {Help{"mesh", mesh}, Help{"surface", surface},
        Help{"contours",
             {"INPUT", "--output", ".json", ".svg", ".cnt", "--label", "--merge", "--simplify", "--axis", "--spacing"}},
        Help{"info", {"INPUT", "--json", "--spacing"}}}) {
    const Ended r = succeeds({help.command, "--help"});
    EXPECT_EQ(r.err, "");
    EXPECT_NE(r.out.find(std::string("stackmesh ") + help.command), std::string::npos);
    for (const std::string& option : help.options)
      EXPECT_NE(r.out.find(option), std::string::npos) << option << " is not in: " << r.out;
  }
}

TEST_F(Usage, HelpTellsTheDefaults) {
  const std::string help = succeeds({"mesh", "--help"}).out;
  for (const char* text :
       {"--band FLOAT=0.5", "--gradation FLOAT=1.3", "--snap FLOAT=0", "--caps TEXT=auto", "--axis TEXT=auto",
        "--space TEXT=lps", "--interpolate TEXT=auto", "at most 150,000", "=600", "=5"})
    EXPECT_NE(help.find(text), std::string::npos) << text << " is not in: " << help;
}

TEST_F(Usage, HelpAndVersionOfTheProgram) {
  const Ended help = succeeds({"--help"});
  EXPECT_EQ(help.err, "");
  for (const char* command : {"mesh", "surface", "contours", "info", "--version"})
    EXPECT_NE(help.out.find(command), std::string::npos) << command;
  const Ended version = succeeds({"--version"});
  EXPECT_EQ(version.err, "");
  EXPECT_EQ(version.out.rfind("stackmesh ", 0), 0u);
  EXPECT_EQ(lines_of(version.out).size(), 1u);
  EXPECT_NE(version.out.find('.'), std::string::npos);
}

}  // namespace
}  // namespace program
