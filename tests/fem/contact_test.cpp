// Parts that are tied, or press on each other: CalculiX runs the decks unedited, and finds what is known beforehand.
#include <map>

#include "blocks.h"
#include "solver.h"

using namespace stackmesh;
using blocks::block;
using blocks::disturb;

namespace {

class ContactOrders : public solver::SolverTest, public ::testing::WithParamInterface<int> {
 protected:
  std::string order() const { return " --order " + std::to_string(GetParam()) + " "; }
  static constexpr const char* kSides = " --select side_x=plane:0,0,0,1,0,0 --select side_y=plane:0,0,0,0,1,0 ";
};
INSTANTIATE_TEST_SUITE_P(Orders, ContactOrders, testing::Values(1, 2));

constexpr const char* kOneMaterial = R"("*": {"E_MPa": 1000, "poisson": 0.3})";

TEST_P(ContactOrders, TwoTiedBlocksAnswerAsOneBlock) {
  NEEDS_CCX();
  TetMesh mesh = block(2, 2, 4, {1, 1, 1.5}, [](int, int, int k) { return k < 2 ? 1 : 2; });
  disturb(mesh, 2, 2, 4, {1, 1, 1.5});  // the nodes between the blocks too
  write_mesh("patch.vtu", mesh);
  law(kOneMaterial,
      R"({"fixed": [{"set": "label_1_cap_low", "axes": "z"}, {"set": "side_x", "axes": "x"}, {"set": "side_y", "axes": "y"}],
                        "loaded": [{"set": "label_2_cap_high", "force_N": [0, 0, 40]}]})");
  fem("patch.vtu --parts A=1 B=2" + order() + kSides + "--materials law.json -o patch.inp");
  EXPECT_NE(read("patch.inp").find("*EQUATION"), std::string::npos);
  solve("patch");
  EXPECT_EQ(read("ccx.log").find("WARNING"), std::string::npos) << read("ccx.log");
  expect_answer("uniform patch.frd 1000 0.3 10 6");
}

TEST_P(ContactOrders, ThreeTiedPartsThatMeetInALineAnswerAsOneBlock) {
  NEEDS_CCX();
  // A beside B and C, which lie on each other: at the common line every part has its own copy.
  TetMesh mesh = block(2, 2, 4, {1, 1, 1.5}, [](int i, int, int k) { return i == 0 ? 1 : k < 2 ? 2 : 3; });
  disturb(mesh, 2, 2, 4, {1, 1, 1.5});
  write_mesh("three.vtu", mesh);
  law(kOneMaterial,
      R"({"fixed": [{"set": "cap_low", "axes": "z"}, {"set": "side_x", "axes": "x"}, {"set": "side_y", "axes": "y"}],
                        "loaded": [{"set": "cap_high", "force_N": [0, 0, 40]}]})");
  fem("three.vtu --parts A=3 B=1 C=2" + order() + kSides +
      "--materials law.json -o three.inp -o three.feb -o three.bdf");
  for (const char* deck : {"three.feb", "three.bdf"})
    EXPECT_EQ(
        run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/decks.py' " + std::string(deck) + " tied", "deck"),
        0)
        << read("deck.log");
  EXPECT_NE(read("three.feb").find("type=\"tied-elastic\""), std::string::npos);
  solve("three");
  expect_answer("uniform three.frd 1000 0.3 10 6");
}

TEST_P(ContactOrders, BlocksInContactBearAPressure) {
  NEEDS_CCX();
  write_mesh("press.vtu", block(2, 2, 4, {1, 1, 1.5}, [](int, int, int k) { return k < 2 ? 1 : 2; }));
  law(kOneMaterial,
      R"({"fixed": [{"set": "label_1_cap_low", "axes": "z"}, {"set": "side_x", "axes": "x"}, {"set": "side_y", "axes": "y"}],
                        "loaded": [{"set": "label_2_cap_high", "pressure_MPa": 10}]})",
      R"("contact": [{"parts": ["B", "A"], "type": "contact", "stiffness_MPa_mm": 20000}], )");
  fem("press.vtu --parts A=1 B=2" + order() + kSides +
      "--materials law.json -o press.inp -o press.feb --report r.json");
  EXPECT_EQ(run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/decks.py' press.feb", "deck"), 0)
      << read("deck.log");
  const auto pair = report().at("fem").at("pairs")[0];
  EXPECT_EQ(pair.at("contact"), "contact");
  EXPECT_EQ(pair.at("stiffness_mpa_mm"), 20000);
  EXPECT_EQ(pair.at("primary"), "contact_B_A");  // the law's first part
  solve("press");
  expect_answer("contact press.frd 1000 0.3 -10 3 20000");
}

TEST_P(ContactOrders, BlocksInContactCannotBePulledButTiedOnesCan) {
  NEEDS_CCX();
  write_mesh("pull.vtu", block(2, 2, 4, {1, 1, 1.5}, [](int, int, int k) { return k < 2 ? 1 : 2; }));
  law(kOneMaterial, R"({"fixed": [{"set": "label_1_cap_low"}, {"set": "label_2_cap_high", "axes": "xy"}],
                        "moved": [{"set": "label_2_cap_high", "mm": [null, null, 0.06]}]})");
  for (const std::string kind : {"contact", "tie"}) {
    fem("pull.vtu --parts A=1 B=2 --contact " + kind + order() + "--materials law.json -o " + kind + ".inp");
    solve(kind);
  }
  expect_answer("reaction contact.frd 6 0 0.001");  // of a force of about 40 N
  EXPECT_NE(
      run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/fem_answers.py' reaction tie.frd 6 0 35", "answer"),
      0);
}

TEST_P(ContactOrders, FrictionHoldsWhatSlidingAloneWouldNot) {
  NEEDS_CCX();
  // Pressed with 10 MPa and pushed along by 1 MPa: friction of 0.5 bears it.
  write_mesh("rub.vtu", block(2, 2, 4, {1, 1, 1.5}, [](int, int, int k) { return k < 2 ? 1 : 2; }));
  law(kOneMaterial, R"({"fixed": [{"set": "label_1_cap_low"}],
                        "loaded": [{"set": "label_2_cap_high", "pressure_MPa": 10}, {"set": "label_2_cap_high", "force_N": [4, 0, 0]}]})",
      R"("contact": [{"parts": ["A", "B"], "type": "contact", "friction": 0.5}], )");
  fem("rub.vtu --parts A=1 B=2" + order() + "--materials law.json -o rub.inp --report r.json");
  EXPECT_NEAR(report().at("fem").at("pairs")[0].at("stiffness_mpa_mm").get<double>(),
              50 * 1000 / ((1 + 1 + std::sqrt(2.0)) / 3), 1);
  solve("rub");
  expect_answer("reaction rub.frd 6 40 0.001");
}

TEST_P(ContactOrders, TiedPartsOfACurvedModelMoveAsTheWholeDoes) {
  NEEDS_CCX();
  law(R"("1": {"E_MPa": 1000, "poisson": 0.3}, "2": {"E_MPa": 300, "poisson": 0.3}, "3": {"E_MPa": 5000, "poisson": 0.3})",
      R"({"fixed": [{"set": "border_z_low"}], "loaded": [{"set": "border_z_high", "force_N": [100, 50, -300]}]})");
  const std::string common = "'" STACKMESH_TESTDATA "/border.nii.gz' --edge-length 6 --materials law.json" + order();
  fem(common + "--parts A=1 B=2 C=3 -o parts.inp");
  fem(common + "-o whole.inp");
  solve("parts");
  solve("whole");
  expect_answer("same parts.frd whole.frd");
}

TEST_P(ContactOrders, SetsOfNodesArePointsInGmsh) {
  if (run("command -v gmsh") != 0) GTEST_SKIP() << "NOT TESTED: gmsh is not installed";
  write_mesh("three.vtu", block(2, 2, 4, {1, 1, 1.5}, [](int i, int, int k) { return i == 0 ? 1 : k < 2 ? 2 : 3; }));
  fem("three.vtu --parts A=1 B=2 C=3" + order() + "-o four.msh --report r.json");
  fem("three.vtu --parts A=1 B=2 C=3" + order() + "--msh2 -o two.msh");
  std::map<std::string, std::size_t> meant;  // sets without faces
  const auto model = report().at("fem");
  for (const auto& s : model.at("sets"))
    if (s.at("faces") == 0) meant[s.at("name")] = s.at("nodes");
  EXPECT_EQ(meant.count("triple_A_B_C"), 1u);
  for (const std::string name : {"four", "two"}) {
    ASSERT_EQ(run("gmsh " + name + ".msh -save -format msh22 -o again.msh", "gmsh"), 0) << read("gmsh.log");
    std::istringstream file(read("again.msh"));
    std::map<std::string, std::string> names;
    std::map<std::string, std::size_t> found;
    for (std::string line; std::getline(file, line);) {
      std::istringstream words(line);
      std::string a, b, c, group;
      words >> a >> b >> c >> group;
      if (a == "0" && c.size() > 2 && c[0] == '"') names[b] = c.substr(1, c.size() - 2);
      if (b == "15" && names.count(group) > 0) ++found[names[group]];
    }
    EXPECT_EQ(found, meant) << name;
  }
}

class ContactData : public solver::SolverTest {};

TEST_F(ContactData, EightTiedLabelsMoveAsTheWholeDoes) {
  NEEDS_CCX();
  // Structures of a brain that meet in lines and points: every node that parts share is tied.
  const std::string data = STACKMESH_SHARED_DATA "/ventricles_mri_itksnap/MRIcrop-seg.nii.gz";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "NOT TESTED: " << data << " is not there";
  law(R"("*": {"E_MPa": 1, "poisson": 0.3})",
      R"({"fixed": [{"set": "around"}], "loaded": [{"set": "inner", "force_N": [0.1, 0.05, -0.2]}]})");
  const std::string common =
      "'" + data +
      "' --order 1 --edge-length 4 --select around=normal:0,0,-1,85 --select inner=of:7 --materials law.json ";
  fem(common + "--parts A=1 B=2 C=3 D=4 E=5 F=6 G=7 H=8 -o parts.inp -o parts.bdf");
  fem(common + "-o whole.inp");
  solve("parts");
  EXPECT_EQ(read("ccx.log").find("WARNING"), std::string::npos);
  solve("whole");
  expect_answer("same parts.frd whole.frd");
  EXPECT_EQ(run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/decks.py' parts.bdf tied", "deck"), 0)
      << read("deck.log");
}

TEST_F(ContactData, AVertebraThatOnlyContactHoldsFindsItsRest) {
  NEEDS_CCX();
  // T11's rest on T12: its faces slant, so friction of 0.1 does not hold it under 500 N, and without springs no
  // increment converges.
  const std::string data = STACKMESH_SHARED_DATA "/torso_totalseg/torso_3mm_61labels.nii.gz";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "NOT TESTED: " << data << " is not there";
  law(R"("*": {"E_MPa": 500, "poisson": 0.3})",
      R"({"fixed": [{"set": "low"}], "loaded": [{"set": "high", "force_N": [0, 0, -500]}]})",
      R"("contact": [{"parts": ["A", "B"], "type": "contact", "friction": 0.1, "stabilise": 0.01}], )");
  fem("'" + data +
      "' --label 32,33 --edge-length 6 --order 1 --parts A=33 B=32 --materials law.json --select "
      "'low=of:32&normal:0,0,-1,40' --select "
      "'high=of:33&normal:0,0,1,40' -o t.inp");
  solve("t");
  EXPECT_EQ(read("ccx.log").find("too many cutbacks"), std::string::npos);
}

TEST_F(ContactData, SpringsThatStabiliseBearAlmostNothing) {
  NEEDS_CCX();
  write_mesh("two.vtu", block(2, 2, 4, {1, 1, 1}, [](int, int, int k) { return k < 2 ? 1 : 2; }));
  const std::string load =
      R"({"fixed": [{"set": "label_1_cap_low"}], "loaded": [{"set": "label_2_cap_high", "force_N": [0, 0, -40]}]})";
  law(kOneMaterial, load, R"("contact": [{"parts": ["A", "B"], "type": "contact"}], )");
  refuses(3, "two.vtu --parts A=1 B=2 --materials law.json", {"1 of 2 bodies are not supported"});
  law(kOneMaterial, load, R"("contact": [{"parts": ["A", "B"], "type": "contact", "stabilise": 0.0001}], )");
  fem("two.vtu --parts A=1 B=2 --order 1 --materials law.json -o two.inp --report r.json");
  EXPECT_EQ(report().at("fem").at("pairs")[0].at("stabilise"), 0.0001);
  solve("two");
  expect_answer("reaction two.frd 4 40 0.02");
}

class ContactInput : public solver::SolverTest {};

TEST_F(ContactInput, BadContactsAreRefused) {
  write_mesh("two.vtu", block(2, 2, 4, {1, 1, 1}, [](int, int, int k) { return k < 2 ? 1 : 2; }));
  const auto with = [&](const std::string& contact) { law(kOneMaterial, "{}", R"("contact": )" + contact + ", "); };
  with(R"([{"parts": ["A", "C"], "type": "tie"}])");
  refuses(3, "two.vtu --parts A=1 B=2 --materials law.json",
          {"parts that do not touch", "'A' and 'C'", "these touch: A-B"});
  refuses(3, "two.vtu --materials law.json", {"parts that do not touch", "--parts A=1,3 B=2,4"});
  with(R"([{"parts": ["A", "B"], "type": "tie"}, {"parts": ["B", "A"], "type": "none"}])");
  refuses(3, "two.vtu --parts A=1 B=2 --materials law.json", {"a pair of parts twice"});
  with(R"([{"parts": ["A", "B"], "type": "glue"}])");
  refuses(3, "two.vtu --parts A=1 B=2 --materials law.json", {"law.json, contact", "\"tie\""});
  with(R"([{"parts": ["A", "B"], "type": "tie", "friction": 1}])");
  refuses(3, "two.vtu --parts A=1 B=2 --materials law.json", {"are for type \"contact\""});
  with(R"([{"parts": ["A", "B"], "type": "contact", "friction": -1}])");
  refuses(3, "two.vtu --parts A=1 B=2 --materials law.json", {"\"friction\" is negative"});
  refuses(2, "two.vtu --contact tie", {"--contact is between parts"});
  refuses(2, "two.vtu --parts A=1 B=2 --contact glue", {"--contact"});
  refuses(2, "two.vtu --parts A=1 B=2 --contact contact", {"contact needs materials", "--contact tie"});
}

}  // namespace
