// An output appears whole or not at all.
#include "base/atomic_file.h"

#include <dirent.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <functional>

#include "base/error.h"
#include "sample_mesh.h"

namespace stackmesh {
namespace {

std::vector<std::string> listing(const std::string& folder) {
  std::vector<std::string> names;
  DIR* dir = ::opendir(folder.c_str());
  if (dir == nullptr) return names;
  while (const dirent* entry = ::readdir(dir))
    if (entry->d_name[0] != '.') names.push_back(entry->d_name);
  ::closedir(dir);
  std::sort(names.begin(), names.end());
  return names;
}

/// A folder of its own, emptied of files before and after.
class AtomicFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "stackmesh_atomic_" + testing::UnitTest::GetInstance()->current_test_info()->name() +
              "_" + std::to_string(::getpid());
    ASSERT_EQ(::mkdir(folder_.c_str(), 0777), 0) << std::strerror(errno);
  }
  void TearDown() override {
    for (const std::string& name : listing(folder_)) std::remove((folder_ + "/" + name).c_str());
    ::rmdir(folder_.c_str());
  }
  std::string at(const std::string& name) const { return folder_ + "/" + name; }
  std::string folder_;
};

void put(std::FILE* file, const char* text) {
  std::fputs(text, file);
}

/// The message of the output error that the action must throw.
std::string output_error(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::output) << e.what();
    return e.what();
  }
  ADD_FAILURE() << "no error";
  return "";
}

TEST_F(AtomicFile, AppearsOnCommitOnly) {
  AtomicFiles files;
  files.write(at("a.txt"), [](std::FILE* f) { put(f, "whole"); });
  EXPECT_NE(::access(at("a.txt").c_str(), F_OK), 0);
  files.commit();
  EXPECT_EQ(read_file(at("a.txt")), "whole");
  EXPECT_EQ(listing(folder_), std::vector<std::string>{"a.txt"});
}

TEST_F(AtomicFile, WithoutCommitTheOldFileStaysAndNothingElse) {
  std::ofstream(at("a.txt")) << "old";
  {
    AtomicFiles files;
    files.write(at("a.txt"), [](std::FILE* f) { put(f, "new"); });
    files.write(at("b.txt"), [](std::FILE* f) { put(f, "new"); });
  }
  EXPECT_EQ(read_file(at("a.txt")), "old");
  EXPECT_EQ(listing(folder_), std::vector<std::string>{"a.txt"});
}

TEST_F(AtomicFile, AnExceptionOfTheWriterDropsThatFileOnly) {
  AtomicFiles files;
  files.write(at("good.txt"), [](std::FILE* f) { put(f, "good"); });
  EXPECT_THROW(files.write(at("bad.txt"),
                           [](std::FILE* f) {
                             put(f, "half");
                             throw std::runtime_error("stop");
                           }),
               std::runtime_error);
  files.commit();
  EXPECT_EQ(listing(folder_), std::vector<std::string>{"good.txt"});
}

TEST_F(AtomicFile, TheLastOfTwoWritesToOneNameStays) {
  AtomicFiles files;
  files.write(at("a.txt"), [](std::FILE* f) { put(f, "first"); });
  files.write(folder_ + "/./a.txt", [](std::FILE* f) { put(f, "second"); });
  files.commit();
  EXPECT_EQ(read_file(at("a.txt")), "second");
  EXPECT_EQ(listing(folder_).size(), 1u);
}

TEST_F(AtomicFile, ASymbolicLinkSurvives) {
  std::ofstream(at("target.txt")) << "old";
  ASSERT_EQ(::symlink("target.txt", at("link.txt").c_str()), 0);
  AtomicFiles files;
  files.write(at("link.txt"), [](std::FILE* f) { put(f, "new"); });
  files.commit();
  EXPECT_EQ(read_file(at("target.txt")), "new");
  struct stat info;
  ASSERT_EQ(::lstat(at("link.txt").c_str(), &info), 0);
  EXPECT_TRUE(S_ISLNK(info.st_mode));
}

TEST_F(AtomicFile, AFolderOfThatNameIsRefused) {
  ASSERT_EQ(::mkdir(at("out.vtu").c_str(), 0777), 0);
  AtomicFiles files;
  const std::string text = output_error([&] { files.write(at("out.vtu"), [](std::FILE* f) { put(f, "x"); }); });
  EXPECT_NE(text.find("out.vtu"), std::string::npos);
  EXPECT_NE(text.find("name a file, not a folder"), std::string::npos);
  ::rmdir(at("out.vtu").c_str());
}

TEST_F(AtomicFile, ADeviceIsRefusedAndLeftAlone) {
  AtomicFiles files;
  output_error([&] { files.write("/dev/null", [](std::FILE* f) { put(f, "x"); }); });
  struct stat info;
  ASSERT_EQ(::stat("/dev/null", &info), 0);
  EXPECT_TRUE(S_ISCHR(info.st_mode));
}

TEST_F(AtomicFile, AMissingFolderIsAnOutputErrorWithTheNameAsGiven) {
  AtomicFiles files;
  const std::string text = output_error([&] { files.write(at("none/a.stl"), [](std::FILE* f) { put(f, "x"); }); });
  EXPECT_NE(text.find(at("none/a.stl") + ";"), std::string::npos) << text;
  EXPECT_NE(text.find("create the folder"), std::string::npos) << text;
}

/// Runs the body in a child process (it gives up rights or sets limits for good); 0 is success.
int in_child(const std::function<int()>& body) {
  const pid_t child = ::fork();
  if (child == 0) {
    int code = 90;
    try {
      code = body();
    } catch (...) {
    }
    ::_exit(code);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

TEST_F(AtomicFile, AFolderOrFileWithoutTheRightToWriteIsAnOutputError) {
  std::ofstream(at("locked.stl")) << "old";
  ASSERT_EQ(::chmod(at("locked.stl").c_str(), 0444), 0);
  ASSERT_EQ(::mkdir(at("locked").c_str(), 0555), 0);
  const auto refused = [](const std::string& path) {
    try {
      AtomicFiles files;
      files.write(path, [](std::FILE* f) { put(f, "x"); });
      files.commit();
    } catch (const Error& e) {
      return e.kind() == ErrorKind::output && std::strstr(e.what(), "Permission denied") != nullptr;
    }
    return false;
  };
  const int code = in_child([&] {
    if (::geteuid() == 0 && ::seteuid(65534) != 0) return 91;  // root may write anywhere
    return refused(at("locked/a.stl")) && refused(at("locked.stl")) ? 0 : 1;
  });
  ::rmdir(at("locked").c_str());
  if (code == 91) GTEST_SKIP() << "NOT TESTED: running as root, which cannot become another user here";
  EXPECT_EQ(code, 0);
  EXPECT_EQ(read_file(at("locked.stl")), "old");
}

/// Writes a mesh that is larger than the room; true when that is an output error, nothing new is in the
/// folder and a small file of before still commits.
bool reports_no_room(const std::string& folder, const char* ending, const char* reason) {
  const TetMesh mesh = sample_mesh(12);
  AtomicFiles files;
  files.write(folder + "/small.txt", [](std::FILE* f) { put(f, "small"); });
  try {
    write_volume(files, folder + "/large" + ending, mesh, {});
    std::fprintf(stderr, "%s: no error\n", ending);
    return false;
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::output || std::strstr(e.what(), reason) == nullptr) {
      std::fprintf(stderr, "%s: %s\n", ending, e.what());
      return false;
    }
  }
  files.commit();
  return listing(folder) == std::vector<std::string>{"small.txt"} && read_file(folder + "/small.txt") == "small";
}

TEST_F(AtomicFile, AFileSizeLimitIsNoticedAndNothingStays) {
  for (const char* ending : {".vtu", ".msh", ".inp", ".vtk", ".mesh"}) {
    EXPECT_EQ(in_child([&] {
                std::signal(SIGXFSZ, SIG_IGN);
                const rlimit limit = {65536, 65536};
                if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) return 91;
                return reports_no_room(folder_, ending, "File too large") ? 0 : 1;
              }),
              0)
        << ending;
    std::remove(at("small.txt").c_str());
  }
}

TEST_F(AtomicFile, AFullDiskIsNoticedAndNothingStays) {
  if (::mount("tmpfs", folder_.c_str(), "tmpfs", 0, "size=64k") != 0)
    GTEST_SKIP() << "NOT TESTED: a full disk needs the right to mount a small tmpfs (" << std::strerror(errno) << ")";
  for (const char* ending : {".vtu", ".msh", ".inp", ".vtk", ".mesh"}) {
    EXPECT_TRUE(reports_no_room(folder_, ending, "No space left on device")) << ending;
    std::remove(at("small.txt").c_str());
  }
  // What fails on the last flush only: a single buffer that stdio holds back until the file is closed.
  {
    std::ofstream filler(at("filler"), std::ios::binary);
    while (filler << std::string(4096, 'x') << std::flush) continue;
  }
  AtomicFiles files;
  const std::string text = output_error([&] { files.write(at("tiny.txt"), [](std::FILE* f) { put(f, "tiny"); }); });
  EXPECT_NE(text.find("free some space"), std::string::npos) << text;
  EXPECT_EQ(listing(folder_), std::vector<std::string>{"filler"});
  ::umount(folder_.c_str());
}

}  // namespace
}  // namespace stackmesh
