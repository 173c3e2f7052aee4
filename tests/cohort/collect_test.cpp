// stackmesh collect on cohorts whose records and reports are written by the test: order, exit codes, sizes.
#include "cohort/collect.h"

#include <filesystem>
#include <fstream>
#include <random>

#include "cohort/table.h"
#include "small_cohort.h"

namespace cohort_test {
namespace {

namespace fs = std::filesystem;
using namespace stackmesh;
using program::read_file;

/// Writes a cohort as if batch had made it, without meshes.
class MadeUpCohort : public CohortTest {
 protected:
  void begin() {
    fs::create_directories(in_cohort(".cohort"));
    plan_.version = "9";
    plan_.command = "mesh";
    plan_.source = "/cases.csv";
    plan_.formats = {"vtu"};
  }
  void put(const std::string& path, const std::string& text) const {
    fs::create_directories(fs::path(path).parent_path());
    std::ofstream(path, std::ios::binary) << text;
  }
  CaseRecord record(const std::string& id, bool done) const {
    CaseRecord r;
    r.id = id;
    r.key = std::string(64, 'a');
    r.is_done = done;
    r.exit_code = done ? 0 : 3;
    r.reason = done ? "" : "the input <b>is</b> broken";
    r.version = "9";
    r.command = "mesh";
    r.inputs = {id + ".nii.gz"};
    r.wall_s = 10;
    r.peak_mb = 100;
    return r;
  }
  /// A case of two labels of that volume.
  void done(const std::string& id, double volume, const std::string& status = "pass") {
    plan_.cases.push_back({id, {id + ".nii.gz"}, {}});
    const auto label = [&](int n, double v) {
      return Json{{"label", n},
                  {"name", n == 1 ? "bone" : ""},
                  {"colour", nullptr},
                  {"tet_volume_mm3", v},
                  {"input_volume_mm3", v},
                  {"dice", 0.99},
                  {"components", 1},
                  {"angle_min_deg", 25.0},
                  {"wrong_centres_share", 0.0},
                  {"band_distance_mm", nullptr}};
    };
    const Json report = {
        {"verdicts", {{{"title", "Quality"}, {"figure", "a dihedral angle of 3 degrees"}, {"status", status}}}},
        {"volume", {{"tets", 10000}, {"dihedral_min_deg", 15.0}, {"scaled_jacobian_min", 0.2}}},
        {"labels", {label(1, volume), label(2, 500)}}};
    put(in_cohort(id + "/done"), to_json(record(id, true)));
    put(in_cohort(id + "/report.json"), report.dump());
  }
  void failed(const std::string& id) {
    plan_.cases.push_back({id, {id + ".nii.gz"}, {}});
    put(in_cohort(id + ".failed/failed.json"), to_json(record(id, false)));
  }
  void missing(const std::string& id) { plan_.cases.push_back({id, {id + ".nii.gz"}, {}}); }
  Ended collect_it() {
    put(in_cohort(".cohort/plan.json"), to_json(plan_));
    return program::stackmesh({"collect", cohort()});
  }
  CohortPlan plan_;
};

TEST_F(MadeUpCohort, FailuresThenLimitsThenOutliersComeFirst) {
  begin();
  for (int i = 0; i < 10; ++i) done("good-" + std::to_string(i), 1000 + 10 * i);
  done("outlier", 3000);
  done("further", 9000);
  done("beyond", 1040, "fail");
  failed("broken");
  missing("open");
  const Ended run = collect_it();
  EXPECT_EQ(run.code, 4) << run.err;
  EXPECT_NE(run.err.find("2 of 15 cases have no result"), std::string::npos) << run.err;
  std::vector<std::string> ids;
  const Json page = json("cohort.json");
  for (const Json& c : page["cases"]) ids.push_back(c["id"]);
  EXPECT_EQ(std::vector<std::string>(ids.begin(), ids.begin() + 6),
            (std::vector<std::string>{"broken", "open", "beyond", "further", "outlier", "good-0"}));
  EXPECT_EQ(page["counts"]["outliers"], 2);
  EXPECT_EQ(page["counts"]["outside_limits"], 1);
  EXPECT_NE(page["cases"][3]["remarkable"][0].get<std::string>().find("label 1 (bone): volume 9000 mm3, median 1"),
            std::string::npos)
      << page["cases"][3]["remarkable"];
  const std::string html = read_file(in_cohort("cohort.html"));
  EXPECT_NE(html.find("the input &lt;b&gt;is&lt;/b&gt; broken"), std::string::npos) << "reasons are escaped";
  EXPECT_LT(html.find("further/report.html"), html.find("good-0/report.html"));
}

TEST_F(MadeUpCohort, ExitCodesFollowTheWorstCase) {
  begin();
  done("a", 1000);
  EXPECT_EQ(collect_it().code, 0);
  done("b", 1000, "fail");
  const Ended outside = collect_it();
  EXPECT_EQ(outside.code, 6);
  EXPECT_NE(outside.err.find("1 of 2 cases are outside their limits"), std::string::npos) << outside.err;
  failed("c");
  EXPECT_EQ(collect_it().code, 4);
}

TEST_F(MadeUpCohort, WhatOtherOptionsMadeIsNoResult) {
  begin();
  done("a", 1000);
  plan_.cases[0].options = {{"edge-length", {"2"}}};
  EXPECT_EQ(collect_it().code, 4);
  EXPECT_EQ(json("cohort.json")["cases"][0]["state"], "changed");
  plan_.cases[0].options.clear();
  put(in_cohort("a/report.json"), "{ broken");
  EXPECT_EQ(collect_it().code, 4);
  EXPECT_NE(json("cohort.json")["cases"][0]["reason"].get<std::string>().find("report cannot be read"),
            std::string::npos);
}

TEST_F(MadeUpCohort, TheTableHasALineForEachLabel) {
  begin();
  done("a", 1234.5);
  failed("b, \"c\"");
  collect_it();
  const Table t = read_table(in_cohort("cohort.csv"));
  ASSERT_EQ(t.rows.size(), 3u);
  const auto cell = [&](std::size_t row, const std::string& column) {
    for (std::size_t i = 0; i < t.columns.size(); ++i)
      if (t.columns[i] == column) return t.rows[row].cells[i];
    return "no column " + column;
  };
  EXPECT_EQ(cell(0, "id"), "b, \"c\"");
  EXPECT_EQ(cell(0, "state"), "failed");
  EXPECT_EQ(cell(0, "volume_mm3"), "");
  EXPECT_EQ(cell(1, "label") + cell(2, "label"), "12");
  EXPECT_EQ(cell(1, "volume_mm3"), "1234.5");
  EXPECT_EQ(cell(2, "volume_mm3"), "500");
  EXPECT_EQ(cell(1, "tets"), "10000");
}

TEST_F(MadeUpCohort, AThousandCasesMakeASmallPageWithThePlantedOutlierFirst) {
  begin();
  std::mt19937 random(1);
  std::normal_distribution<double> spread(0, 0.1);
  for (int i = 0; i < 1000; ++i) done("sub-" + std::to_string(i), (i == 500 ? 7000 : 1000) * std::exp(spread(random)));
  EXPECT_EQ(collect_it().code, 0);
  EXPECT_LT(fs::file_size(in_cohort("cohort.html")), 25u * 1000 * 1000);
  EXPECT_EQ(json("cohort.json")["cases"].size(), 1000u);
  const Ended browser = program::python(
      "cohort_in_browser.py", {in_cohort("cohort.html"), "--cases", "1000", "--first", "sub-500", "--no-pictures"});
  if (browser.code == 77) GTEST_SKIP() << browser.out;
  EXPECT_EQ(browser.code, 0) << browser.out << browser.err;
  for (const std::string& line : program::lines_of(browser.out))
    if (line.find("after ") != std::string::npos) std::printf("%s\n", line.c_str());  // seconds and MB
}

}  // namespace
}  // namespace cohort_test
