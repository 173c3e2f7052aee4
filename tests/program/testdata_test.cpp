// Every input of testdata/ through `mesh`, to every format at once, and the fields of the report.
#include <set>

#include "program.h"

namespace program {
namespace {

struct Sample {
  std::string name;
  std::vector<std::string> input;  ///< with {} for the folder testdata
  std::vector<std::pair<int, std::string>> labels;
  bool grid = true;
  std::string kind = "nifti", axis = "z", space = "lps";
  int sections = 0;
};

std::ostream& operator<<(std::ostream& stream, const Sample& s) {
  return stream << s.name;
}

const std::vector<Sample> samples = {
    {"femur", {"{}/femur.nii.gz"}, {{1, ""}, {2, ""}}, true, "nifti", "z", "lps", 115},
    {"heart4", {"{}/heart4.nii.gz"}, {{1, ""}, {2, ""}, {3, ""}, {4, ""}, {5, ""}}, true, "nifti", "z", "lps", 18},
    {"vessel", {"{}/vessel.nii.gz"}, {{1, ""}}, true, "nifti", "z", "lps", 46},
    {"shells", {"{}/shells.nii.gz"}, {{3, ""}, {11, ""}, {200, ""}, {517, ""}}, true, "nifti", "z", "lps", 42},
    {"noise", {"{}/noise.nii.gz"}, {{1, ""}, {2, ""}, {3, ""}}, true, "nifti", "z", "lps", 9},
    {"border", {"{}/border.nii.gz"}, {{1, ""}, {2, ""}, {3, ""}}, true, "nifti", "z", "lps", 13},
    {"oblique", {"{}/oblique.nii.gz"}, {{100, ""}, {300, ""}}, true, "nifti", "z", "lps", 24},
    {"slices",
     {"{}/slices_png", "--spacing", "1.25,1.25,8"},
     {{1, ""}, {2, ""}, {3, ""}, {4, ""}, {5, ""}},
     true,
     "slices",
     "z",
     "none",
     12},
    {"glob",
     {"{}/slices_png/slice_1*.png", "--spacing", "1.25,1.25,8"},
     {{1, ""}, {2, ""}, {3, ""}, {4, ""}, {5, ""}},
     true,
     "slices",
     "z",
     "none",
     4},
    {"masks",
     {"{}/masks"},
     {{1, "aorta"}, {2, "femur_left"}, {3, "heart"}, {4, "hip_left"}},
     true,
     "masks",
     "z",
     "lps",
     26},
    {"tube", {"{}/tube.cnt"}, {{1, ""}}, false, "contours", "z", "none", 11},
    {"branch", {"{}/branch.cnt"}, {{1, ""}}, false, "contours", "z", "none", 12},
    {"two_labels",
     {"1={}/two_labels/outer.cnt", "2={}/two_labels/inner.cnt"},
     {{1, ""}, {2, ""}},
     false,
     "contours",
     "z",
     "none",
     9}};

class Testdata : public ProgramTest, public ::testing::WithParamInterface<Sample> {
 protected:
  std::vector<std::string> mesh(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"mesh"};
    for (std::string word : GetParam().input) {
      if (const std::size_t at = word.find("{}"); at != std::string::npos) word.replace(at, 2, STACKMESH_TESTDATA);
      arguments.push_back(word);
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  std::vector<std::string> to_every_format() const {
    std::vector<std::string> arguments;
    for (const char* ending : {"vtu", "msh", "inp", "feb", "bdf", "vtk", "mesh", "stl", "ply", "obj", "off", "vtp"}) {
      arguments.push_back("-o");
      arguments.push_back(out(std::string("m.") + ending));
    }
    return arguments;
  }
  /// What every good run's report says.
  void check(const Json& r) const {
    const Sample& sample = GetParam();
    // Noise is crumbs of a voxel: enhancement keeps each as a piece, but not always round its voxel's centre.
    const bool crumbs = sample.name == "noise" && r.at("surface").at("level") != "stitched";
    EXPECT_EQ(r.at("volume").at("closure"), "verified");
    EXPECT_EQ(r.at("volume").at("inverted"), 0);
    for (const char* part : {"stitched", "surface"}) {
      EXPECT_EQ(r.at(part).at("open_edges"), 0);
      EXPECT_EQ(r.at(part).at("self_intersections"), 0);
    }
    EXPECT_EQ(r.at("input").at("kind"), sample.kind);
    EXPECT_EQ(r.at("input").at("axis"), sample.axis);
    EXPECT_EQ(r.at("input").at("space"), sample.space);
    EXPECT_EQ(r.at("input").at("sections"), sample.sections);
    ASSERT_EQ(r.at("labels").size(), sample.labels.size());
    std::size_t tets = 0;
    for (std::size_t i = 0; i < sample.labels.size(); ++i) {
      const Json& l = r.at("labels")[i];
      SCOPED_TRACE("label " + l.at("label").dump());
      EXPECT_EQ(l.at("label"), sample.labels[i].first);
      EXPECT_EQ(l.at("name"), sample.labels[i].second);
      EXPECT_EQ(l.at("closed"), true);
      EXPECT_GT(l.at("tets"), 0);
      tets += l.at("tets").get<std::size_t>();
      const double surface = l.at("surface_volume_mm3"), filled = l.at("tet_volume_mm3");
      EXPECT_GT(surface, 0);
      EXPECT_NEAR(filled / surface, 1, 1e-9);
      for (const char* end : {"low", "high"})
        EXPECT_TRUE(l.at("caps").at(end) == "flat" || l.at("caps").at(end) == "round");
      if (!sample.grid) continue;
      const double pieces = l.at("input_components");
      if (!crumbs) {
        EXPECT_EQ(l.at("components"), pieces);
      }
      // Stitched contours keep the label of every pixel centre.
      EXPECT_NEAR(l.at("dice"), 1, r.at("surface").at("level") == "stitched" ? 1e-6 : 0.1);
    }
    EXPECT_EQ(r.at("volume").at("tets"), tets);
    // Pieces are compared one to one, not only in number, and any difference is a warning.
    const std::string warnings = r.at("warnings").dump();
    if (crumbs) return;
    EXPECT_EQ(warnings.find("components are missing"), std::string::npos) << warnings;
    EXPECT_EQ(warnings.find("one to one"), std::string::npos) << warnings;
  }
};

TEST_P(Testdata, MeshesToEveryFormatInOneRun) {
  std::vector<std::string> more = to_every_format();
  more.insert(more.end(), {"--report", out("R.json")});
  const Ended r = succeeds(mesh(more));
  EXPECT_EQ(written(), (std::vector<std::string>{"R.json", "m.bdf", "m.feb", "m.inp", "m.mesh", "m.msh", "m.obj",
                                                 "m.off", "m.ply", "m.stl", "m.vtk", "m.vtp", "m.vtu"}));
  check(report());
  // In a pipe: results on stdout, on stderr nothing but warnings, which are those of the report.
  EXPECT_EQ(r.warnings().size(), lines_of(r.err).size()) << r.err;
  EXPECT_EQ(Json(r.warnings()), report().at("warnings"));
  EXPECT_NE(r.out.find("closure verified"), std::string::npos);
  for (const std::string& line : lines_of(r.out))
    EXPECT_TRUE(line.rfind("input ", 0) == 0 || line.rfind("surface ", 0) == 0 || line.rfind("volume ", 0) == 0 ||
                line.rfind("written ", 0) == 0)
        << line;
}

TEST_P(Testdata, DirectStitchKeepsEveryCrackAndFillsExactly) {
  std::vector<std::string> options = {"--simplify", "0",  "--no-enhance", "--caps",   "flat",       "--interpolate",
                                      "0",          "-o", out("m.vtu"),   "--report", out("R.json")};
  if (GetParam().grid) options.insert(options.end(), {"--band", "0"});
  succeeds(mesh(options));
  const Json r = report();
  check(r);
  for (const Json& l : r.at("labels")) {
    EXPECT_EQ(l.at("caps"), (Json{{"low", "flat"}, {"high", "flat"}}));
    if (!GetParam().grid) continue;
    EXPECT_NEAR(l.at("dice"), 1, 1e-12);
    // Cracks are at the voxel faces' centres.
    EXPECT_LT(l.at("distance_mm").at("max"), 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Every, Testdata, ::testing::ValuesIn(samples), [](const auto& p) { return p.param.name; });

// ---- the fields of the report ----

/// The type of each field: 's'tring, 'n'umber, 'i'nteger, 'b'oolean, 0 for null; more than one letter:
/// either.
void expect_fields(const Json& object, const std::vector<std::pair<std::string, std::string>>& fields,
                   const std::string& where) {
  SCOPED_TRACE(where);
  ASSERT_TRUE(object.is_object()) << object;
  std::set<std::string> wanted, found;
  for (const auto& [name, types] : fields) wanted.insert(name);
  for (const auto& [name, value] : object.items())
    if (wanted.count(name)) found.insert(name);  // fields may be added to the contract's
  EXPECT_EQ(found, wanted);
  for (const auto& [name, types] : fields) {
    if (!object.contains(name)) continue;
    const Json& v = object.at(name);
    const char type = v.is_string()           ? 's'
                      : v.is_number_integer() ? 'i'
                      : v.is_number()         ? 'n'
                      : v.is_boolean()        ? 'b'
                      : v.is_null()           ? '0'
                      : v.is_array()          ? 'a'
                                              : 'o';
    const bool fits = types.find(type) != std::string::npos || (type == 'i' && types.find('n') != std::string::npos);
    EXPECT_TRUE(fits) << name << " is " << v.dump() << ", which is none of '" << types << "'";
  }
}

void expect_report(const Json& r, bool grid, bool filled) {
  const std::string number = filled ? "n" : "0", integer = filled ? "i" : "0", of_grid = grid ? "n" : "0";
  expect_fields(r,
                {{"schema", "i"},
                 {"stackmesh", "s"},
                 {"command", "s"},
                 {"options", "o"},
                 {"input", "o"},
                 {"stages", "a"},
                 {"peak_rss_mb", "n"},
                 {"contours", "o"},
                 {"stitched", "o"},
                 {"surface", "o"},
                 {"volume", "o"},
                 {"labels", "a"},
                 {"warnings", "a"}},
                "report");
  EXPECT_EQ(r.at("schema"), 1);
  expect_fields(r.at("input"),
                {{"path", "s"},
                 {"kind", "s"},
                 {"dimensions", grid ? "a" : "0"},
                 {"spacing_mm", grid ? "a" : "0"},
                 {"axis", "s"},
                 {"sections", "i"},
                 {"space", "s"}},
                "input");
  if (grid) {
    for (const char* array : {"dimensions", "spacing_mm"}) ASSERT_EQ(r.at("input").at(array).size(), 3u);
    for (const Json& v : r.at("input").at("dimensions")) EXPECT_TRUE(v.is_number_integer());
    for (const Json& v : r.at("input").at("spacing_mm")) EXPECT_TRUE(v.is_number());
  }
  const std::set<std::string> known = {"read", "contours", "stitch", "enhance", "volume", "validate", "write"};
  std::set<std::string> stages;
  for (const Json& s : r.at("stages")) {
    expect_fields(s, {{"name", "s"}, {"wall_s", "n"}, {"cpu_s", "n"}}, "stages");
    EXPECT_TRUE(known.count(s.at("name"))) << s;
    EXPECT_TRUE(stages.insert(s.at("name")).second) << s << " twice";
    EXPECT_GE(s.at("wall_s"), 0);
    EXPECT_LT(s.at("wall_s"), 60);
  }
  for (const char* name : {"read", "contours", "stitch", "validate"}) EXPECT_TRUE(stages.count(name)) << name;
  EXPECT_GT(r.at("peak_rss_mb"), 10);
  EXPECT_LT(r.at("peak_rss_mb"), 2000);
  expect_fields(r.at("contours"), {{"loops", "i"}, {"vertices_traced", "i"}, {"vertices", "i"}}, "contours");
  expect_fields(
      r.at("stitched"),
      {{"vertices", "i"}, {"triangles", "i"}, {"open_edges", "i"}, {"self_intersections", "i"}, {"added_points", "i"}},
      "stitched");
  expect_fields(r.at("surface"),
                {{"level", "s"},
                 {"vertices", "i"},
                 {"triangles", "i"},
                 {"open_edges", "i"},
                 {"self_intersections", "i"},
                 {"nonmanifold_edges", "i"},
                 {"angle_min_deg", "n"},
                 {"angle_p1_deg", "n"},
                 {"angle_median_deg", "n"},
                 {"edge_min_mm", "n"},
                 {"edge_median_mm", "n"},
                 {"mean_bend_deg", "n"},
                 {"bends_above_40_share", "n"}},
                "surface");
  const std::string level = r.at("surface").at("level");
  EXPECT_TRUE(level == "enhanced" || level == "smoothed" || level == "stitched") << level;
  expect_fields(r.at("volume"),
                {{"nodes", integer},
                 {"tets", integer},
                 {"order", integer},
                 {"inverted", integer},
                 {"dihedral_min_deg", number},
                 {"dihedral_p1_deg", number},
                 {"dihedral_max_deg", number},
                 {"radius_edge_max", number},
                 {"scaled_jacobian_min", number},
                 {"closure", "s"}},
                "volume");
  for (const Json& l : r.at("labels")) {
    expect_fields(l,
                  {{"label", "i"},
                   {"name", "s"},
                   {"closed", "b"},
                   {"components", "i"},
                   {"input_components", grid ? "i" : "0"},
                   {"euler", "i"},
                   {"input_volume_mm3", of_grid},
                   {"surface_volume_mm3", "n"},
                   {"tet_volume_mm3", number},
                   {"tets", integer},
                   {"dice", of_grid},
                   {"wrong_centres", grid ? "i" : "0"},
                   {"wrong_centres_share", of_grid},
                   {"band_distance_mm", grid ? "o" : "0"},
                   {"nonmanifold_edges", "i"},
                   {"mean_bend_deg", "n"},
                   {"bends_above_40_share", "n"},
                   {"distance_mm", grid ? "o" : "0"},
                   {"reverse_distance_mm", grid ? "o" : "0"},
                   {"caps", "o"}},
                  "labels");
    if (grid)
      expect_fields(l.at("band_distance_mm"), {{"mean", "n"}, {"max", "n"}, {"outside_share", "n"}},
                    "band_distance_mm");
    if (grid)
      for (const char* d : {"distance_mm", "reverse_distance_mm"}) {
        expect_fields(l.at(d), {{"mean", "n"}, {"p95", "n"}, {"max", "n"}}, d);
        EXPECT_LE(l.at(d).at("mean"), l.at(d).at("max"));
        EXPECT_LE(l.at(d).at("p95"), l.at(d).at("max"));
      }
    expect_fields(l.at("caps"), {{"low", "s"}, {"high", "s"}}, "caps");
  }
  for (const Json& w : r.at("warnings")) EXPECT_TRUE(w.is_string());
}

class Report : public ProgramTest {};

TEST_F(Report, HasTheFieldsOfTheContractForAVolume) {
  succeeds(
      {"mesh", testdata("oblique.nii.gz"), "-o", out("a.vtu"), "--report", out("R.json"), "--report", out("S.json")});
  const Json r = report();
  expect_report(r, true, true);
  EXPECT_EQ(r.at("command"), "mesh");
  EXPECT_EQ("stackmesh " + r.at("stackmesh").get<std::string>() + "\n", stackmesh({"--version"}).out);
  EXPECT_EQ(r.at("input").at("path"), testdata("oblique.nii.gz"));
  EXPECT_EQ(r.at("input").at("dimensions"), Json({46, 34, 24}));
  EXPECT_NEAR(r.at("input").at("spacing_mm")[2], 2.5, 1e-6);
  EXPECT_EQ(report("S.json"), r);
}

TEST_F(Report, HasTheSameFieldsForASurface) {
  succeeds({"surface", testdata("oblique.nii.gz"), "--raw", "-o", out("a.stl"), "--report", out("R.json")});
  expect_report(report(), true, false);
  EXPECT_EQ(report().at("command"), "surface");
  EXPECT_EQ(report().at("volume").at("closure"), "skipped");
}

TEST_F(Report, HasTheSameFieldsForContours) {
  succeeds({"mesh", testdata("branch.cnt"), "-o", out("a.vtu"), "--report", out("R.json")});
  expect_report(report(), false, true);
}

TEST_F(Report, HasTheSameFieldsAfterAFailure) {
  fails(4, {"mesh", testdata("femur.nii.gz"), "-o", out("a.vtu"), "--report", out("R.json"), "--timeout", "0.01"},
        {"femur"}, {"R.json"});
  expect_report(report(), true, false);
  EXPECT_EQ(report().at("volume").at("closure"), "failed");
}

TEST_F(Report, TellsHowFarTheSurfaceCame) {
  succeeds({"mesh", testdata("heart4.nii.gz"), "-o", out("a.vtu"), "--report", out("R.json")});
  EXPECT_EQ(report().at("surface").at("level"), "enhanced");
  const double enhanced = report().at("surface").at("angle_p1_deg");
  succeeds({"mesh", testdata("heart4.nii.gz"), "--no-enhance", "-o", out("b.vtu"), "--report", out("R.json")});
  EXPECT_EQ(report().at("surface").at("level"), "stitched");
  EXPECT_GT(enhanced, report().at("surface").at("angle_p1_deg").get<double>() + 10);
}

}  // namespace
}  // namespace program
