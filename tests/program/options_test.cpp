// What the options change, seen from outside.
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "program.h"

namespace program {
namespace {

class Options : public ProgramTest {
 protected:
  const std::string border_ = testdata("border.nii.gz");
  /// The report of `mesh INPUT... OPTIONS...` on the stitched surface, whose figures are exact.
  Json mesh(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "mesh");
    arguments.insert(arguments.end(),
                     {"--no-enhance", "--interpolate", "0", "-o", out("a.vtu"), "--report", out("R.json")});
    succeeds(arguments);
    return report();
  }
  static std::vector<int> numbers(const Json& report) {
    std::vector<int> n;
    for (const Json& l : report.at("labels")) n.push_back(l.at("label"));
    return n;
  }
  static std::vector<std::string> names(const Json& report) {
    std::vector<std::string> n;
    for (const Json& l : report.at("labels")) n.push_back(l.at("name"));
    return n;
  }
};

using Numbers = std::vector<int>;
using Names = std::vector<std::string>;

// ---- which labels ----

TEST_F(Options, LabelsByNumberRangeAndName) {
  EXPECT_EQ(numbers(mesh({testdata("heart4.nii.gz"), "--label", "5,1-2"})), (Numbers{1, 2, 5}));
  EXPECT_EQ(numbers(mesh({testdata("shells.nii.gz"), "--label", "10-300"})), (Numbers{11, 200}));
  EXPECT_EQ(numbers(mesh({testdata("oblique.nii.gz"), "--label", "300"})), (Numbers{300}));
  const Json masks = mesh({testdata("masks"), "--label", "heart,1"});
  EXPECT_EQ(numbers(masks), (Numbers{1, 3}));
  EXPECT_EQ(names(masks), (Names{"aorta", "heart"}));
}

TEST_F(Options, WhatIsNotChosenIsBackground) {
  const Json all = mesh({border_, "--simplify", "0"}), one = mesh({border_, "--simplify", "0", "--label", "2"});
  EXPECT_EQ(row(one, 2).at("input_volume_mm3"), row(all, 2).at("input_volume_mm3"));
  EXPECT_NEAR(row(one, 2).at("dice"), 1, 1e-12);
  EXPECT_LT(one.at("volume").at("tets"), all.at("volume").at("tets"));
}

TEST_F(Options, MergedLabelsAreOneNumberedAsTheSmallest) {
  const Json all = mesh({border_}), merged = mesh({border_, "--label", "3,2", "--merge"});
  ASSERT_EQ(numbers(merged), (Numbers{2}));
  EXPECT_DOUBLE_EQ(row(merged, 2).at("input_volume_mm3"),
                   row(all, 2).at("input_volume_mm3").get<double>() + row(all, 3).at("input_volume_mm3").get<double>());
  EXPECT_EQ(row(merged, 2).at("components"), 1);
  EXPECT_NEAR(row(merged, 2).at("dice"), 1, 1e-6);
  EXPECT_EQ(merged.at("options").at("merge"), "on");
  const Json named = mesh({testdata("masks"), "--label", "heart,femur_left", "--merge"});
  EXPECT_EQ(numbers(named), (Numbers{2}));
  EXPECT_EQ(names(named), (Names{"femur_left"}));
  EXPECT_EQ(row(named, 2).at("components"), 2);
}

TEST_F(Options, ContourPairsGiveLabelsByNumberOrName) {
  const std::string outer = testdata("two_labels/outer.cnt"), inner = testdata("two_labels/inner.cnt");
  const Json numbered = mesh({"7=" + outer, "4=" + inner});
  EXPECT_EQ(std::set<int>({4, 7}), std::set<int>({numbers(numbered)[0], numbers(numbered)[1]}));
  const Json named = mesh({"wall=" + outer, "cavity=" + inner});
  EXPECT_EQ(names(named), (Names{"wall", "cavity"}));
  EXPECT_EQ(numbers(named), (Numbers{1, 2}));
  // The inner one wins over the outer one, whose region then is the wall.
  EXPECT_NEAR(row(named, 1).at("surface_volume_mm3"), row(numbered, 7).at("surface_volume_mm3"), 1e-6);
  const Json outline = mesh({outer});
  EXPECT_GT(row(outline, 1).at("surface_volume_mm3"), row(named, 1).at("surface_volume_mm3"));
  EXPECT_EQ(numbers(mesh({"wall=" + outer, "cavity=" + inner, "--label", "cavity"})), (Numbers{2}));
}

// ---- shape ----

TEST_F(Options, CapsPerLabelAreChosenAndReported) {
  const std::string input = testdata("heart4.nii.gz");
  const Json flat = mesh({input, "--caps", "flat"}), round = mesh({input, "--caps", "round"}),
             mixed = mesh({input, "--caps", "1=flat,3=round,5=flat"});
  const Json automatic = mesh({input});
  for (int label = 1; label <= 5; ++label) {
    EXPECT_EQ(row(flat, label).at("caps"), (Json{{"low", "flat"}, {"high", "flat"}}));
    EXPECT_EQ(row(round, label).at("caps"), (Json{{"low", "round"}, {"high", "round"}}));
    // Either way an end holds what its slice stands for.
    EXPECT_NEAR(row(flat, label).at("surface_volume_mm3"), row(round, label).at("surface_volume_mm3"),
                0.002 * row(flat, label).at("input_volume_mm3").get<double>())
        << label;
  }
  // The roof of a round end stands on added points, a flat end needs none.
  const auto added = [](const Json& r) { return r.at("stitched").at("added_points").get<int>(); };
  EXPECT_LT(added(flat), added(mixed));
  EXPECT_LT(added(mixed), added(round));
  for (int label : {1, 5}) EXPECT_EQ(row(mixed, label).at("caps").at("low"), "flat");
  EXPECT_EQ(row(mixed, 3).at("caps").at("low"), "round");
  for (int label : {2, 4})
    EXPECT_EQ(row(mixed, label).at("caps"), row(automatic, label).at("caps")) << "the others stay automatic";
}

TEST_F(Options, CapsByName) {
  const Json r = mesh({testdata("masks"), "--caps", "heart=flat,aorta=round"});
  EXPECT_EQ(row(r, 3).at("caps").at("low"), "flat");
  EXPECT_EQ(row(r, 1).at("caps").at("low"), "round");
}

TEST_F(Options, TheAxisCanBeChosen) {
  for (const auto& [axis, sections] : {std::pair<const char*, int>{"x", 26}, {"y", 22}, {"z", 13}, {"auto", 13}}) {
    const Json r = mesh({border_, "--axis", axis, "--simplify", "0", "--band", "0"});
    EXPECT_EQ(r.at("input").at("axis"), std::string(axis) == "auto" ? "z" : axis);
    EXPECT_EQ(r.at("input").at("sections"), sections);
    for (const Json& l : r.at("labels")) {
      EXPECT_NEAR(l.at("dice"), 1, 1e-12) << axis;
      EXPECT_LT(l.at("distance_mm").at("max"), 1e-9) << axis;
    }
  }
}

TEST_F(Options, SnapAndSimplifyChangeTheVertexCount) {
  const Json cracks = mesh({testdata("vessel.nii.gz"), "--band", "0", "--simplify", "0"}),
             simple = mesh({testdata("vessel.nii.gz"), "--band", "0"});
  EXPECT_GT(cracks.at("contours").at("vertices"), simple.at("contours").at("vertices"));
  EXPECT_EQ(cracks.at("contours").at("vertices_traced"), simple.at("contours").at("vertices_traced"));
  const Json snapped = mesh({testdata("vessel.nii.gz"), "--band", "0", "--snap", "0.3"});
  EXPECT_EQ(snapped.at("surface").at("self_intersections"), 0);
  EXPECT_LE(snapped.at("stitched").at("vertices"), simple.at("stitched").at("vertices"));
  EXPECT_NEAR(row(snapped, 1).at("dice"), 1, 0.02);
}

TEST_F(Options, VirtualSectionsGoBetweenContours) {
  const std::vector<std::string> pair = {"1=" + testdata("two_labels/outer.cnt"),
                                         "2=" + testdata("two_labels/inner.cnt")};
  const auto with = [&](const std::string& number) {
    std::vector<std::string> arguments = {"mesh"};
    arguments.insert(arguments.end(), pair.begin(), pair.end());
    arguments.insert(arguments.end(),
                     {"--no-enhance", "--interpolate", number, "-o", out("a.vtu"), "--report", out("R.json")});
    succeeds(arguments);
    return report();
  };
  const Json none = with("0"), three = with("3"), chosen = with("auto");
  for (const Json& r : {none, three, chosen}) {
    EXPECT_EQ(r.at("input").at("sections"), 9);
    EXPECT_EQ(r.at("volume").at("closure"), "verified");
    EXPECT_EQ(r.at("stitched").at("self_intersections"), 0);
    for (int label : {1, 2})
      EXPECT_NEAR(
          row(r, label).at("tet_volume_mm3").get<double>() / row(none, label).at("tet_volume_mm3").get<double>(), 1,
          0.03);
  }
  EXPECT_GT(three.at("contours").at("vertices"), 2 * none.at("contours").at("vertices").get<double>());
  EXPECT_GT(chosen.at("contours").at("vertices"), none.at("contours").at("vertices"));
}

TEST_F(Options, TetrahedraCanBeRefined) {
  const Json plain = mesh({testdata("tube.cnt")}),
             fine = mesh({testdata("tube.cnt"), "--max-volume", "0.5", "--radius-edge", "2"});
  EXPECT_GT(fine.at("volume").at("tets"), 2 * plain.at("volume").at("tets").get<double>());
  EXPECT_EQ(fine.at("volume").at("closure"), "verified");
  EXPECT_NEAR(row(fine, 1).at("tet_volume_mm3").get<double>() / row(plain, 1).at("tet_volume_mm3").get<double>(), 1,
              1e-9);
}

TEST_F(Options, TetrahedraOfOneLabelCanBeRefined) {
  const Json plain = mesh({border_, "--band", "0"}), all = mesh({border_, "--band", "0", "--max-volume", "0.5"}),
             fine = mesh({border_, "--band", "0", "--max-volume", "1=0.5"});
  const auto tets = [](const Json& r, int label) { return row(r, label).at("tets").get<double>(); };
  EXPECT_GT(tets(fine, 1), 3 * tets(plain, 1));
  EXPECT_NEAR(tets(fine, 1) / tets(all, 1), 1, 0.05);
  EXPECT_LT(tets(fine, 2), 1.3 * tets(plain, 2));
  EXPECT_EQ(fine.at("options").at("max_volume_mm3"), "1=0.5");
}

TEST_F(Options, StrictTurnsALostDetailIntoExit4) {
  const Json r = mesh({testdata("noise.nii.gz")});
  const bool lost = r.at("warnings").dump().find("components") != std::string::npos;
  for (const auto& more : {std::vector<std::string>{}, {"--report", out("S.json")}}) {  // with a report or without
    std::vector<std::string> arguments = {
        "mesh", testdata("noise.nii.gz"), "--strict", "--no-enhance", "--interpolate", "0", "-o", out("s.vtu")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(stackmesh(arguments).code, lost ? 4 : 0);
  }
  succeeds({"mesh", border_, "--strict", "-o", out("b.vtu")});
}

// ---- files ----

struct Off {
  std::vector<std::array<double, 3>> points;
  std::vector<std::array<int, 3>> triangles;
};

Off read_off(const std::string& path) {
  std::ifstream file(path);
  std::string text, clean;
  while (std::getline(file, text)) clean += text.substr(0, text.find('#')) + "\n";
  std::istringstream stream(clean);
  std::size_t points = 0, triangles = 0, edges = 0, corners = 0;
  stream >> text >> points >> triangles >> edges;
  Off off;
  off.points.resize(points);
  off.triangles.resize(triangles);
  for (auto& p : off.points) stream >> p[0] >> p[1] >> p[2];
  for (auto& t : off.triangles) stream >> corners >> t[0] >> t[1] >> t[2];
  EXPECT_TRUE(stream) << path;
  return off;
}

TEST_F(Options, RasNegatesXAndYAndNothingElse) {
  for (const char* space : {"lps", "ras"})
    succeeds({"mesh", testdata("oblique.nii.gz"), "--space", space, "-o", out(std::string(space) + ".off"), "-o",
              out(std::string(space) + ".ply"), "-o", out(std::string(space) + ".obj"), "-o",
              out(std::string(space) + ".vtu"), "-o", out(std::string(space) + ".msh"), "-o",
              out(std::string(space) + ".inp"), "--report", out(std::string(space) + ".json")});
  const Off lps = read_off(out("lps.off")), ras = read_off(out("ras.off"));
  ASSERT_EQ(lps.points.size(), ras.points.size());
  for (std::size_t i = 0; i < lps.points.size(); ++i) {
    EXPECT_EQ(ras.points[i][0], -lps.points[i][0]);
    EXPECT_EQ(ras.points[i][1], -lps.points[i][1]);
    EXPECT_EQ(ras.points[i][2], lps.points[i][2]);
  }
  EXPECT_EQ(lps.triangles, ras.triangles);
  for (const char* ending : {"ply", "obj", "vtu", "inp"}) {
    EXPECT_NE(read_file(out(std::string("lps.") + ending)).find("SPACE=LPS"), std::string::npos) << ending;
    EXPECT_NE(read_file(out(std::string("ras.") + ending)).find("SPACE=RAS"), std::string::npos) << ending;
  }
  EXPECT_EQ(report("ras.json").at("input").at("space"), "ras");
  EXPECT_EQ(report("ras.json").at("labels"), report("lps.json").at("labels"));
}

TEST_F(Options, PerLabelFilesAreClosedOutwardAndOfTheLabelsVolume) {
  succeeds({"surface", testdata("oblique.nii.gz"), "--per-label", "-o", out("p.off"), "-o", out("p.stl"), "--report",
            out("R.json")});
  EXPECT_EQ(written(), (Names{"R.json", "p_100.off", "p_100.stl", "p_300.off", "p_300.stl"}));
  for (int label : {100, 300}) {
    const Off off = read_off(out("p_" + std::to_string(label) + ".off"));
    std::map<std::pair<int, int>, int> edges;
    double six = 0;
    for (const auto& t : off.triangles) {
      for (int k = 0; k < 3; ++k) {
        const int a = t[k], b = t[(k + 1) % 3];
        edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
      }
      const auto &a = off.points[t[0]], &b = off.points[t[1]], &c = off.points[t[2]];
      six +=
          a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    for (const auto& [edge, sum] : edges)
      EXPECT_EQ(sum, 0) << "edge " << edge.first << " " << edge.second << " of label " << label;
    EXPECT_NEAR(six / 6 / row(report(), label).at("surface_volume_mm3").get<double>(), 1, 1e-9);
  }
}

TEST_F(Options, GmshVersions) {
  succeeds({"mesh", border_, "-o", out("a.msh")});
  succeeds({"mesh", border_, "--msh2", "-o", out("b.msh")});
  EXPECT_NE(read_file(out("a.msh")).find("$MeshFormat\n4.1 "), std::string::npos);
  EXPECT_NE(read_file(out("b.msh")).find("$MeshFormat\n2.2 "), std::string::npos);
}

TEST_F(Options, EndingsInCapitalsAndAnExistingFileIsReplaced) {
  std::ofstream(out("A.VTU")) << "old";
  succeeds({"mesh", border_, "-o", out("A.VTU"), "-o", out("B.StL")});
  EXPECT_EQ(written(), (Names{"A.VTU", "B.StL"}));
  EXPECT_GT(read_file(out("A.VTU")).size(), 10000u);
}

TEST_F(Options, PathsWithSpacesAndInTheWorkingFolder) {
  const std::string input = write("a b/tube (1).cnt", read_file(testdata("tube.cnt")));
  Around around;
  around.folder = folder_ + "/out";
  EXPECT_EQ(stackmesh({"mesh", "../in/a b/tube (1).cnt", "-o", "m e.vtu", "--report", "R.json"}, around).code, 0);
  EXPECT_EQ(written(), (Names{"R.json", "m e.vtu"}));
}

// ---- the terminal ----

TEST_F(Options, ProgressQuietAndVerbose) {
  const auto run_with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"mesh", border_, "-o", out("a.vtu")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return succeeds(arguments);
  };
  const Ended plain = run_with({"--progress", "plain"}), verbose = run_with({"--verbose"}),
              quiet = run_with({"--quiet"}), none = run_with({"--progress", "none"}), automatic = run_with({});
  for (const char* stage : {"read", "contours", "stitch", "volume", "validate", "write"}) {
    EXPECT_NE(plain.err.find(stage), std::string::npos) << plain.err;
    EXPECT_NE(verbose.err.find(stage), std::string::npos);
  }
  EXPECT_EQ(plain.err.find('\r'), std::string::npos);
  EXPECT_EQ(quiet.out + quiet.err, "");
  EXPECT_EQ(none.err, automatic.err);
  EXPECT_EQ(plain.out, automatic.out);
  EXPECT_NE(run_with({"--quiet", "--progress", "plain"}).code, -1);
}

// ---- info and contours ----

TEST_F(Options, InfoAsJson) {
  const Json j = Json::parse(succeeds({"info", testdata("oblique.nii.gz"), "--json"}).out);
  EXPECT_EQ(j.at("dimensions"), Json({46, 34, 24}));
  EXPECT_EQ(j.at("kind"), "nifti");
  EXPECT_EQ(j.at("space"), "lps");
  EXPECT_EQ(j.at("axis"), "z");
  ASSERT_EQ(j.at("direction").size(), 3u);
  for (const Json& axis : j.at("direction"))
    EXPECT_NEAR(std::hypot(axis[0].get<double>(), axis[1].get<double>(), axis[2].get<double>()), 1, 1e-6);
  ASSERT_EQ(j.at("labels").size(), 2u);
  EXPECT_EQ(j.at("labels")[0].at("label"), 100);
  const double voxel =
      j.at("spacing_mm")[0].get<double>() * j.at("spacing_mm")[1].get<double>() * j.at("spacing_mm")[2].get<double>();
  const Json r = mesh({testdata("oblique.nii.gz")});
  for (const Json& l : j.at("labels")) {
    EXPECT_NEAR(l.at("volume_mm3"), l.at("voxels").get<double>() * voxel, 1e-6);
    EXPECT_EQ(l.at("volume_mm3"), row(r, l.at("label")).at("input_volume_mm3"));
  }
  const Json masks = Json::parse(succeeds({"info", testdata("masks"), "--json"}).out);
  EXPECT_EQ(masks.at("labels")[1].at("name"), "femur_left");
  EXPECT_EQ(masks.at("warnings").size(), 2u);
  const Json contours = Json::parse(succeeds({"info", testdata("branch.cnt"), "--json"}).out);
  EXPECT_EQ(contours.at("sections"), 12);
}

TEST_F(Options, InfoAsText) {
  const Ended r = succeeds({"info", testdata("shells.nii.gz")});
  EXPECT_EQ(r.err, "");
  for (const char* text : {"40 x 38 x 42", "1.1 x 1.1 x 1.1", "517", "LPS"})
    EXPECT_NE(r.out.find(text), std::string::npos) << text << " is not in: " << r.out;
  EXPECT_NE(succeeds({"info", testdata("tube.cnt")}).out.find("11"), std::string::npos);
}

/// Height and enclosed area of each section of a .cnt file.
std::vector<std::pair<double, double>> areas_of(const std::string& path) {
  std::string text;
  for (char c : read_file(path)) text += c == '{' || c == '}' ? std::string(" ") + c + " " : std::string(1, c);
  std::istringstream stream(text);
  std::string word;
  std::vector<std::pair<double, double>> sections;
  std::vector<std::array<double, 2>> polygon;
  stream >> word >> word;  // S n
  while (stream >> word) {
    if (word == "v") {
      double z = 0;
      stream >> word >> word >> z;
      sections.emplace_back(z, 0);
    } else if (word == "{") {
      polygon.clear();
    } else if (word == "}") {
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const auto &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        sections.back().second += (a[0] * b[1] - a[1] * b[0]) / 2;
      }
    } else {
      polygon.push_back({std::stod(word), 0});
      stream >> polygon.back()[1];
    }
  }
  return sections;
}

TEST_F(Options, ContoursAsCntMeshAgainToTheSameAreas) {
  for (const auto& [input, labels, tolerance] :
       {std::tuple<const char*, Numbers, double>{"heart4.nii.gz", {1, 2, 3, 4, 5}, 1e-12},
        {"oblique.nii.gz", {100, 300}, 3e-4}}) {
    const Ended r = succeeds({"contours", testdata(input), "--band", "0", "-o", out("c.cnt")});
    EXPECT_NE(r.out.find("c_<label>.cnt"), std::string::npos) << r.out;
    std::vector<std::string> pairs;
    for (int label : labels) pairs.push_back(std::to_string(label) + "=" + out("c_" + std::to_string(label) + ".cnt"));
    std::vector<std::string> again = {"contours"};
    again.insert(again.end(), pairs.begin(), pairs.end());
    again.insert(again.end(), {"-o", out("d.cnt")});
    succeeds(again);
    for (int label : labels) {
      const auto first = areas_of(out("c_" + std::to_string(label) + ".cnt")),
                 second = areas_of(out("d_" + std::to_string(label) + ".cnt"));
      ASSERT_EQ(first.size(), second.size());
      for (std::size_t i = 0; i < first.size(); ++i) {
        EXPECT_EQ(first[i].first, second[i].first);
        EXPECT_GT(first[i].second, 0);
        EXPECT_NEAR(second[i].second / first[i].second, 1, tolerance)
            << input << " label " << label << " z " << first[i].first;
      }
    }
    const Json meshed = mesh(pairs);
    EXPECT_EQ(numbers(meshed), labels);
    EXPECT_EQ(meshed.at("volume").at("closure"), "verified");
  }
}

TEST_F(Options, ContoursAsJsonHoldEveryLabelsPixelArea) {
  succeeds({"contours", border_, "--band", "0", "--simplify", "0", "-o", out("c.json")});
  const Json j = report("c.json"), info = Json::parse(succeeds({"info", border_, "--json"}).out);
  ASSERT_EQ(j.at("sections").size(), 13u);
  std::map<int, double> area;
  for (const Json& s : j.at("sections"))
    for (const Json& e : s.at("edges")) {
      const Json &a = s.at("points")[e[0].get<int>()], &b = s.at("points")[e[1].get<int>()];
      const double part = (a[0].get<double>() * b[1].get<double>() - a[1].get<double>() * b[0].get<double>()) / 2;
      area[e[2].get<int>()] += part;
      area[e[3].get<int>()] -= part;
    }
  for (const Json& l : info.at("labels"))
    EXPECT_NEAR(area[l.at("label").get<int>()], l.at("voxels").get<double>() * 1.5 * 1.5, 1e-6);
}

TEST_F(Options, ContoursAsSvg) {
  const Ended r = succeeds({"contours", border_, "-o", out("c.svg")});
  EXPECT_EQ(r.err, "");
  EXPECT_EQ(lines_of(r.out).size(), 1u);
  const std::string svg = read_file(out("c.svg"));
  EXPECT_EQ(svg.rfind("<svg ", 0), 0u);
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
  EXPECT_NE(svg.find("section 13"), std::string::npos);
  EXPECT_NE(svg.find("label 3"), std::string::npos);
}

TEST_F(Options, RawSurfaceIsTheStitchedOne) {
  succeeds({"surface", border_, "--raw", "--interpolate", "0", "-o", out("a.off"), "--report", out("R.json")});
  const Json r = report();
  EXPECT_EQ(r.at("surface").at("level"), "stitched");
  EXPECT_EQ(r.at("surface").at("triangles"), r.at("stitched").at("triangles"));
  EXPECT_EQ(read_off(out("a.off")).triangles.size(), r.at("surface").at("triangles").get<std::size_t>());
  for (const Json& s : r.at("stages")) EXPECT_NE(s.at("name"), "volume");
}

}  // namespace
TEST_F(Options, OrderTwoWritesTenNodeTetsThatOthersRead) {
  const std::string input = testdata("border.nii.gz");
  succeeds({"mesh", input, "--no-enhance", "-o", out("a.vtu"), "-o", out("a.msh"), "-o", out("a.inp"), "-o",
            out("a.vtk"), "-o", out("a.vtp"), "--order", "2", "--report", out("R.json")});
  const Json r = report();
  EXPECT_EQ(r["volume"]["order"], 2);
  EXPECT_EQ(r["volume"]["inverted"], 0);
  EXPECT_EQ(r["volume"]["closure"], "verified");
  const program::Ended read = python(
      "readback.py", {"--report", out("R.json"), out("a.vtu"), out("a.msh"), out("a.inp"), out("a.vtk"), out("a.vtp")});
  if (read.code == 77 || read.code == 127) GTEST_SKIP() << "NOT TESTED: needs python3-vtk9 and python3-meshio";
  EXPECT_EQ(read.code, 0) << read.out;
}

TEST_F(Options, TenMillionTetrahedraAreAskedAbout) {
  fails(2, {"mesh", testdata("border.nii.gz"), "-o", out("a.vtu"), "--max-volume", "1e-6"},
        {"million tetrahedra", "--yes"});
  // An edge length is refused before the surface is made of it.
  fails(2, {"mesh", testdata("border.nii.gz"), "-o", out("a.vtu"), "--edge-length", "0.1"},
        {"million tetrahedra", "--yes"});
  fails(2, {"fem", testdata("border.nii.gz"), "-o", out("a.inp"), "--edge-length", "0.1"},
        {"million tetrahedra", "--yes"});
}

TEST_F(Options, OrderTwoIsRefusedForMedit) {
  fails(2, {"mesh", testdata("border.nii.gz"), "-o", out("a.mesh"), "--order", "2"}, {"Medit", "a.mesh"});
}

}  // namespace program
