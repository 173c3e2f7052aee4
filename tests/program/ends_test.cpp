// How a run ends: what is left behind, what is kept of what was there, and what it says.
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "../image/image_files.h"
#include "program.h"

namespace program {
namespace {

namespace fs = std::filesystem;

class Ends : public ProgramTest {
 protected:
  const std::string input_ = testdata("border.nii.gz");
  std::vector<std::string> to(const std::string& name) const {
    return {"mesh", input_, "-o", out(name), "--no-enhance"};
  }
};

std::vector<int> workers_of(int pid) {
  std::vector<int> found;
  for (const auto& task : fs::directory_iterator("/proc/" + std::to_string(pid) + "/task")) {
    std::istringstream list(read_file(task.path().string() + "/children"));
    for (int child; list >> child;)
      if (read_file("/proc/" + std::to_string(child) + "/cmdline").find("--tetgen-worker") != std::string::npos)
        found.push_back(child);
  }
  return found;
}

TEST_F(Ends, SignalsLeaveNothingBehind) {
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
    // A slow reader of the report keeps the run in its writing: here, many outputs.
    std::vector<std::string> arguments = {"mesh", testdata("femur.nii.gz"), "--no-enhance", "--interpolate", "0"};
    for (int i = 0; i < 12; ++i) arguments.insert(arguments.end(), {"-o", out("a" + std::to_string(i) + ".vtu")});
    bool seen = false;
    Around around;
    around.while_running = [&](int pid) {
      if (seen) return;
      for (const std::string& name : written()) seen = seen || name.find(".part") != std::string::npos;
      if (seen) ::kill(pid, signal);
    };
    const Ended r = stackmesh(arguments, around);
    EXPECT_TRUE(seen);
    EXPECT_EQ(r.code, -signal);
    EXPECT_EQ(written(), std::vector<std::string>{});
  }
}

TEST_F(Ends, WhatAKilledRunLeftGoesAtTheNextStart) {
  std::ofstream(out("a.vtu.part999999999-0")) << "half";  // no such process
  std::ofstream(out("b.stl.part999999999-3")) << "half";
  std::ofstream(out("a.vtu.part" + std::to_string(::getpid()) + "-0")) << "another run's";
  std::ofstream(out("a.vtu.parts")) << "the user's";
  fails(3, {"mesh", in("absent.nii"), "-o", out("a.vtu"), "-o", out("b.stl")}, {"does not exist"},
        {"a.vtu.part" + std::to_string(::getpid()) + "-0", "a.vtu.parts"});
}

TEST_F(Ends, ModeAndLinksOfWhatIsReplacedAreKept) {
  std::ofstream(out("a.vtu")) << "old";
  ::chmod(out("a.vtu").c_str(), 0604);
  fs::create_directories(out("elsewhere"));
  fs::create_symlink("elsewhere/new.vtu", out("dangling.vtu"));
  std::ofstream(out("elsewhere/b.vtu")) << "old";
  fs::create_symlink("elsewhere/b.vtu", out("b.vtu"));
  succeeds({"mesh", input_, "--no-enhance", "-o", out("a.vtu"), "-o", out("b.vtu"), "-o", out("dangling.vtu")});
  struct stat info;
  ASSERT_EQ(::stat(out("a.vtu").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 07777, 0604u);
  for (const char* link : {"b.vtu", "dangling.vtu"}) EXPECT_TRUE(fs::is_symlink(out(link))) << link;
  for (const char* file : {"a.vtu", "elsewhere/b.vtu", "elsewhere/new.vtu"})
    EXPECT_GT(fs::file_size(out(file)), 10000u) << file;
}

TEST_F(Ends, OutputsAreLookedAtBeforeTheInput) {
  const std::string input = write("in.nii.gz", read_file(input_));
  fs::create_hard_link(input, in("hard.vtu"));
  fs::create_symlink(input, in("soft.vtu"));
  Around there;
  there.folder = folder_ + "/out";
  fails(2, {"mesh", input, "-o", "a.vtu", "-o", "./a.vtu"}, {"one file", "a.vtu"}, {}, there);
  fails(2, {"mesh", input, "-o", out("a.vtu"), "--report", out("R.json"), "--names", out("R.json")}, {"one file"});
  for (const char* name : {"hard.vtu", "soft.vtu"})
    fails(2, {"mesh", input, "-o", in(name)}, {"would replace an input"});
  const std::string contours = write("c.cnt", read_file(testdata("tube.cnt")));
  fails(2, {"contours", "3=" + contours, "-o", contours}, {"would replace an input"});
  fails(2, {"validate", write("m.json", "{}"), "--report", in("m.json")}, {"would replace an input"});
  fails(5, {"mesh", in("absent.nii"), "-o", out("none/a.vtu")}, {"create the folder"});
  EXPECT_EQ(read_file(input), read_file(input_));
}

TEST_F(Ends, StandardOutputThatIsFullIsExit5) {
  Around around;
  around.in_child = [] { return ::freopen("/dev/full", "w", stdout) != nullptr && ::dup2(::fileno(stdout), 1) == 1; };
  for (const auto& arguments : {std::vector<std::string>{"info", input_}, {"info", input_, "--json"}, {"--help"}}) {
    const Ended r = stackmesh(arguments, around);
    EXPECT_EQ(r.code, 5) << r.err;
    EXPECT_NE(r.err.find("standard output"), std::string::npos) << r.err;
  }
}

TEST_F(Ends, ControlCharactersOfNamesReachNoTerminal) {
  using namespace image_files;
  const std::string evil = "a\x1b[31m\nstackmesh: error: b\xc2\x9b";
  const auto clean = [](const Ended& r) {
    for (const std::string& text : {r.out, r.err}) {
      EXPECT_EQ(text.find('\x1b'), std::string::npos);
      EXPECT_EQ(text.find("\xc2\x9b"), std::string::npos);
      EXPECT_NE(text.rfind("\nstackmesh: error", 0), 0u);
      EXPECT_EQ(text.find("\nstackmesh: error"), std::string::npos);
    }
  };
  const std::string mask = nrrd("uchar", lps_grid, pack<std::uint8_t>(twelve));
  write("m/" + evil + ".nrrd", mask);
  clean(succeeds({"info", in("m")}));
  clean(succeeds({"mesh", in("m"), "--no-enhance", "-o", out("a.vtu")}));
  clean(succeeds({"mesh", in("m"), "--no-enhance", "-o", out(evil + ".vtu")}));
  const std::string square = "{\n0 0\n10 0\n10 10\n0 10\n}\n";
  const std::string contours = write("c.cnt", "S 3\nv 4 z 0\n" + square + "v 4 z 1\n" + square);
  clean(stackmesh({"info", evil + "=" + contours}));
  clean(stackmesh({"info", in(evil)}));
  clean(stackmesh({evil}));
}

TEST_F(Ends, ABadTemporaryFolderIsTheUsersToMend) {
  const std::string folder = shared_data("torso_totalseg/ct_dicom");
  if (folder.empty()) GTEST_SKIP() << "NOT TESTED: " STACKMESH_SHARED_DATA "/torso_totalseg/ct_dicom is not there";
  Around around;
  around.in_child = [] { return ::setenv("TMPDIR", "/nonexistent", 1) == 0; };
  fails(5, {"info", folder}, {"TMPDIR", "/nonexistent"}, {}, around);
}

TEST_F(Ends, AFifoIsNoInput) {
  ASSERT_EQ(::mkfifo(in("f.nii").c_str(), 0600), 0);
  fails(3, {"info", in("f.nii")}, {"no regular file"});
  ASSERT_EQ(::mkfifo(in("s.png").c_str(), 0600), 0);
  fails(3, {"info", in("s.png")}, {"no regular file"});
}

TEST_F(Ends, ABoundOnFileSizesIsAnErrorAndNoSignal) {
  Around around;
  around.in_child = [] {
    const rlimit size{20000, 20000};
    return ::setrlimit(RLIMIT_FSIZE, &size) == 0;
  };
  fails(5, to("a.vtu"), {"File too large", "free some space"}, {}, around);
}

TEST_F(Ends, AWorkerThatIsKilledOnceCostsAWarningAndNothingElse) {
  const std::vector<std::string> arguments = {"mesh",      testdata("femur.nii.gz"), "--interpolate", "0", "-o",
                                              out("a.vtu")};
  succeeds(arguments);
  const std::string undisturbed = read_file(out("a.vtu"));
  int killed = 0;
  Around around;
  around.while_running = [&](int pid) {
    if (killed > 0) return;
    std::error_code gone;
    if (!fs::exists("/proc/" + std::to_string(pid) + "/task", gone)) return;
    try {
      for (const int worker : workers_of(pid))
        if (killed == 0 && ::kill(worker, SIGKILL) == 0) ++killed;
    } catch (const fs::filesystem_error&) {  // it has just ended
    }
  };
  const Ended r = stackmesh(arguments, around);
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_GT(killed, 0);
  EXPECT_TRUE(r.warns_of("started again")) << r.err;
  EXPECT_EQ(read_file(out("a.vtu")), undisturbed);
}

}  // namespace
}  // namespace program
