// The same cohort by Slurm, by Snakemake and as a BIDS App: the same bytes as here. Each is skipped, aloud, where the
// engine is absent.
#include <stdlib.h>

#include <filesystem>
#include <thread>

#include "small_cohort.h"

namespace cohort_test {
namespace {

namespace fs = std::filesystem;
using program::read_file;

class Engines : public CohortTest {
 protected:
  /// The cohort made here, and the one at `other`, hold the same.
  void expect_same(const std::string& other) const {
    for (const char* id : {"a", "b", "c"}) {
      ASSERT_TRUE(fs::exists(other + "/" + id + "/done")) << id;
      EXPECT_EQ(read_file(other + "/" + id + "/mesh.vtu"), read_file(in_cohort(std::string(id) + "/mesh.vtu"))) << id;
    }
    EXPECT_EQ(Json::parse(read_file(other + "/bad.failed/failed.json"))["reason"],
              json("bad.failed/failed.json")["reason"]);
    EXPECT_FALSE(fs::exists(other + "/bad"));
  }
};

/// A Slurm of one node on this machine.
class Slurm : public Engines {
 protected:
  void SetUp() override {
    Engines::SetUp();
    const Ended started = slurm("start");
    if (started.code == 77) GTEST_SKIP() << started.out;
    ASSERT_EQ(started.code, 0) << started.out << started.err;
    ::setenv("SLURM_CONF", (folder_ + "/slurm/slurm.conf").c_str(), 1);
  }
  void TearDown() override {
    slurm("stop");
    ::unsetenv("SLURM_CONF");
    Engines::TearDown();
  }
  Ended slurm(const std::string& what) const {
    return program::run({"/bin/bash", STACKMESH_SOURCE_DIR "/tests/support/small_slurm.sh", what, folder_ + "/slurm"});
  }
};

TEST_F(Slurm, ArrayJobsMakeTheSameBytes) {
  four_cases();
  const std::vector<std::string> options = {"--", "--smooth", "4", "--threads", "1"};
  ASSERT_EQ(batch({"--no-page", "--", "--smooth", "4"}).code, 4);
  const std::string other = out("by_slurm");
  const auto submit = [&](const std::string& of_sbatch) {
    std::vector<std::string> call = {"batch",   in("cases.csv"),    "-o", other, "--slurm",
                                     of_sbatch, "--cases-per-task", "2"};
    call.insert(call.end(), options.begin(), options.end());
    return program::stackmesh(call);
  };
  const Ended refused = submit("--partition=nowhere");
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("stackmesh: error: sbatch refuses: "), std::string::npos) << refused.err;
  EXPECT_EQ(program::lines_of(refused.err).size(), 1u) << refused.err;
  const Ended submitted = submit("--partition=debug --comment='two words'");
  ASSERT_EQ(submitted.code, 0) << submitted.err;
  EXPECT_NE(submitted.out.find("4 cases submitted"), std::string::npos) << submitted.out;
  const Ended again = submit("");  // what waits or runs is not submitted twice
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_NE(again.out.find("0 cases submitted"), std::string::npos) << again.out;
  std::string status;
  for (int i = 0; i < 600; ++i) {
    status = program::stackmesh({"batch", "--status", "-o", other}).out;
    if (status.find("3 done, 1 failed, 0 running, 0 waiting, 0 open") != std::string::npos) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
  EXPECT_NE(status.find("4 cases: 3 done, 1 failed"), std::string::npos) << status;
  EXPECT_NE(status.find("failed  bad: "), std::string::npos) << status;
  expect_same(other);
  EXPECT_EQ(program::stackmesh({"collect", other}).code, 4);
  EXPECT_NE(submit("").out.find("0 cases submitted"), std::string::npos) << "finished cases are submitted again";
}

TEST_F(Engines, SnakemakeMakesTheSameBytes) {
  if (!fs::exists("/usr/bin/snakemake")) GTEST_SKIP() << "there is no snakemake; install it";
  four_cases();
  ASSERT_EQ(batch({"--no-page", "--", "--smooth", "4"}).code, 4);
  const std::string other = out("by_snakemake");
  const std::vector<std::string> call = {"/usr/bin/snakemake",
                                         "-s",
                                         STACKMESH_SOURCE_DIR "/apps/snakemake/Snakefile",
                                         "--directory",
                                         folder_,
                                         "--cores",
                                         "2",
                                         "--keep-going",
                                         "--quiet",
                                         "--config",
                                         "manifest=" + in("cases.csv"),
                                         "out=" + other,
                                         "program=" STACKMESH_PROGRAM,
                                         "options=mesh --smooth 4"};
  const Ended first = program::run(call);
  EXPECT_NE(first.code, 0) << "one case fails";
  expect_same(other);
  EXPECT_TRUE(fs::exists(other + "/cohort.html")) << first.err;
  write("bad.nrrd", box_volume(8, 6));
  const Ended second = program::run(call);
  EXPECT_EQ(second.code, 0) << second.out << second.err;
  EXPECT_TRUE(fs::exists(other + "/bad/done"));
  EXPECT_EQ(Json::parse(read_file(other + "/cohort.json"))["counts"]["done"], 4);
}

TEST_F(Engines, TheBidsAppMeshesParticipantsAndCollectsTheGroup) {
  for (const char* who : {"01", "02", "011"})
    write(std::string("sub-") + who + "/anat/sub-" + who + "_dseg.nrrd", box_volume(9, 6));
  const auto app = [&](std::vector<std::string> words) {
    words.insert(words.begin(),
                 {"/usr/bin/python3", STACKMESH_SOURCE_DIR "/apps/stackmesh-bids", folder_ + "/in", cohort()});
    ::setenv("STACKMESH", STACKMESH_PROGRAM, 1);
    return program::run(words);
  };
  const Ended one = app({"participant", "--participant_label", "01", "--n_cpus", "1", "--", "--smooth", "4"});
  EXPECT_EQ(one.code, 0) << one.err;
  EXPECT_EQ(names(), (std::vector<std::string>{"dataset_description.json", "sub-01"}));
  EXPECT_EQ(json("dataset_description.json")["DatasetType"], "derivative");
  EXPECT_EQ(app({"group"}).code, 4) << "two participants are open";
  EXPECT_EQ(app({"participant", "--", "--smooth", "4"}).code, 0);
  EXPECT_EQ(times("started", "sub-01"), 1);
  EXPECT_EQ(app({"group"}).code, 0);
  EXPECT_EQ(json("cohort.json")["counts"]["done"], 3);
  EXPECT_EQ(app({"participant", "--participant_label", "7"}).code, 1);
}

}  // namespace
}  // namespace cohort_test
