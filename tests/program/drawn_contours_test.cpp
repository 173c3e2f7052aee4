// Drawn contours with no option: the volume and the place of what was drawn.
#include <algorithm>
#include <sstream>

#include "program.h"

namespace program {
namespace {

class DrawnContours : public ProgramTest {
 protected:
  struct Box {
    double low[3] = {1e300, 1e300, 1e300}, high[3] = {-1e300, -1e300, -1e300};
  };
  /// Surface of an input; its report.
  Json surface(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "surface");
    arguments.insert(arguments.end(), {"-o", out("a.off"), "--per-label", "--report", out("R.json")});
    succeeds(arguments);
    return report();
  }
  Box box(int label) const {
    std::istringstream text(read_file(out("a_" + std::to_string(label) + ".off")));
    std::string line;
    std::vector<std::string> lines;
    while (std::getline(text, line))
      if (!line.empty() && line[0] != '#' && line.compare(0, 3, "OFF") != 0) lines.push_back(line);
    std::size_t points = 0;
    std::istringstream(lines.at(0)) >> points;
    Box b;
    for (std::size_t i = 1; i <= points; ++i) {
      std::istringstream at(lines.at(i));
      for (int k = 0; k < 3; ++k) {
        double x = 0;
        at >> x;
        b.low[k] = std::min(b.low[k], x);
        b.high[k] = std::max(b.high[k], x);
      }
    }
    return b;
  }
  static void has(const Json& report, int label, double volume_mm3, int pieces = 1) {
    EXPECT_NEAR(row(report, label).at("surface_volume_mm3").get<double>(), volume_mm3, 0.005 * volume_mm3) << label;
    EXPECT_EQ(row(report, label).at("components"), pieces) << label;
  }
};

constexpr double kPlace = 0.05;

TEST_F(DrawnContours, WrittenAsAContourFileTheyLieWhereTheyWereDrawn) {
  succeeds({"contours", testdata("drawn/rt_box100.dcm"), "-o", out("box.cnt")});
  surface({out("box.cnt")});
  const Box b = box(1);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(b.low[k], -50, kPlace);
    EXPECT_NEAR(b.high[k], 50, kPlace);
  }
}

TEST_F(DrawnContours, BoxesOfFourPointsStayBoxes) {
  has(surface({testdata("drawn/rt_box100.dcm")}), 1, 100 * 100 * 24);
  Box b = box(1);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(b.low[k], -50, kPlace);
    EXPECT_NEAR(b.high[k], 50, kPlace);
  }
  EXPECT_NEAR(b.low[2], -1.5, kPlace);
  EXPECT_NEAR(b.high[2], 22.5, kPlace);
  has(surface({testdata("drawn/box20.cnt")}), 1, 20 * 20 * 21);
  b = box(1);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(b.low[k], -10, kPlace);
    EXPECT_NEAR(b.high[k], 10, kPlace);
  }
  EXPECT_NEAR(b.low[2], 0, kPlace);
  EXPECT_NEAR(b.high[2], 21, kPlace);
}

TEST_F(DrawnContours, AContourDrawnTwiceCountsOnce) {
  const Json r = surface({testdata("drawn/rt_dup.dcm")});
  has(r, 1, 30096);
  ASSERT_EQ(r.at("warnings").size(), 1u);
  EXPECT_NE(r.at("warnings")[0].get<std::string>().find("'A' repeats 1 of its contours, or nearly so, at z = 9 mm"),
            std::string::npos);
}

TEST_F(DrawnContours, EndsDoNotDependOnTheOtherStructures) {
  has(surface({testdata("drawn/rt_inner_end.dcm")}), 1, 30075);
  EXPECT_NEAR(box(1).high[2], 22.5, kPlace);
  EXPECT_NEAR(box(1).low[2], -1.5, kPlace);
  has(surface({testdata("drawn/rt_gap.dcm")}), 1, 56313);
  EXPECT_NEAR(box(1).low[2], -2.5, kPlace);
  EXPECT_NEAR(box(1).high[2], 42.5, kPlace);
  has(surface({testdata("drawn/rt_jitter3.dcm")}), 1, 18850);
}

TEST_F(DrawnContours, AHeartsCavityStaysInsideItsWall) {
  const std::string epi = shared_data("heart_sax_sunnybrook/SC-HF-I-2/epi_ED.cnt"),
                    endo = shared_data("heart_sax_sunnybrook/SC-HF-I-2/endo_ED.cnt");
  if (epi.empty()) GTEST_SKIP() << "NOT TESTED: needs ../shared/data/heart_sax_sunnybrook";
  for (const char* per_gap : {"auto", "0"}) {
    const Json r = surface({"1=" + epi, "2=" + endo, "--interpolate", per_gap});
    for (int label : {1, 2}) {
      EXPECT_EQ(row(r, label).at("genus"), 0) << label;
      EXPECT_EQ(row(r, label).at("components"), 1) << label;
      EXPECT_EQ(row(r, label).at("caps"), (Json{{"low", "round"}, {"high", "flat"}})) << label;
    }
    EXPECT_LT(box(1).low[2] + 0.7, box(2).low[2]) << "the apex is closed";
  }
}

TEST_F(DrawnContours, AWallThatItsContoursOpenIsNamed) {
  const std::string epi = shared_data("heart_sax_sunnybrook/SC-HF-I-1/epi_ED.cnt"),
                    endo = shared_data("heart_sax_sunnybrook/SC-HF-I-1/endo_ED.cnt");
  if (epi.empty()) GTEST_SKIP() << "NOT TESTED: needs ../shared/data/heart_sax_sunnybrook";
  const Ended r =
      succeeds({"surface", "1=" + epi, "2=" + endo, "--raw", "-o", out("a.off"), "--report", out("R.json")});
  EXPECT_TRUE(r.warns_of("label 2 lies inside label 1, but reaches its outline at z = -58.9")) << r.err;
  EXPECT_TRUE(
      r.warns_of("over about 167 mm2: 141 mm2 at (163.6, 198.1, -58.9035), 26.2 mm2 at (171.9, 211.9, -58.9035)"))
      << "one by one: " << r.err;
  // Slivers of wall between contours that run on each other hang on nothing, and are named one by one.
  std::size_t loose = 0;
  const Json with_defects = report();
  for (const Json& d : with_defects.at("defects")) loose += d.at("kind") == "loose_piece";
  EXPECT_EQ(static_cast<int>(loose), row(with_defects, 1).at("components").get<int>() - 1);
  EXPECT_GT(loose, 0u);
  EXPECT_TRUE(r.warns_of("label 1 has a piece of its own of ")) << r.err;
  EXPECT_EQ(row(report(), 1).at("genus"), 0);
}

TEST_F(DrawnContours, EitherEndIsClosedAsAsked) {
  const std::string file = testdata("drawn/box20.cnt");
  const Json r = surface({file, "--caps", "1:high=flat,low=round"});
  EXPECT_EQ(row(r, 1).at("caps"), (Json{{"low", "round"}, {"high", "flat"}}));
  EXPECT_NEAR(box(1).high[2], 21, kPlace);
  EXPECT_LT(box(1).low[2], -0.7) << "a dome of up to half a gap";
  EXPECT_GE(box(1).low[2], -1.5);
  EXPECT_EQ(row(surface({file, "--caps", "1:low=round"}), 1).at("caps"), (Json{{"low", "round"}, {"high", "flat"}}))
      << "the other end by itself";
  for (const char* name : {"a.off", "R.json", "a_1.off"}) std::remove(out(name).c_str());
  fails(2, {"surface", file, "--caps", "1:high=flat,high=round", "-o", out("b.off")},
        {"the high end of label '1' is named twice"});
  fails(2, {"surface", file, "--caps", "1:high=oval", "-o", out("b.off")}, {"unknown cap 'oval'"});
  fails(3, {"surface", file, "--caps", "1:top=flat", "-o", out("b.off")}, {"--caps 1:top"});
}

TEST_F(DrawnContours, PiecesAreLeftOutWhereAsked) {
  // Two cubes of 20 and one of 6 mm, the larger one with a hole that holds another cube.
  const auto square = [](double x, double y, double half) {
    std::ostringstream s;
    s << "{\n"
      << x - half << " " << y - half << "\n"
      << x + half << " " << y - half << "\n"
      << x + half << " " << y + half << "\n"
      << x - half << " " << y + half << "\n}\n";
    return s.str();
  };
  std::string text = "S 6\n";
  for (int k = 0; k < 6; ++k) {
    const bool hollow = k > 0 && k < 5, core = k == 2 || k == 3;
    text += "v " +
            std::to_string(core     ? 20
                           : hollow ? 16
                                    : 12) +
            " z " + std::to_string(4 * k) + "\n" + square(0, 0, 10) + square(40, 0, 9) + square(70, 0, 3);
    if (hollow) text += square(0, 0, 7);
    if (core) text += square(0, 0, 2);
  }
  const std::string file = write("cubes.cnt", text);
  const auto pieces = [&](const std::vector<std::string>& asked) {
    std::vector<std::string> line = {file, "--raw"};
    line.insert(line.end(), asked.begin(), asked.end());
    return row(surface(line), 1).at("components").get<int>();
  };
  EXPECT_EQ(pieces({}), 4);
  EXPECT_EQ(pieces({"--keep-largest"}), 1);
  EXPECT_NEAR(box(1).high[0], 49, 1e-6) << "the solid one: the other has a hole";
  EXPECT_EQ(pieces({"--keep-largest", "2"}), 2);
  EXPECT_EQ(pieces({"--min-piece", "400"}), 3);
  EXPECT_EQ(pieces({"--min-piece", "1000"}), 2);
  bool said = false;
  const Json last = report();
  for (const Json& w : last.at("warnings"))
    said = said || w.get<std::string>().find("2 of its 4 pieces") != std::string::npos;
  EXPECT_TRUE(said);
  // What cannot be meant is refused before anything is written.
  for (const char* name : {"a.off", "R.json", "a_1.off"}) std::remove(out(name).c_str());
  fails(2, {"surface", file, "--min-piece", "1e12", "-o", out("b.off")},
        {"no piece of any label is as large", "--min-piece 1e+12"});
  for (const char* bad : {"0", "-5", "nan", "x"})
    fails(2, {"surface", file, "--min-piece", bad, "-o", out("b.off")}, {"--min-piece", bad});
  for (const char* bad : {"0", "-1", "two", "1.5"})
    fails(2, {"surface", file, "-o", out("b.off"), "--keep-largest", bad}, {"--keep-largest", bad});
  // Voxels alike.
  fails(2, {"surface", testdata("noise.nii.gz"), "--raw", "--min-piece", "1e12", "-o", out("b.off")},
        {"no piece of any label is as large"});
  const Json all = surface({testdata("noise.nii.gz"), "--raw"}),
             one = surface({testdata("noise.nii.gz"), "--raw", "--keep-largest"});
  for (const Json& l : one.at("labels")) {
    EXPECT_EQ(l.at("components"), 1);
    EXPECT_EQ(l.at("input_components"), 1);
    EXPECT_GT(row(all, l.at("label")).at("components"), 1);
  }
}

}  // namespace
}  // namespace program
