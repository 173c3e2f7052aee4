// Shared objects that are loaded when they are needed: absent, broken, of another version.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "program.h"

namespace program {
namespace {

class Parts : public ProgramTest {
 protected:
  /// Runs with the folder `out("parts")` as the folder of parts.
  Ended with_parts(const std::vector<std::string>& arguments) const {
    Around around;
    around.in_child = [&] { return ::setenv("STACKMESH_PARTS", out("parts").c_str(), 1) == 0; };
    return stackmesh(arguments, around);
  }
  std::vector<std::string> to(const std::string& name) const {
    return {"mesh", testdata("border.nii.gz"), "-o", out(name), "--no-enhance"};
  }
  void refused(const std::string& why) const {
    for (const char* name : {"a.exo", "a.med"}) {
      const Ended r = with_parts(to(name));
      EXPECT_EQ(r.code, 4) << r.err;
      EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
      for (const std::string& part : {why, std::string("stackmesh-hdf5.so"), std::string("STACKMESH_PARTS")})
        EXPECT_NE(r.err.find(part), std::string::npos) << r.err;
    }
  }
};

TEST_F(Parts, AreNeededForTheirFilesAlone) {
  std::filesystem::create_directory(out("parts"));
  EXPECT_EQ(with_parts(to("a.vtu")).code, 0);
  EXPECT_EQ(with_parts({"--version"}).code, 0);
}

TEST_F(Parts, ThatAreAbsentOrBrokenAreToldInOneLine) {
  std::filesystem::create_directory(out("parts"));
  refused("is not installed");
  std::ofstream(out("parts/stackmesh-hdf5.so")) << "no shared object";
  refused("cannot be loaded");
  EXPECT_FALSE(std::filesystem::exists(out("a.exo")));
}

}  // namespace
}  // namespace program
