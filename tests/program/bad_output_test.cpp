// Outputs that cannot be written (exit 5), and the volume mesher's worker killed or out of time (exit 4).
#include <linux/capability.h>
#include <sched.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include "program.h"

namespace program {
namespace {

namespace fs = std::filesystem;

class BadOutput : public ProgramTest {
 protected:
  const std::string input_ = testdata("border.nii.gz");
};

/// Root may write anywhere; without this capability it may not.
bool obey_permissions() {
  return ::geteuid() != 0 || ::prctl(PR_CAPBSET_DROP, CAP_DAC_OVERRIDE, 0, 0, 0) == 0;
}

TEST_F(BadOutput, FolderThatIsNotThere) {
  fails(5, {"mesh", input_, "-o", out("none/a.vtu")}, {out("none/a.vtu"), "create the folder"});
  fails(5, {"mesh", input_, "-o", out("a.vtu"), "--report", out("none/R.json")}, {out("none/R.json")});
  fails(5, {"surface", input_, "-o", out("a.stl"), "-o", out("none/a.ply")}, {out("none/a.ply")});
  fails(5, {"contours", input_, "-o", out("none/a.json")}, {out("none/a.json")});
}

TEST_F(BadOutput, FolderThatMayNotBeWritten) {
  const std::string folder = out("locked");
  fs::create_directories(folder);
  ::chmod(folder.c_str(), 0555);
  Around around;
  around.in_child = obey_permissions;
  if (stackmesh({"--version"}, around).code == 99) GTEST_SKIP() << "NOT TESTED: root may not give up its rights here";
  fails(5, {"mesh", input_, "-o", folder + "/a.vtu"}, {folder + "/a.vtu", "may write"}, {"locked"}, around);
  EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(BadOutput, FileThatMayNotBeReplaced) {
  std::ofstream(out("a.vtu")) << "precious";
  ::chmod(out("a.vtu").c_str(), 0444);
  Around around;
  around.in_child = obey_permissions;
  if (stackmesh({"--version"}, around).code == 99) GTEST_SKIP() << "NOT TESTED: root may not give up its rights here";
  fails(5, {"mesh", input_, "-o", out("a.vtu")}, {out("a.vtu")}, {"a.vtu"}, around);
  EXPECT_EQ(read_file(out("a.vtu")), "precious");
}

TEST_F(BadOutput, OutputIsAFolder) {
  fs::create_directories(out("a.vtu"));
  fails(5, {"mesh", input_, "-o", out("a.vtu")}, {out("a.vtu"), "name a file"}, {"a.vtu"});
  EXPECT_TRUE(fs::is_empty(out("a.vtu")));
}

TEST_F(BadOutput, OutputIsADevice) {
  fs::create_symlink("/dev/full", out("a.vtu"));
  fails(5, {"mesh", input_, "-o", out("a.vtu")}, {out("a.vtu")}, {"a.vtu"});
  EXPECT_TRUE(fs::is_symlink(out("a.vtu")));
}

TEST_F(BadOutput, OneBadOutputKeepsTheOthersBack) {
  std::ofstream(out("a.vtu")) << "of an earlier run";
  fails(5, {"mesh", input_, "-o", out("a.vtu"), "-o", out("none/a.msh"), "--report", out("R.json")},
        {out("none/a.msh")}, {"a.vtu"});
  EXPECT_EQ(read_file(out("a.vtu")), "of an earlier run");
}

TEST_F(BadOutput, DiskFull) {
  // In a mount namespace of this process, so that nothing stays mounted.
  const std::string disk = out("disk");
  fs::create_directories(disk);
  if (::unshare(CLONE_NEWNS) != 0 || ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
      ::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=64k") != 0)
    GTEST_SKIP() << "NOT TESTED: a small tmpfs cannot be mounted here (" << std::strerror(errno) << ")";
  for (const auto& outputs : {std::vector<std::string>{"-o", disk + "/a.vtu"},
                              {"-o", disk + "/a.stl", "-o", disk + "/a.inp"},
                              {"-o", disk + "/a.mesh", "--report", disk + "/R.json"}}) {
    std::vector<std::string> arguments = {"mesh", input_};
    arguments.insert(arguments.end(), outputs.begin(), outputs.end());
    fails(5, arguments, {"No space left", disk, "free some space"}, {"disk"});
    EXPECT_TRUE(fs::is_empty(disk));
  }
  succeeds({"mesh", testdata("tube.cnt"), "-o", disk + "/a.off"});  // this one fits
  ::umount2(disk.c_str(), MNT_DETACH);
}

TEST_F(BadOutput, FileLargerThanAllowed) {
  Around around;
  around.in_child = [] {
    const rlimit limit = {100000, 100000};
    ::signal(SIGXFSZ, SIG_IGN);
    return ::setrlimit(RLIMIT_FSIZE, &limit) == 0;
  };
  std::ofstream(out("a.vtu")) << "of an earlier run";
  fails(5, {"mesh", input_, "-o", out("a.vtu")}, {out("a.vtu")}, {"a.vtu"}, around);
  EXPECT_EQ(read_file(out("a.vtu")), "of an earlier run");
}

// ---- the worker ----

class Worker : public ProgramTest {
 protected:
  const std::string input_ = testdata("femur.nii.gz");
  /// A refused volume: the report is there and says so, and nothing else is.
  void check_report() const {
    const Json r = report();
    EXPECT_EQ(r.at("volume").at("closure"), "failed");
    EXPECT_TRUE(r.at("volume").at("tets").is_null());
    EXPECT_EQ(r.at("surface").at("open_edges"), 0);
    EXPECT_EQ(r.at("surface").at("self_intersections"), 0);
    EXPECT_EQ(r.at("labels").size(), 2u);
    for (const Json& l : r.at("labels")) EXPECT_TRUE(l.at("tet_volume_mm3").is_null());
  }
};

/// The children of a process, by /proc.
std::vector<int> children_of(int pid) {
  std::vector<int> found;
  const std::string id = std::to_string(pid);
  std::istringstream list(read_file("/proc/" + id + "/task/" + id + "/children"));
  for (int child; list >> child;) found.push_back(child);
  return found;
}

bool is_worker(int pid) {
  return read_file("/proc/" + std::to_string(pid) + "/cmdline").find("--tetgen-worker") != std::string::npos;
}

TEST_F(Worker, OutOfTimeIsExit4WithTheReport) {
  fails(4, {"mesh", input_, "-o", out("a.vtu"), "-o", out("a.stl"), "--report", out("R.json"), "--timeout", "0.05"},
        {"was ended after", input_, "--timeout"}, {"R.json"});
  check_report();
}

TEST_F(Worker, KilledIsExit4WithTheReport) {
  Around around;
  int killed = 0;
  around.while_running = [&](int pid) {
    for (int child : children_of(pid))
      if (is_worker(child) && ::kill(child, SIGKILL) == 0) ++killed;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  fails(4, {"mesh", input_, "-o", out("a.vtu"), "--report", out("R.json")}, {"killed by signal 9", input_}, {"R.json"},
        around);
  EXPECT_GT(killed, 0);
  check_report();
}

TEST_F(Worker, EndsWithTheProgram) {
  int worker = 0;
  Around around;
  around.while_running = [&](int pid) {
    for (int child : children_of(pid))
      if (worker == 0 && is_worker(child)) {
        worker = child;
        ::kill(pid, SIGTERM);
      }
  };
  const Ended r = stackmesh({"mesh", input_, "-o", out("a.vtu")}, around);
  ASSERT_NE(worker, 0);
  EXPECT_EQ(r.code, -SIGTERM);
  EXPECT_EQ(written(), std::vector<std::string>{});
  for (int i = 0; i < 200 && is_worker(worker); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_FALSE(is_worker(worker)) << "the worker is still there 10 s later";
}

}  // namespace
}  // namespace program
