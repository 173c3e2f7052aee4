// The same bytes for one thread and two, and from run to run.
#include "program.h"

namespace program {
namespace {

class SameBytes : public ProgramTest, public ::testing::WithParamInterface<const char*> {
 protected:
  void write_all(const std::string& name, const std::string& threads) const {
    const std::string input = testdata(GetParam());
    std::vector<std::string> volume = {"mesh", input, "--threads", threads},
                             msh2 = {"mesh", input, "--threads", threads, "--msh2", "-o", out(name + "_2.msh")},
                             surfaces = {"surface", input, "--threads", threads, "--per-label"};
    for (const char* ending : {"vtu", "msh", "inp", "feb", "bdf", "vtk", "mesh", "stl", "ply", "obj", "off", "vtp"})
      volume.insert(volume.end(), {"-o", out(name + "." + ending)});
    for (const char* ending : {"stl", "ply", "obj", "off", "vtp"})
      surfaces.insert(surfaces.end(), {"-o", out(name + "." + ending)});
    succeeds(volume);
    succeeds(msh2);
    succeeds(surfaces);
    for (const char* ending : {"json", "svg", "cnt"})
      succeeds({"contours", input, "--threads", threads, "-o", out(name + "_c." + ending)});
  }
};

TEST_P(SameBytes, OneThreadTwoThreadsAndAgain) {
  write_all("one", "1");
  write_all("two", "2");
  write_all("new", "2");
  int compared = 0;
  for (const std::string& file : written()) {
    if (file.rfind("one", 0) != 0) continue;
    const std::string bytes = read_file(out(file)), rest = file.substr(3);
    EXPECT_GT(bytes.size(), 80u) << file;
    // Not EXPECT_EQ, which would print the files.
    EXPECT_TRUE(bytes == read_file(out("two" + rest))) << file << " differs between one thread and two";
    EXPECT_TRUE(bytes == read_file(out("new" + rest))) << file << " differs from run to run";
    ++compared;
  }
  EXPECT_GE(compared, 10 + 1 + 2 * 5 + 2 + 2);
}

INSTANTIATE_TEST_SUITE_P(Testdata, SameBytes, ::testing::Values("heart4.nii.gz", "noise.nii.gz"),
                         [](const auto& p) { return std::string(p.param).substr(0, std::string(p.param).find('.')); });

}  // namespace
}  // namespace program
