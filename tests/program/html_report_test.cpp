// --report R.html of the program: one file, small, private, and it works in a real browser.
#include "../image/image_files.h"
#include "program.h"

namespace program {
namespace {

constexpr std::size_t kMostBytes = 25 * 1000 * 1000;

class HtmlReport : public ProgramTest {
 protected:
  /// Opens a page in headless Chromium; skips where there is none.
  static void opens(const std::string& html, std::vector<std::string> more = {}) {
    more.insert(more.begin(), html);
    const Ended ended = python("report_in_browser.py", more);
    if (ended.code == 77) GTEST_SKIP() << ended.out;
    EXPECT_EQ(ended.code, 0) << ended.out << ended.err;
  }
};

TEST_F(HtmlReport, OpensOfflineInABrowserAndDoesWhatItShould) {
  succeeds(
      {"mesh", testdata("heart4.nii.gz"), "-o", out("a.vtu"), "--report", out("R.html"), "--report", out("R.json")});
  EXPECT_LT(read_file(out("R.html")).size(), kMostBytes);
  opens(out("R.html"));
}

TEST_F(HtmlReport, SaysThatThereIsNoWebGLAndStaysUsable) {
  succeeds({"surface", testdata("shells.nii.gz"), "-o", out("a.stl"), "--report", out("R.html")});
  opens(out("R.html"), {"--no-webgl"});
}

TEST_F(HtmlReport, ShowsContourInput) {
  succeeds({"surface", testdata("branch.cnt"), "-o", out("a.stl"), "--report", out("R.html")});
  opens(out("R.html"));
}

TEST_F(HtmlReport, IsNamedAfterAllFilesOfItsInput) {
  const std::string square = "S 2\nv 4 z 0\n{\n0 0\n9 0\n9 9\n0 9\n}\nv 4 z 5\n{\n0 0\n9 0\n9 9\n0 9\n}\n";
  std::string small = square;
  for (char& c : small)
    if (c == '9') c = '3';
  const std::string epi = "1=" + write("epi.cnt", square), endo = "2=" + write("endo.cnt", small);
  succeeds({"mesh", epi, endo, "-o", out("a.vtu"), "--report", out("R.html")});
  EXPECT_NE(read_file(out("R.html")).find("Mesh of epi.cnt and endo.cnt<"), std::string::npos);
  succeeds({"validate", out("a.vtu"), "--against", epi, endo, "--report", out("R.html")});
  EXPECT_NE(read_file(out("R.html")).find("a.vtu against epi.cnt and endo.cnt<"), std::string::npos);
}

TEST_F(HtmlReport, ShowsTheSolverModelOfLabelsAndOfAGivenMesh) {
  const std::string law =
      write("law.json", R"({"schema": "stackmesh-law-1", "units": {"length": "mm", "force": "N", "stress": "MPa"},
      "labels": {"*": {"E_MPa": 1234, "poisson": 0.3}}, "load_case": {"fixed": [{"set": "cap_low"}], "loaded": [{"set": "cap_high", "force_N": [0, 0, -321]}]}})");
  const std::vector<std::string> more = {"--parts", "A=1",      "B=2",         "C=3",      "--materials",
                                         law,       "--report", out("R.html"), "--report", out("R.json")};
  const auto run = [&](std::vector<std::string> args) {
    args.insert(args.end(), more.begin(), more.end());
    succeeds(args);
    const Json model = report().at("fem");
    const std::string html = read_file(out("R.html"));
    const std::size_t at = html.find("<section id=\"model\"");
    ASSERT_NE(at, std::string::npos);
    const std::string section = html.substr(at, html.find("</section>", at) - at);
    for (const auto& set : model.at("sets")) {
      const std::size_t row = section.find(">" + set.at("name").get<std::string>() + "</th>");
      ASSERT_NE(row, std::string::npos) << set;
      const std::string cells = section.substr(row, section.find("</tr>", row) - row);
      EXPECT_NE(cells.find("data-v=\"" + std::to_string(set.at("nodes").get<int>()) + "\""), std::string::npos)
          << cells;
      EXPECT_NE(cells.find("data-v=\"" + std::to_string(set.at("faces").get<int>()) + "\""), std::string::npos)
          << cells;
    }
    for (const char* text : {"A, B", "tied", "data-v=\"1234\"", "321) N"})
      EXPECT_NE(section.find(text), std::string::npos) << text;
  };
  run({"fem", testdata("border.nii.gz"), "--edge-length", "6", "-o", out("a.vtu")});
  // its parts have nodes of their own: they are joined, and split again
  run({"fem", out("a.vtu"), "-o", out("b.inp")});
  EXPECT_EQ(report().at("surface").at("self_intersections"), 0);
  EXPECT_EQ(report().at("fem").at("pairs").size(), 3u);
  opens(out("R.html"));
}

TEST_F(HtmlReport, ColoursTheSolverModelBySetLoadModulusAndStress) {
  if (std::system("command -v ccx >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "NOT TESTED: CalculiX (calculix-ccx) is not installed";
  const std::string law =
      write("law.json", R"({"schema": "stackmesh-law-1", "units": {"length": "mm", "force": "N", "stress": "MPa"},
      "labels": {"1": {"E_MPa": 1234, "poisson": 0.3}, "*": {"E_MPa": 100, "poisson": 0.3}},
      "load_case": {"fixed": [{"set": "cap_low"}], "loaded": [{"set": "cap_high", "force_N": [0, 0, -321]}]}})");
  const auto fem = [&](std::vector<std::string> input, std::vector<std::string> more) {
    input.insert(input.begin(), "fem");
    input.insert(input.end(), {"--materials", law, "-o", out("a.inp"), "--report", out("R.html"), "--quiet"});
    input.insert(input.end(), more.begin(), more.end());
    succeeds(input);
  };
  const std::vector<std::string> labels = {testdata("border.nii.gz"), "--edge-length", "8"};
  fem(labels, {});
  ASSERT_EQ(std::system(("cd '" + out("") + "' && OMP_NUM_THREADS=1 ccx -i a >ccx.log 2>&1").c_str()), 0);
  fem(labels, {"--result", out("a.frd")});
  const auto all_colours = [&] {
    const Ended browser = python("report_in_browser.py", {out("R.html")});
    if (browser.code == 77) return;  // NOT TESTED: no browser
    EXPECT_EQ(browser.code, 0) << browser.out << browser.err;
    for (const char* colour : {"set", "acts", "modulus", "mises"})
      EXPECT_NE(browser.out.find(std::string("ok     colours by ") + colour), std::string::npos) << browser.out;
  };
  all_colours();
  // Of a given mesh, too; and a result of another mesh is refused.
  succeeds({"mesh", labels[0], "--edge-length", "8", "--order", "2", "-o", in("m.vtu"), "--quiet"});
  fem({in("m.vtu")}, {});
  ASSERT_EQ(std::system(("cd '" + out("") + "' && OMP_NUM_THREADS=1 ccx -i a >ccx.log 2>&1").c_str()), 0);
  fem({in("m.vtu")}, {"--result", out("a.frd")});
  all_colours();
  const Ended other = stackmesh({"fem", labels[0], "--edge-length", "11", "--materials", law, "-o", out("b.inp"),
                                 "--report", out("R.html"), "--result", out("a.frd")});
  EXPECT_EQ(other.code, 3);
  EXPECT_NE(other.err.find("another mesh"), std::string::npos) << other.err;
}

TEST_F(HtmlReport, HoldsTheFiguresOfTheJson) {
  succeeds(
      {"mesh", testdata("heart4.nii.gz"), "-o", out("a.vtu"), "--report", out("R.html"), "--report", out("R.json")});
  const Json report = this->report();
  const std::string html = read_file(out("R.html"));
  for (const auto& label : report["labels"]) {
    char volume[40];
    std::snprintf(volume, sizeof volume, "data-v=\"%.9g\"", label["surface_volume_mm3"].get<double>());
    EXPECT_NE(html.find(volume), std::string::npos) << volume;
    std::snprintf(volume, sizeof volume, "data-v=\"%.9g\"", label["dice"].get<double>());
    EXPECT_NE(html.find(volume), std::string::npos) << volume;
  }
}

TEST_F(HtmlReport, HasNoPatientFields) {
  using namespace image_files;
  Nifti header;
  header.dim = {3, 6, 6, 6, 1, 1, 1, 1};
  std::string bytes = header.header() + pack<std::uint8_t>(std::vector<int>(216, 1));
  bytes.replace(148, 14, "DOE^JANE 1970");  // descrip
  bytes.replace(14, 8, "MRN12345");         // db_name
  bytes.replace(328, 8, "Dr. Hyde");        // intent_name
  bytes.replace(228, 8, "ward7.nii");       // aux_file
  succeeds(
      {"mesh", write("labels.nii", bytes), "-o", out("a.vtu"), "--report", out("R.html"), "--report", out("R.json")});
  for (const char* file : {"R.html", "R.json"})
    for (const char* part : {"DOE^JANE", "JANE", "MRN12345", "Dr. Hyde", "ward7"})
      EXPECT_EQ(read_file(out(file)).find(part), std::string::npos) << file << " tells " << part;
}

TEST_F(HtmlReport, IsWrittenWholeOrNotAtAll) {
  fails(5, {"mesh", testdata("heart4.nii.gz"), "-o", out("a.vtu"), "--report", out("absent/R.html")}, {"absent"});
  fails(2, {"mesh", testdata("heart4.nii.gz"), "-o", out("a.vtu"), "--report", out("R.pdf")}, {".json or .html"});
}

TEST_F(HtmlReport, SameBytesButForTimesOnOneThreadAndTwo) {
  const auto without_times = [&](const std::string& threads) {
    succeeds({"mesh", testdata("shells.nii.gz"), "-o", out("a.vtu"), "--threads", threads, "--report", out("R.html")});
    std::string html = read_file(out("R.html"));
    const std::size_t at = html.find("id=\"provenance\""), end = html.find("</section>", at);
    return html.erase(at, end - at);
  };
  EXPECT_TRUE(without_times("1") == without_times("2"));
}

TEST_F(HtmlReport, OfRealDataStaysSmall) {
  const std::string skull = shared_data("skull_ct_invesalius/bone_mask.nii.gz");
  if (skull.empty()) GTEST_SKIP() << "no ../shared/data/skull_ct_invesalius";
  succeeds({"surface", skull, "--no-enhance", "--interpolate", "0", "-o", out("a.vtp"), "--report", out("R.html")});
  EXPECT_LT(read_file(out("R.html")).size(), kMostBytes);
}

}  // namespace
}  // namespace program
