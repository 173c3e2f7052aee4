// What other people's programs (nibabel, VTK, meshio, Gmsh) find in our files.
#include "program.h"

namespace program {
namespace {

/// True when the script could not run; the test then skips, and says so.
bool unavailable(const Ended& r) {
  return r.code == 77 || r.code == 127;
}

class OtherPrograms : public ProgramTest {
 protected:
  /// Meshes to every format and compares counts, labels, coordinates and volumes by VTK and meshio.
  void reads_back(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "mesh");
    std::vector<std::string> check = {"--report", out("R.json")};
    for (const char* ending : {"vtu", "msh", "inp", "vtk", "mesh", "stl", "ply", "obj", "off", "vtp"}) {
      check.push_back(out(std::string("m.") + ending));
      arguments.insert(arguments.end(), {"-o", check.back()});
    }
    arguments.insert(arguments.end(), {"--report", out("R.json")});
    succeeds(arguments);
    const Ended r = python("readback.py", check);
    if (unavailable(r)) GTEST_SKIP() << "NOT TESTED: needs /usr/bin/python3 with python3-vtk9 and python3-meshio";
    EXPECT_EQ(r.code, 0) << r.out << r.err;
    EXPECT_EQ(r.out.find("MISMATCH"), std::string::npos) << r.out;
  }
  /// Meshes to .vtu without enhancement and compares with the volume as nibabel reads it.
  void lands_on(const std::string& input, const std::vector<std::string>& options, bool exact) const {
    std::vector<std::string> arguments = {
        "mesh",         input,           "-o", out("m.vtu"), "--report", out("R.json"),
        "--no-enhance", "--interpolate", "0",  "--band",     "0"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    succeeds(arguments);
    std::vector<std::string> check = {out("R.json"), out("m.vtu"), input};
    if (exact) check.push_back("--exact");
    const Ended r = python("against_labels.py", check);
    if (unavailable(r)) GTEST_SKIP() << "NOT TESTED: needs /usr/bin/python3 with python3-nibabel and python3-vtk9";
    EXPECT_EQ(r.code, 0) << r.out << r.err;
    EXPECT_EQ(r.out.find("DIFFERS"), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("label "), std::string::npos) << r.out;
  }
};

// ---- every file back ----

TEST_F(OtherPrograms, ReadBackAnObliqueVolume) {
  reads_back({testdata("oblique.nii.gz")});
}

TEST_F(OtherPrograms, ReadBackNamesInRas) {
  reads_back({testdata("masks"), "--space", "ras"});
}

TEST_F(OtherPrograms, ReadBackContoursWithoutAFrame) {
  reads_back({"wall=" + testdata("two_labels/outer.cnt"), "cavity=" + testdata("two_labels/inner.cnt")});
}

TEST_F(OtherPrograms, ReadBackRealVentricles) {
  const std::string input = shared_data("ventricles_mri_itksnap/MRIcrop-seg.nii.gz");
  if (input.empty()) GTEST_SKIP() << "NOT TESTED: the shared data are not here";
  reads_back({input});
}

TEST_F(OtherPrograms, ReadBackARealSpinalCord) {
  const std::string input = shared_data("spinal_cord_thick_sct/mt1_wm1_gm2_labels.nii.gz");
  if (input.empty()) GTEST_SKIP() << "NOT TESTED: the shared data are not here";
  reads_back({input});
}

TEST_F(OtherPrograms, GmshFindsTheReportsCountsWithoutAComplaint) {
  if (run({"/bin/sh", "-c", "command -v gmsh"}).code != 0) GTEST_SKIP() << "NOT TESTED: gmsh is not installed";
  std::string input = shared_data("ventricles_mri_itksnap/MRIcrop-seg.nii.gz");
  if (input.empty()) input = testdata("heart4.nii.gz");
  succeeds({"mesh", input, "-o", out("4.msh"), "--report", out("R.json")});
  succeeds({"mesh", input, "-o", out("2.msh"), "--msh2"});
  const Json r = report();
  const auto text = [](const Json& a, const Json& b) {
    return std::to_string(a.get<long>() + (b.is_null() ? 0 : b.get<long>()));
  };
  for (const char* name : {"4.msh", "2.msh"}) {
    const Ended gmsh = run({"/bin/sh", "-c", "exec gmsh '" + out(name) + "' -check -"});
    EXPECT_EQ(gmsh.code, 0);
    const std::string said = gmsh.out + gmsh.err;
    EXPECT_NE(said.find(text(r["volume"]["nodes"], nullptr) + " nodes"), std::string::npos) << said;
    EXPECT_NE(said.find(text(r["volume"]["tets"], r["surface"]["triangles"]) + " elements"), std::string::npos) << said;
    EXPECT_EQ(said.find("Error"), std::string::npos) << said;
    EXPECT_EQ(said.find("Warning"), std::string::npos) << said;
  }
}

// ---- where it lies, and how far off ----

TEST_F(OtherPrograms, AnObliqueVolumeLandsWhereNibabelSays) {
  lands_on(testdata("oblique.nii.gz"), {"--simplify", "0", "--caps", "flat"}, true);
  lands_on(testdata("oblique.nii.gz"), {"--space", "ras"}, false);
}

TEST_F(OtherPrograms, AMirroredFloatVolumeLandsWhereNibabelSays) {
  lands_on(testdata("shells.nii.gz"), {"--simplify", "0"}, true);
  lands_on(testdata("shells.nii.gz"), {"--axis", "x", "--simplify", "0", "--space", "ras"}, true);
}

TEST_F(OtherPrograms, ARealHeartLandsWhereNibabelSays) {
  const std::string input = shared_data("heart_totalseg/heart.nii.gz");
  if (input.empty()) GTEST_SKIP() << "NOT TESTED: the shared data are not here";
  lands_on(input, {}, false);
}

TEST_F(OtherPrograms, RealVentriclesLandWhereNibabelSays) {
  const std::string input = shared_data("ventricles_mri_itksnap/MRIcrop-seg.nii.gz");
  if (input.empty()) GTEST_SKIP() << "NOT TESTED: the shared data are not here";
  lands_on(input, {}, false);
}

TEST_F(OtherPrograms, TheCheckSeesAWrongFrame) {
  // The mesh of the file with its axes turned, against the file as it is.
  const std::string input = testdata("oblique.nii.gz");
  succeeds({"mesh", input, "-o", out("m.vtu"), "--report", out("R.json"), "--space", "ras"});
  std::string bytes = read_file(out("m.vtu"));
  // The mark is field data: the codes of its letters.
  const std::string ras = "82 65 83", lps = "76 80 83";
  const std::size_t at = bytes.find(ras);
  if (at != std::string::npos) bytes.replace(at, ras.size(), lps);
  const std::string turned = write("turned.vtu", bytes);
  const Ended same = python("against_labels.py", {out("R.json"), out("m.vtu"), input});
  if (unavailable(same)) GTEST_SKIP() << "NOT TESTED: needs python3-nibabel and python3-vtk9";
  EXPECT_EQ(same.code, 0) << same.out << same.err;
  const Ended other = python("against_labels.py", {out("R.json"), turned, input});
  EXPECT_EQ(other.code, 1) << other.out << other.err;
  EXPECT_NE(other.out.find("DIFFERS: centroid"), std::string::npos) << other.out << other.err;
}

// ---- the judge that the project did not write ----

class Judge : public ProgramTest {
 protected:
  /// The judge's verdict on one label of `mesh INPUT`, against the report's row. "" skips.
  void agrees(const std::string& input, int label, bool one_piece) const {
    const std::string script = STACKMESH_SHARED_DATA "/../tools/judge_mesh.py";
    if (input.empty() || read_file(script).empty())
      GTEST_SKIP() << "NOT TESTED: the shared data or their judge are not here";
    // the judge counts stored voxels
    succeeds({"mesh", input, "--as-stored", "-o", out("m.vtu"), "--report", out("R.json")});
    const Ended r = run({"/usr/bin/python3", script, out("m.vtu"), input, "--label", std::to_string(label)});
    if (unavailable(r) || r.err.find("ModuleNotFoundError") != std::string::npos)
      GTEST_SKIP() << "NOT TESTED: the judge needs python3-vtk9, python3-nibabel, python3-scipy, python3-meshio";
    ASSERT_EQ(r.code, 0) << r.err;
    const Json judged = Json::parse(r.out), told = report(), &l = row(told, label);
    const Json &surface = judged.at("surface"), &fidelity = judged.at("fidelity");
    EXPECT_EQ(judged.at("frame"), "lps");
    EXPECT_EQ(judged.at("tet").at("tets"), told.at("volume").at("tets"));
    EXPECT_EQ(judged.at("tet").at("nodes"), told.at("volume").at("nodes"));
    EXPECT_EQ(judged.at("tet").at("inverted"), 0);
    EXPECT_EQ(judged.at("tet").at("labels").at(std::to_string(label)), l.at("tets"));
    EXPECT_NEAR(judged.at("tet").at("dihedral_min"), told.at("volume").at("dihedral_min_deg").get<double>(), 1e-4);
    EXPECT_NEAR(judged.at("tet").at("dihedral_max"), told.at("volume").at("dihedral_max_deg").get<double>(), 1e-4);
    EXPECT_EQ(surface.at("closed"), true);
    EXPECT_EQ(surface.at("unbalanced_edges"), 0);
    EXPECT_EQ(surface.at("euler"), l.at("euler"));
    if (one_piece) {
      EXPECT_EQ(surface.at("components"), 1);
      EXPECT_EQ(l.at("components"), 1);
    } else {
      // It counts shells that touch in a point as one, we count the solid pieces.
      EXPECT_LE(surface.at("components"), l.at("components"));
    }
    EXPECT_NEAR(surface.at("volume").get<double>() / l.at("surface_volume_mm3").get<double>(), 1, 1e-9);
    EXPECT_NEAR(judged.at("mask_volume").get<double>() / l.at("input_volume_mm3").get<double>(), 1, 1e-6);
    EXPECT_NEAR(fidelity.at("dice"), l.at("dice").get<double>(), 0.002);
    // Its voxel faces include those across the stacking axis, which we leave out: only a bound. Its way back
    // goes to the centres of voxel faces, which lie no nearer than the faces. (The means of the same faces
    // are compared by against_labels.py.)
    EXPECT_GE(fidelity.at("voxel_to_mesh_max").get<double>() * 1.05, l.at("distance_mm").at("max").get<double>());
    EXPECT_GE(fidelity.at("voxel_to_mesh_mean").get<double>() * 1.05, l.at("distance_mm").at("mean").get<double>());
    EXPECT_GE(fidelity.at("mesh_to_voxel_mean").get<double>(), l.at("reverse_distance_mm").at("mean").get<double>());
    EXPECT_GE(fidelity.at("mesh_to_voxel_max").get<double>() * 1.05,
              l.at("reverse_distance_mm").at("max").get<double>());
  }
};

TEST_F(Judge, AgreesOnTheHeart) {
  agrees(shared_data("heart_totalseg/heart.nii.gz"), 1, true);
}

TEST_F(Judge, AgreesOnTheVentricles) {
  agrees(shared_data("ventricles_mri_itksnap/MRIcrop-seg.nii.gz"), 1, false);
}

TEST_F(Judge, AgreesOnThePhantomOfAHeart) {
  agrees(testdata("heart4.nii.gz"), 3, true);
}

}  // namespace
}  // namespace program
