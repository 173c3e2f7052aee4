// CalculiX runs the decks unedited, and finds what is known beforehand.
#include "solver.h"

#include "blocks.h"

using namespace stackmesh;
using blocks::block;
using blocks::disturb;

namespace {

class Solver : public solver::SolverTest {};

class SolverOrders : public Solver, public ::testing::WithParamInterface<int> {};

TEST_P(SolverOrders, PatchTestIsExactOnADistortedMesh) {
  NEEDS_CCX();
  TetMesh mesh = block(2, 2, 4, {1, 1, 1.5});
  disturb(mesh, 2, 2, 4, {1, 1, 1.5});
  write_mesh("patch.vtu", mesh);
  law(R"("1": {"E_MPa": 1000, "poisson": 0.3})",
      R"({"fixed": [{"set": "label_1_cap_low", "axes": "z"}, {"set": "side_x", "axes": "x"}, {"set": "side_y", "axes": "y"}],
          "loaded": [{"set": "label_1_cap_high", "force_N": [0, 0, 40]}]})");
  fem("patch.vtu --order " + std::to_string(GetParam()) +
      " --select side_x=plane:0,0,0,1,0,0 --select side_y=plane:0,0,0,0,1,0 --materials law.json -o patch.inp");
  solve("patch");
  expect_answer("uniform patch.frd 1000 0.3 10 6");
}

TEST_P(SolverOrders, TwoMaterialsInSeriesMoveTheirInterfaceAsTheyMust) {
  NEEDS_CCX();
  TetMesh mesh = block(2, 2, 6, {1, 1, 1}, [](int, int, int k) { return k < 2 ? 1 : 2; });
  write_mesh("series.vtu", mesh);
  law(R"("1": {"E_MPa": 1000, "poisson": 0}, "2": {"E_MPa": 250, "poisson": 0})",
      R"({"fixed": [{"set": "label_1_cap_low"}], "loaded": [{"set": "label_2_cap_high", "force_N": [0, 0, 40]}]})");
  fem("series.vtu --order " + std::to_string(GetParam()) + " --materials law.json -o series.inp");
  solve("series");
  expect_answer("series series.frd 1000 2 250 4 10");
}
INSTANTIATE_TEST_SUITE_P(Orders, SolverOrders, testing::Values(1, 2));

TEST_F(Solver, BarHeldAtOneEndIsWithinOnePercentQuadratic) {
  NEEDS_CCX();
  TetMesh mesh = block(2, 2, 20, {2, 2, 3});
  disturb(mesh, 2, 2, 20, {2, 2, 3});
  write_mesh("bar.vtu", mesh);
  law(R"("1": {"E_MPa": 17000, "poisson": 0.3})",
      R"({"fixed": [{"set": "label_1_cap_low"}], "loaded": [{"set": "label_1_cap_high", "pressure_MPa": -10}]})");
  fem("bar.vtu --materials law.json -o bar.inp");  // --order 2 is the default
  solve("bar");
  expect_answer("bar bar.frd 17000 60 10 0.01");
}

TEST_F(Solver, SkinBearsItsShareOfAStretchedBar) {
  NEEDS_CCX();
  write_mesh("skin.vtu", block(2, 2, 4, {1, 1, 1}));
  law(R"("1": {"E_MPa": 100, "poisson": 0})",
      R"({"fixed": [{"set": "label_1_cap_low"}], "moved": [{"set": "label_1_cap_high", "mm": [null, null, 0.004]}]})",
      R"("skins": {"1": {"E_MPa": 2000, "poisson": 0}}, )");
  for (const int order : {1, 2}) {
    const std::string name = "skin" + std::to_string(order);
    fem("skin.vtu --order " + std::to_string(order) + " --skin 1=0.05 --materials law.json -o " + name + ".inp -o " +
        name + ".feb");
    EXPECT_EQ(run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/decks.py' " + name + ".feb", "feb"), 0)
        << read("feb.log");
    solve(name);
    // strain 0.001: 100 MPa * 4 mm2, and 2000 MPa on a perimeter of 8 mm times 0.05 mm
    expect_answer("reaction " + name + ".frd 4 1.2 0.01");
  }
}

TEST_F(Solver, FemurPhantomFixedAtOneCapAndPressedAtTheOther) {
  NEEDS_CCX();
  // Bone and marrow as one label: fewer elements, so that the test is quick in both orders.
  law(R"("*": {"E_MPa": 10000, "poisson": 0.3})",
      R"({"fixed": [{"set": "bone_cap_low"}], "loaded": [{"set": "bone_cap_high", "force_N": [0, 0, -1000]}]})");
  write("names.txt", "1 bone 200 200 100 255\n2 marrow 200 100 100 255\n");
  for (const char* order : {"1", "2"}) {
    fem("'" STACKMESH_TESTDATA
        "/femur.nii.gz' --merge --caps flat --edge-length 14 --interpolate 0 --names names.txt --materials law.json "
        "--order " +
        std::string(order) + " -o femur" + order + ".inp --report r.json");
    const auto f = report().at("fem");
    EXPECT_EQ(f.at("order"), std::stoi(order));
    EXPECT_NEAR(f.at("load_case").at("force_n")[2].get<double>(), -1000, 1e-6);
    solve("femur" + std::string(order));
  }
  expect_answer("compare femur1.frd femur2.frd 1000");
}

TEST_F(Solver, CortexAndMarrowOfTheFemurPhantomRunWithTheLawOfTestdata) {
  NEEDS_CCX();
  fem("'" STACKMESH_TESTDATA
      "/femur.nii.gz' --caps flat --edge-length 14 --interpolate 0 --order 1 --names '" STACKMESH_TESTDATA
      "/femur_names.ctbl' --materials '" STACKMESH_TESTDATA "/femur_law.json' -o femur.inp --report r.json");
  const auto f = report().at("fem");
  ASSERT_EQ(f.at("materials").size(), 2u);
  EXPECT_EQ(f.at("materials")[0].at("name"), "cortical");
  EXPECT_EQ(f.at("materials")[1].at("modulus_mean_mpa"), 50);
  solve("femur");
  expect_answer("balance femur.frd 1000 0.05 20");
}

TEST_F(Solver, TorsosFemursWithTheirCtMapped) {
  NEEDS_CCX();
  const std::string data = STACKMESH_SHARED_DATA "/torso_totalseg/";
  if (!std::filesystem::exists(data + "ct_3mm.nii.gz"))
    GTEST_SKIP() << "NOT TESTED: " << data << "ct_3mm.nii.gz is not there";
  auto j = nlohmann::json::parse(std::ifstream(STACKMESH_TESTDATA "/femur_ct_law.json"));
  for (const char* label : {"75", "76"}) {
    const std::string n = std::string("label_") + label;
    j["load_case"] = {{"fixed", {{{"set", n + "_cap_low"}}}},
                      {"loaded", {{{"set", "top"}, {"force_N", {0, 0, -1000}}}}}};
    write("law.json", j.dump());
    fem("'" + data + "torso_3mm_61labels.nii.gz' --label " + label + " --edge-length 8 --image '" + data +
        "ct_3mm.nii.gz' --materials law.json --select 'top=normal:0,0,1,60&box:-400,-400,135,400,400,200' -o t" +
        label + ".inp --report r.json");
    const auto m = report().at("fem").at("materials")[0];
    EXPECT_GT(m.at("modulus_min_mpa"), 0);
    EXPECT_GT(m.at("materials"), 50);
    solve("t" + std::string(label));
    expect_answer("balance t" + std::string(label) + ".frd 1000 0.02 2");
  }
}

}  // namespace
