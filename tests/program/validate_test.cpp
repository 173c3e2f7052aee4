// `stackmesh validate` as a user calls it: verdict in words, exit codes, report, limits, bad input.
#include <stdlib.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "program.h"

namespace {

using program::Json;

class Validate : public program::ProgramTest {
 protected:
  std::string heart_ = program::testdata("heart4.nii.gz");

  /// The heart's mesh, coarse and made once: a.vtu, a.vtp, a.json (its report).
  static const std::string& made() {
    static const struct Made {
      std::string folder = std::filesystem::temp_directory_path().string() + "/stackmesh_validate_XXXXXX";
      Made() {
        folder = ::mkdtemp(folder.data());
        program::stackmesh({"mesh", program::testdata("heart4.nii.gz"), "--edge-length", "5", "--quiet", "-o",
                            folder + "/a.vtu", "-o", folder + "/a.vtp", "--report", folder + "/a.json"});
      }
      ~Made() {
        std::error_code none;
        std::filesystem::remove_all(folder, none);
      }
    } one;
    return one.folder;
  }
  std::string meshed(const std::string& name) const { return made() + "/" + name; }
};

TEST_F(Validate, JudgesOurOwnMeshAndTheReportHasTheContractsFieldsAndMore) {
  const std::string mesh = meshed("a.vtu");
  const program::Ended ended = program::stackmesh({"validate", mesh, "--against", heart_, "--report", out("R.json")});
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.out.find("verdict  "), std::string::npos);
  EXPECT_EQ(ended.out.find('\x1b'), std::string::npos);  // no colour in a pipe
  EXPECT_EQ(written(), std::vector<std::string>{"R.json"});
  const Json r = report();
  EXPECT_EQ(r["command"], "validate");
  EXPECT_EQ(r["schema"], 1);
  for (const char* key : {"stackmesh", "options", "input", "stages", "peak_rss_mb", "surface", "volume", "labels",
                          "warnings", "verdict", "verdicts", "defects", "limits", "provenance", "mesh"})
    EXPECT_TRUE(r.contains(key)) << key;
  EXPECT_EQ(r["volume"]["closure"], "verified");
  EXPECT_EQ(r["labels"].size(), 5u);
  for (const Json& row : r["labels"]) {
    EXPECT_TRUE(row["closed"].get<bool>());
    EXPECT_GT(row["dice"].get<double>(), 0.9);
    EXPECT_GT(row["wrong_centres"].get<int>(), 0);
    EXPECT_LT(row["wrong_centres_share"].get<double>(), 0.2);
    for (const char* key : {"mean", "max", "outside_share"})
      EXPECT_GE(row["band_distance_mm"][key].get<double>(), 0) << key;
    EXPECT_LT(row["band_distance_mm"]["mean"].get<double>(), row["reverse_distance_mm"]["mean"].get<double>());
    EXPECT_GT(row["mean_bend_deg"].get<double>(), 0);
    EXPECT_LE(row["bends_above_40_share"].get<double>(), 1);
    EXPECT_LE(row["nonmanifold_edges"], r["surface"]["nonmanifold_edges"]);
    EXPECT_NEAR(row["tet_volume_mm3"].get<double>(), row["surface_volume_mm3"].get<double>(),
                1e-6 * row["surface_volume_mm3"].get<double>());
  }
  for (const Json& v : r["verdicts"]) {
    EXPECT_NE(v["status"], "fail") << v;
    for (const char* key : {"id", "title", "figure", "limit", "explanation"})
      EXPECT_FALSE(v[key].get<std::string>().empty()) << v;
  }
  // sha256sum of the file
  const program::Ended sum = program::run({"/usr/bin/sha256sum", heart_});
  EXPECT_EQ(r["provenance"]["input_sha256"], sum.out.substr(0, 64));
  EXPECT_EQ(r["mesh"]["sha256"], program::run({"/usr/bin/sha256sum", mesh}).out.substr(0, 64));
}

TEST_F(Validate, FiguresEqualThoseOfTheRunThatMadeTheMesh) {
  const std::string mesh = meshed("a.vtu");
  program::stackmesh({"validate", mesh, "--against", heart_, "--report", out("R.json")});
  const Json made = Json::parse(program::read_file(meshed("a.json"))), r = report();
  for (const char* part : {"surface", "volume"})
    for (const auto& [key, value] : made[part].items())
      if (value.is_number() && key != "scaled_jacobian_min") {
        EXPECT_NEAR(value.get<double>(), r[part][key].get<double>(), 1e-6 * (1 + value.get<double>())) << key;
      }
  for (std::size_t i = 0; i < made["labels"].size(); ++i)
    for (const char* key : {"dice", "surface_volume_mm3", "components", "euler", "wrong_centres", "mean_bend_deg",
                            "bends_above_40_share"})
      EXPECT_NEAR(made["labels"][i][key].get<double>(), r["labels"][i][key].get<double>(),
                  1e-6 * (1 + made["labels"][i][key].get<double>()))
          << key;
}

TEST_F(Validate, LimitsOfAFileDecideBetweenPassAndExit6) {
  const std::string mesh = meshed("a.vtp");
  const std::string strict = write("strict.json", "{\"dice_warn\": 1, \"dice_fail\": 1}");
  const program::Ended ended =
      program::stackmesh({"validate", mesh, "--against", heart_, "--limits", strict, "--report", out("R.json")});
  EXPECT_EQ(ended.code, 6);
  EXPECT_NE(ended.err.find("valid but outside a limit: Fidelity"), std::string::npos) << ended.err;
  EXPECT_EQ(report()["limits"]["dice_fail"], 1.0);
  EXPECT_EQ(report()["verdict"], "fail");
  // Distances to voxel faces have limits only where they are given; a report's own limits can be read back.
  EXPECT_TRUE(report()["limits"]["mean_distance_fail_px"].is_null());
  Json limits = report()["limits"];
  limits["dice_warn"] = limits["dice_fail"] = 0;
  EXPECT_EQ(program::stackmesh(
                {"validate", mesh, "--against", heart_, "--limits", write("same.json", limits.dump()), "--quiet"})
                .code,
            0);
  limits["mean_distance_fail_px"] = 0.001;
  const program::Ended far = program::stackmesh(
      {"validate", mesh, "--against", heart_, "--limits", write("faces.json", limits.dump()), "--quiet"});
  EXPECT_EQ(far.code, 6);
  EXPECT_NE(far.err.find("to voxel faces"), std::string::npos) << far.err;
  fails(3, {"validate", mesh, "--limits", write("bad.json", "{\"dise\": 1}")}, {"no limit 'dise'"}, {"R.json"});
  fails(3, {"validate", mesh, "--limits", write("none.json", "[")}, {"no JSON object"}, {"R.json"});
}

TEST_F(Validate, AnOpenMeshIsExit4AndItsDefectsAreWritten) {
  std::string text = "OFF\n8 11 0\n";  // a box of voxel faces without one triangle
  for (int k = 0; k < 8; ++k)
    text += std::to_string(k % 2 ? 20 : 0) + " " + std::to_string(k / 2 % 2 ? 20 : 0) + " " +
            std::to_string(k / 4 ? 40 : 0) + "\n";
  text += "3 0 2 1\n3 1 2 3\n3 4 5 6\n3 5 7 6\n3 0 1 4\n3 1 5 4\n3 2 6 3\n3 3 6 7\n3 0 4 2\n3 2 4 6\n3 1 3 5\n";
  const program::Ended ended =
      program::stackmesh({"validate", write("open.off", text), "--report", out("R.json"), "--write-defects"});
  EXPECT_EQ(ended.code, 4);
  EXPECT_NE(ended.err.find("stackmesh: error: the mesh is invalid: Closed: 3 open edges"), std::string::npos)
      << ended.err;
  EXPECT_EQ(written(), (std::vector<std::string>{"R.json", "open_off.defects.vtp"}));
  const Json r = report();
  ASSERT_GE(r["defects"].size(), 1u);
  EXPECT_EQ(r["defects"][0]["kind"], "hole");
  EXPECT_EQ(r["defects"][0]["count"], 3);
}

TEST_F(Validate, ComparesSeveralMeshesInOneTable) {
  const std::string enhanced = meshed("a.vtu"), stitched = in("stitched.vtp");
  program::stackmesh({"surface", heart_, "--no-enhance", "--interpolate", "0", "--quiet", "-o", stitched});
  const program::Ended ended =
      program::stackmesh({"validate", enhanced, stitched, "--against", heart_, "--report", out("R.json")});
  EXPECT_TRUE(ended.code == 0 || ended.code == 6) << ended.err;
  EXPECT_NE(ended.out.find("stitched.vtp"), std::string::npos);
  EXPECT_NE(ended.out.find("* best of its row"), std::string::npos);
  const Json r = report();
  ASSERT_EQ(r["meshes"].size(), 2u);
  std::set<std::string> ids;
  for (const Json& row : r["comparison"]["rows"]) {
    const std::string id = row["id"];
    ids.insert(id);
    if (id == "distance_mean_mm") {
      EXPECT_TRUE(row["best"].empty()) << "a staircase always wins it";
    }
    if (id == "wrong_centres_percent" || id == "bends_above_40_percent") {
      const double first = row["values"][0].get<double>(), second = row["values"][1].get<double>();
      ASSERT_NE(first, second);
      EXPECT_EQ(row["best"], Json::array({first < second ? 0 : 1}));
    }
  }
  for (const char* id : {"distance_mean_mm", "wrong_centres_percent", "band_mean_mm", "band_max_mm", "mean_bend_deg",
                         "bends_above_40_percent"})
    EXPECT_EQ(ids.count(id), 1u) << id;
}

TEST_F(Validate, AgainstContourFilesFidelityIsNull) {
  const std::string mesh = in("tube.vtu");
  program::stackmesh({"mesh", program::testdata("tube.cnt"), "-o", mesh, "--quiet"});
  const program::Ended ended =
      program::stackmesh({"validate", mesh, "--against", program::testdata("tube.cnt"), "--report", out("R.json")});
  EXPECT_EQ(ended.code, 0) << ended.err;
  const Json r = report();
  EXPECT_TRUE(r["labels"][0]["dice"].is_null());
  EXPECT_TRUE(r["labels"][0]["distance_mm"].is_null());
  EXPECT_EQ(r["input"]["kind"], "contours");
}

TEST_F(Validate, AgainstDrawnStructuresTheMeshLiesInTheirAnatomicalFrame) {
  const std::string drawn = program::testdata("drawn/rt_gap.dcm"), mesh = in("drawn.vtu"), turned = in("turned.vtu");
  program::stackmesh({"mesh", drawn, "-o", mesh, "--quiet"});
  program::stackmesh({"mesh", drawn, "--space", "ras", "-o", turned, "--quiet"});
  for (const auto& [file, space] : {std::pair{mesh, "lps"}, std::pair{turned, "ras"}}) {
    const program::Ended ended =
        program::stackmesh({"validate", file, "--against", drawn, "--mesh-space", space, "--report", out("R.json")});
    EXPECT_EQ(ended.code, 0) << ended.err;
    const Json r = report();
    EXPECT_EQ(r["input"]["space"], "lps");
    EXPECT_EQ(r["mesh"]["space"], space);
    for (const Json& d : r["defects"]) EXPECT_FALSE(d["section"].is_null()) << d.dump();
  }
}

TEST_F(Validate, AloneItSaysThatFidelityIsNotJudged) {
  const program::Ended ended = program::stackmesh({"validate", meshed("a.vtp")});
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.out.find("fidelity is not judged"), std::string::npos);
}

TEST_F(Validate, BadInputIsOneLineAndExit3) {
  const std::string heart = heart_;
  const auto refused = [&](const std::string& name, const std::string& bytes, const std::vector<std::string>& parts) {
    fails(3, {"validate", write(name, bytes), "--against", heart, "--report", out("R.json")}, parts);
  };
  std::string stl(1024, '\0');
  const unsigned claimed = 40000000;
  std::memcpy(stl.data() + 80, &claimed, 4);
  refused("big.stl", stl, {"big.stl", "claims 40000000 triangles"});
  refused("nan.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n", {"nan.off", "not a finite number"});
  refused("points.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", {"no triangle"});
  refused("hexahedra.inp", "*NODE\n1,0,0,0\n*ELEMENT, TYPE=C3D8\n1,1,1,1,1,1,1,1,1\n", {"hexahedra", "tetrahedra"});
  refused("far.off", "OFF\n4 4 0\n9000 0 0\n9001 0 0\n9000 1 0\n9000 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n",
          {"do not overlap"});
  fails(3, {"validate", in("absent.vtu"), "--against", heart}, {"absent.vtu", "cannot be opened"});
  fails(3, {"validate", write("x.xyz", "1"), "--against", heart}, {"ending"});
  const std::string mesh = meshed("a.vtu");
  fails(3, {"validate", mesh, "--against", heart, "--label-array", "density"}, {"no cell array 'density'"});
  fails(2, {"validate", mesh, "--label", "3"}, {"--against"});
  fails(2, {"validate", mesh, "--mesh-space", "xyz"}, {"unknown space"});
  fails(2, {"validate", mesh, "--report", out("R.txt")}, {"unknown ending"});
  const std::string whole = program::read_file(mesh);
  fails(3, {"validate", write("cut.vtu", whole.substr(0, whole.size() / 2)), "--against", heart}, {"cut.vtu"});
}

TEST_F(Validate, AMeshInIndicesTimesSpacingIsMovedToItsImage) {
  const std::string labels = program::testdata("oblique.nii.gz");  // turned, and its axes mirror
  succeeds({"surface", labels, "--label", "100", "-o", in("world.off"), "--quiet"});
  // The same, as programs write it that know the voxels' size alone.
  const Json info = Json::parse(program::stackmesh({"info", labels, "--json"}).out);
  std::ifstream file(in("world.off"));
  std::string word;
  std::size_t points = 0, triangles = 0, edges = 0;
  file >> word;
  ASSERT_EQ(word, "OFF");
  while ((file >> std::ws).peek() == '#') std::getline(file, word);
  file >> points >> triangles >> edges;
  std::ostringstream text;
  text.precision(17);
  text << "OFF\n" << points << ' ' << triangles << " 0\n";
  for (std::size_t i = 0; i < points; ++i) {
    double p[3];
    for (double& x : p) file >> x;
    for (int k = 0; k < 3; ++k) {
      double along = 0;
      for (int c = 0; c < 3; ++c)
        along += (p[c] - info["origin_mm"][c].get<double>()) * info["direction"][k][c].get<double>();
      text << along << (k < 2 ? ' ' : '\n');
    }
  }
  text << file.rdbuf();
  const std::string mesh = write("index.off", text.str());
  program::Ended done = program::stackmesh(
      {"validate", mesh, "--against", labels, "--label", "100", "--mesh-space", "image", "--report", in("R.json")});
  EXPECT_TRUE(done.code == 0 || done.code == 6) << done.err;
  const auto dice = [&] { return Json::parse(program::read_file(in("R.json")))["labels"][0]["dice"].get<double>(); };
  EXPECT_GT(dice(), 0.97);
  done = program::stackmesh({"validate", mesh, "--against", labels, "--label", "100", "--report", in("R.json")});
  EXPECT_TRUE(done.code != 0) << "taken as it is it does not fit";
  fails(2, {"validate", mesh, "--mesh-space", "image"}, {"needs the image"});
}

TEST_F(Validate, SecondOrderTetsAreReadAlikeFromEveryFormat) {
  const std::string labels = program::testdata("border.nii.gz");
  std::vector<std::string> arguments = {"mesh", labels, "--order", "2", "--edge-length", "6", "--quiet"},
                           names = {"b.vtu", "b.vtk", "b.msh", "b.inp"};
  for (const std::string& name : names) arguments.insert(arguments.end(), {"-o", in(name)});
  ASSERT_EQ(program::stackmesh(arguments).code, 0);
  Json first;
  for (const std::string& name : names) {
    const program::Ended ended =
        program::stackmesh({"validate", in(name), "--against", labels, "--report", out("R.json"), "--quiet"});
    EXPECT_TRUE(ended.code == 0 || ended.code == 6) << ended.err;
    const Json r = report();
    EXPECT_EQ(r["mesh"]["order"], 2);
    EXPECT_EQ(r["volume"]["closure"], "verified") << name;
    if (first.is_null()) first = r;
    for (std::size_t i = 0; i < first["labels"].size(); ++i)
      EXPECT_NEAR(r["labels"][i]["tet_volume_mm3"].get<double>(), first["labels"][i]["tet_volume_mm3"].get<double>(),
                  1e-6 * first["labels"][i]["tet_volume_mm3"].get<double>())
          << name;
    EXPECT_NEAR(r["volume"]["scaled_jacobian_min"].get<double>(), first["volume"]["scaled_jacobian_min"].get<double>(),
                1e-6)
        << name;
  }
}

/// NIfTI with identifying texts in descrip and aux_file, NRRD with keys such as DICOM converters write.
TEST_F(Validate, NoPatientFieldOfAHeaderReachesAReport) {
  const program::Ended made = program::run(
      {"/usr/bin/python3", "-c",
       "import sys,nibabel as n,gzip\n"
       "i=n.load(sys.argv[1]); h=i.header.copy(); h['descrip']=b'DOE^JANE 1961-02-03'; h['aux_file']=b'MRN4711'; "
       "h['db_name']=b'DOE^JANE'\n"
       "n.save(n.Nifti1Image(i.dataobj[:].astype('u1'),i.affine,h),sys.argv[2])\n"
       "d=i.dataobj[:].astype('u1'); s=d.shape\n"
       "open(sys.argv[3],'wb').write(('NRRD0004\\ntype: uchar\\ndimension: 3\\nspace: left-posterior-superior\\nsizes: "
       "%d %d %d\\n"
       "space directions: (1.5,0,0) (0,1.5,0) (0,0,4)\\nencoding: raw\\nspace origin: (0,0,0)\\ncontent: DOE^JANE\\n"
       "DICOM_0010_0010_PatientName:=DOE^JANE\\nDICOM_0010_0030:=19610203\\n# "
       "DOE^JANE\\n\\n'%s).encode()+d.tobytes('F'))\n",
       program::testdata("border.nii.gz"), in("named.nii.gz"), in("named.nrrd")});
  if (made.code != 0) GTEST_SKIP() << "python3-nibabel is missing: " << made.err;
  for (const char* name : {"named.nii.gz", "named.nrrd"}) {
    ASSERT_EQ(program::stackmesh({"mesh", in(name), "-o", out("m.vtu"), "--report", out("M.json")}).code, 0);
    const program::Ended ended =
        program::stackmesh({"validate", out("m.vtu"), "--against", in(name), "--report", out("R.json")});
    EXPECT_EQ(ended.code, 0) << ended.err;
    for (const std::string& text : {program::read_file(out("M.json")), program::read_file(out("R.json")), ended.out,
                                    ended.err, program::read_file(out("m.vtu"))})
      // With the sign between: four letters alone turn up in base64 by chance.
      for (const char* secret : {"DOE^", "^JANE", "DOE JANE", "1961-02", "19610203", "MRN4711"})
        EXPECT_EQ(text.find(secret), std::string::npos) << name << ": " << secret;
  }
}

TEST_F(Validate, SameFiguresForAnyNumberOfThreads) {
  const std::string mesh = meshed("a.vtu");
  Json first;
  for (const char* threads : {"1", "2", "3"}) {
    program::stackmesh(
        {"validate", mesh, "--against", heart_, "--threads", threads, "--report", out("R.json"), "--quiet"});
    Json r = report();
    for (const char* key : {"stages", "peak_rss_mb", "options", "provenance"}) r.erase(key);
    if (first.is_null()) first = r;
    EXPECT_EQ(first, r);
  }
}

}  // namespace
