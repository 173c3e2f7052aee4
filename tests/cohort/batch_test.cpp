// stackmesh batch as a user runs it: what appears, what is skipped, what runs again.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>

#include "small_cohort.h"

namespace cohort_test {
namespace {

namespace fs = std::filesystem;
using program::read_file;

TEST_F(CohortTest, EveryGoodCaseIsDoneAndTheBadOneIsNamed) {
  four_cases();
  const Ended run = batch();
  EXPECT_EQ(run.code, 4) << run.err;
  EXPECT_EQ(names(), (std::vector<std::string>{"a", "b", "bad.failed", "c", "cohort.csv", "cohort.html", "cohort.json",
                                               "cohort_thumbnails"}));
  for (const char* id : {"a", "b", "c"}) {
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(in_cohort(id))) files.push_back(entry.path().filename().string());
    std::sort(files.begin(), files.end());
    EXPECT_EQ(files, (std::vector<std::string>{"done", "log.txt", "mesh.vtu", "report.html", "report.json"})) << id;
    EXPECT_EQ(json(std::string(id) + "/report.json")["volume"]["closure"], "verified");
    EXPECT_EQ(json(std::string(id) + "/done")["key"].get<std::string>().size(), 64u);
    EXPECT_EQ(read_file(in_cohort(std::string(id) + "/log.txt")).find(".work-"), std::string::npos);
  }
  const Json failed = json("bad.failed/failed.json");
  EXPECT_EQ(failed["exit_code"], 3);
  EXPECT_NE(failed["reason"].get<std::string>().find("bad.nrrd"), std::string::npos);
  EXPECT_NE(run.out.find("4 cases: 3 done, 1 failed"), std::string::npos) << run.out;
  const Json page = json("cohort.json");
  EXPECT_EQ(page["counts"]["done"], 3);
  EXPECT_EQ(page["cases"][0]["id"], "bad") << "failures come first";
}

TEST_F(CohortTest, TheMeshIsThatOfThePlainCommand) {
  four_cases();
  write("cases.csv", "id,input,edge-length,merge\nb,b.nrrd,1.5,yes\n");
  ASSERT_EQ(batch({"--no-page", "--format", "vtu,stl", "--", "--smooth", "3"}).code, 0);
  succeeds({"mesh", in("b.nrrd"), "--edge-length", "1.5", "--merge", "--smooth", "3", "-o", out("b.vtu"), "-o",
            out("b.stl")});
  EXPECT_GT(read_file(out("b.vtu")).size(), 1000u);
  EXPECT_EQ(read_file(in_cohort("b/mesh.vtu")), read_file(out("b.vtu")));
  EXPECT_EQ(read_file(in_cohort("b/mesh.stl")), read_file(out("b.stl")));
}

TEST_F(CohortTest, ASecondRunDoesNothingAgain) {
  four_cases();
  batch({"--no-page"});
  const auto time = fs::last_write_time(in_cohort("a/mesh.vtu"));
  const Ended again = batch({"--no-page", "--", "--threads", "1"});  // threads change no bytes
  EXPECT_EQ(again.code, 4);
  EXPECT_NE(again.out.find("3 done (3 of them before), 1 failed (1 of them before"), std::string::npos) << again.out;
  EXPECT_EQ(fs::last_write_time(in_cohort("a/mesh.vtu")), time);
  for (const char* id : {"a", "b", "bad", "c"}) EXPECT_EQ(times("started", id), 1) << id;
}

TEST_F(CohortTest, AChangedInputOrOptionRunsAgainAlone) {
  four_cases();
  batch({"--no-page"});
  const Json before = json("a/done");
  write("a.nrrd", box_volume(9, 8));
  batch({"--no-page"});
  EXPECT_EQ(times("started", "a"), 2);
  EXPECT_EQ(times("started", "b"), 1);
  EXPECT_NE(json("a/done")["key"], before["key"]);
  write("cases.csv", "id,input,smooth\na,a.nrrd,\nb,b.nrrd,7\nbad,bad.nrrd,\nc,c.nrrd,\n");
  batch({"--no-page"});
  EXPECT_EQ(times("started", "a"), 2);
  EXPECT_EQ(times("started", "b"), 2);
  EXPECT_EQ(times("started", "c"), 1);
}

TEST_F(CohortTest, AFailedCaseRunsAgainOnDemandOrWhenItIsMended) {
  four_cases();
  batch({"--no-page"});
  const Ended again = batch({"--no-page", "--only", "failed"});
  EXPECT_NE(again.out.find("1 case: 0 done, 1 failed"), std::string::npos) << again.out;
  EXPECT_EQ(times("started", "bad"), 2);
  EXPECT_EQ(times("started", "a"), 1);
  write("bad.nrrd", box_volume(8, 6));
  EXPECT_EQ(batch({"--no-page"}).code, 0);
  EXPECT_TRUE(fs::exists(in_cohort("bad/done")));
  EXPECT_FALSE(fs::exists(in_cohort("bad.failed")));
}

TEST_F(CohortTest, AResultWhoseCaseNowFailsIsKeptAside) {
  write("a.nrrd", box_volume(9, 6));
  write("cases.csv", "id,input\na,a.nrrd\n");
  ASSERT_EQ(batch({"--no-page"}).code, 0);
  const std::string mesh = read_file(in_cohort("a/mesh.vtu"));
  EXPECT_EQ(batch({"--no-page", "--", "--label", "5"}).code, 4);
  EXPECT_FALSE(fs::exists(in_cohort("a")));
  EXPECT_EQ(read_file(in_cohort("a.failed/previous/mesh.vtu")), mesh);
  EXPECT_EQ(batch({"--no-page"}).code, 0);
  EXPECT_FALSE(fs::exists(in_cohort("a.failed")));
}

TEST_F(CohortTest, OneCaseByItsIdAndTheDryRunWritesNothing) {
  four_cases();
  const Ended dry = batch({"--dry-run", "--json"});
  EXPECT_EQ(dry.code, 0) << dry.err;
  EXPECT_FALSE(fs::exists(cohort()));
  const Json plan = Json::parse(dry.out);
  ASSERT_EQ(plan["cases"].size(), 4u);
  for (const Json& c : plan["cases"]) {
    EXPECT_EQ(c["action"], "run");
    EXPECT_EQ(c["fault"].get<std::string>().empty(), c["id"] != "bad");
    EXPECT_GT(c["memory_mb"], 10);
    EXPECT_GT(c["time_s"], 0);
  }
  EXPECT_EQ(plan["cases"][0]["voxels"], 9 * 9 * 6);
  EXPECT_EQ(plan["cases"][1]["labels"], 2);
  EXPECT_EQ(batch({"--only", "c", "--no-page"}).code, 0);
  EXPECT_EQ(names(), std::vector<std::string>{"c"});
}

TEST_F(CohortTest, ACaseThatTakesTooLongIsEndedAndTriedAgain) {
  write("a.nrrd", box_volume(60, 60));
  write("cases.csv", "id,input,edge-length\nslow,a.nrrd,0.4\n");
  const Ended run = batch({"--no-page", "--timeout", "0.6", "--retry", "1"});
  EXPECT_EQ(run.code, 4);
  const Json failed = json("slow.failed/failed.json");
  EXPECT_EQ(failed["tries"], 2);
  EXPECT_NE(failed["reason"].get<std::string>().find("took longer than the 0.6 s of --timeout"), std::string::npos)
      << failed["reason"];
  EXPECT_LT(failed["wall_s"], 30.0);
}

TEST_F(CohortTest, ACaseHasItsOwnBoundOfMemory) {
  write("a.nrrd", box_volume(9, 6));
  write("large.nrrd", box_volume(320, 320));
  write("cases.csv", "id,input\nlarge,large.nrrd\na,a.nrrd\n");
  EXPECT_EQ(batch({"--no-page", "--case-memory", "100MB"}).code, 4);
  EXPECT_NE(json("large.failed/failed.json")["reason"].get<std::string>().find("memory"), std::string::npos);
  EXPECT_TRUE(fs::exists(in_cohort("a/done")));
}

TEST_F(CohortTest, NeverMoreAtOnceThanFitIntoMemory) {
  four_cases();
  /// Of the journal: the largest number of cases that had started and not ended.
  const auto most_at_once = [&] {
    int now = 0, most = 0;
    for (const std::string& line : program::lines_of(read_file(in_cohort(".cohort/journal.tsv")))) {
      now += line.find("\tstarted\t") != std::string::npos ? 1 : -1;
      most = std::max(most, now);
    }
    EXPECT_EQ(now, 0);
    return most;
  };
  batch({"--no-page", "--jobs", "3", "--max-memory", "90MB"});  // each is foretold to take 46 MB
  EXPECT_EQ(most_at_once(), 1);
  EXPECT_TRUE(fs::exists(in_cohort("a/done")));
  fs::remove_all(cohort());
  batch({"--no-page", "--jobs", "3", "--max-memory", "4GB"});
  EXPECT_GE(most_at_once(), 2);
  EXPECT_LE(most_at_once(), 3);
}

TEST_F(CohortTest, TwoRunsDoNotWorkInOneFolder) {
  write("slow.nrrd", box_volume(30, 30));
  write("cases.csv", "id,input,edge-length\nslow,slow.nrrd,0.5\n");
  program::Around around;
  Ended second;
  around.while_running = [&](int) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (second.code == -1 && fs::exists(in_cohort(".cohort/journal.tsv"))) second = batch({"--no-page"});
  };
  const Ended first = program::stackmesh({"batch", in("cases.csv"), "-o", cohort(), "--no-page"}, around);
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(second.code, 2) << second.out;
  EXPECT_NE(second.err.find("another run works in this folder, process "), std::string::npos) << second.err;
  EXPECT_EQ(times("started", "slow"), 1);
}

/// Starts a batch, and sends it a signal once a case is at work.
Ended interrupted(const std::vector<std::string>& arguments, const std::string& cohort, int signal) {
  program::Around around;
  around.while_running = [&, sent = false](int pid) mutable {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    std::error_code none;
    bool at_work = false, some_done = false;
    for (fs::directory_iterator it(cohort, none), end; !none && it != end; it.increment(none)) {
      at_work = at_work || it->path().filename().string().find(".work-") != std::string::npos;
      some_done = some_done || fs::exists(it->path() / "done", none);
    }
    if (at_work && some_done && !sent) {
      ::kill(pid, signal);
      sent = true;
    }
  };
  return program::stackmesh(arguments, around);
}

/// Processes whose command line names the text.
int processes_with(const std::string& text) {
  int n = 0;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator("/proc", none)) {
    const std::string line = read_file(entry.path().string() + "/cmdline");
    n += line.find(text) != std::string::npos && line.find("stackmesh") != std::string::npos;
  }
  return n;
}

TEST_F(CohortTest, AStoppedRunGoesOnAndLosesNothing) {
  write("a.nrrd", box_volume(9, 6));
  write("slow.nrrd", box_volume(50, 50));
  write("cases.csv", "id,input,edge-length\na,a.nrrd,\nslow,slow.nrrd,0.8\nb,a.nrrd,2\n");
  const std::vector<std::string> call = {"batch", in("cases.csv"), "-o", cohort(), "--no-page", "--jobs", "1"};
  for (const int signal : {SIGINT, SIGKILL}) {
    const Ended run = interrupted(call, cohort(), signal);
    EXPECT_EQ(run.code, -signal) << run.out << run.err;
    for (int i = 0; i < 100 && processes_with(cohort()) > 0; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_EQ(processes_with(cohort()), 0) << "orphans after signal " << signal;
    EXPECT_TRUE(fs::exists(in_cohort("a/done")));
    EXPECT_FALSE(fs::exists(in_cohort("slow")));
    if (signal == SIGINT) {
      EXPECT_EQ(names(), std::vector<std::string>{"a"}) << "a stopped run leaves no hidden folder";
    }
  }
  write("cases.csv", "id,input,edge-length\na,a.nrrd,\nslow,slow.nrrd,\nb,a.nrrd,2\n");  // now it is quick
  EXPECT_EQ(batch({"--no-page"}).code, 0);
  EXPECT_EQ(names(), (std::vector<std::string>{"a", "b", "slow"}));
  EXPECT_EQ(times("started", "a"), 1);
}

TEST_F(CohortTest, AWholeFolderThatLacksItsLastRenameIsAdopted) {
  write("a.nrrd", box_volume(9, 6));
  write("cases.csv", "id,input\na,a.nrrd\n");
  ASSERT_EQ(batch({"--no-page"}).code, 0);
  fs::rename(in_cohort("a"), in_cohort(".a.work-host-1"));
  fs::create_directories(in_cohort(".b.work-host-2"));  // of another that was not whole
  EXPECT_EQ(batch({"--no-page"}).code, 0);
  EXPECT_EQ(names(), std::vector<std::string>{"a"});
  EXPECT_EQ(times("started", "a"), 1);
  EXPECT_EQ(times("adopted", "a"), 1);
}

TEST_F(CohortTest, BidsTreesAndGlobsMakeIds) {
  write("sub-01/anat/sub-01_dseg.nrrd", box_volume(9, 6));
  write("sub-02/ses-1/anat/sub-02_ses-1_dseg.nrrd", box_volume(9, 6));
  write("sub-02/ses-1/anat/sub-02_ses-1_T1w.nrrd", box_volume(9, 6));
  const auto ids = [&](const std::vector<std::string>& arguments) {
    std::vector<std::string> found;
    const Ended run = succeeds(arguments);
    const Json plan = Json::parse(run.out, nullptr, false);
    if (!plan.is_discarded())
      for (const Json& c : plan["cases"]) found.push_back(c["id"]);
    return found;
  };
  EXPECT_EQ(ids({"batch", folder_ + "/in", "-o", cohort(), "--dry-run", "--json"}),
            (std::vector<std::string>{"sub-01", "sub-02_ses-1"}));
  EXPECT_EQ(ids({"batch", "--inputs", in("sub-*/anat/*.nrrd"), "-o", cohort(), "--dry-run", "--json"}),
            std::vector<std::string>{"sub-01"});
  EXPECT_EQ(ids({"batch", folder_ + "/in", "--inputs", "sub-02/*/anat/*.nrrd", "-o", cohort(), "--dry-run", "--json"}),
            (std::vector<std::string>{"sub-02_ses-1_T1w", "sub-02_ses-1"}));
}

}  // namespace
}  // namespace cohort_test
