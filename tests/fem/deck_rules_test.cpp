// Decks for FEBio, Nastran and others against the rules of their formats; planted mistakes show that the rules bite.
#include "blocks.h"
#include "solver.h"

using namespace stackmesh;
using blocks::block;

namespace {

class DeckRules : public solver::SolverTest, public ::testing::WithParamInterface<int> {
 protected:
  /// A model with all that decks can have: parts that are tied, in contact, and neither; a skin, supports, a
  /// displacement, forces, pressure.
  void make() {
    write_mesh("m.vtu", block(4, 2, 2, {1, 1, 1}, [](int i, int, int) { return i + 1; }));
    law(R"("*": {"E_MPa": 1000, "poisson": 0.3, "density_t_mm3": 1e-9})",
        R"({"fixed": [{"set": "side"}], "moved": [{"set": "end", "mm": [0.1, 0, 0]}],
            "loaded": [{"set": "label_2_cap_high", "force_N": [1, 2, 3]}, {"set": "label_3_cap_high", "pressure_MPa": 0.25}]})",
        R"("skins": {"1": {"E_MPa": 17000, "poisson": 0.3}}, "contact": [{"parts": ["B", "C"], "type": "contact", "friction": 0.2},
           {"parts": ["C", "D"], "type": "none"}], )");
    fem("m.vtu --parts A=1 B=2 C=3 D=4 --skin 1=0.2 --select side=plane:0,0,0,1,0,0 --select end=plane:4,0,0,1,0,0 "
        "--materials law.json -o m.feb -o m.bdf --order " +
        std::to_string(GetParam()));
  }
  int rules(const std::string& script, const std::string& deck) const {
    return run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/" + script + "' " + deck, "rules");
  }
  /// The deck with the first `from` made `to` must break the rules.
  void breaks(const std::string& script, const std::string& deck, const std::string& from,
              const std::string& to) const {
    std::string text = read(deck);
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write("bad_" + deck, text.replace(at, from.size(), to));
    EXPECT_EQ(rules(script, "bad_" + deck), 1) << from << " -> " << to << "\n" << read("rules.log");
  }
};
INSTANTIATE_TEST_SUITE_P(Orders, DeckRules, testing::Values(1, 2));

TEST_P(DeckRules, FebioDeckKeepsThemAndPlantedMistakesDoNot) {
  make();
  const std::string script = "febio_rules.py";
  ASSERT_EQ(rules(script, "m.feb"), 0) << read("rules.log");
  EXPECT_EQ(run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/decks.py' m.feb", "deck") % 77, 0)
      << read("deck.log");
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"version=\"4.0\"", "version=\"3.0\""},
           {"<Module type=\"solid\">", "<Module kind=\"solid\">"},
           {"type=\"tied-elastic\"", "type=\"tied\""},
           {"surface_pair=\"pair_A_B\"", "surface_pair=\"pair_A_D\""},
           {"<laugon>AUGLAG<", "<laugon>LAGRANGE<"},
           {"<fric_coeff>0.2</fric_coeff>", "<friction>0.2</friction>"},
           {"<time_steps>10<", "<time_steps>ten<"},
           {"mat=\"M_label_3\"", "mat=\"label_3\""},
           {"<Nodes name", "<Nodes set"},
           {"<v>0.3</v>", "<nu>0.3</nu>"},
           {"node_set=\"side\"", "node_set=\"back\""},
           {"lc=\"1\"", "lc=\"2\""},
           {"<surface_load name=\"pressure_1\" surface=\"label_3_cap_high\"",
            "<surface_load name=\"pressure_1\" surface=\"top\""},
           {"<linear>0</linear>", "<follower>1</follower>"},
           {"<shell_thickness>", "<shell_thickness>thin"},
           {"<primary>contact_A_B<", "<primary>contact_B_B<"},
           {"<MeshDomains>", "<MeshData></MeshData>\n<MeshDomains>"}})
    breaks(script, "m.feb", from, to);
}

TEST_P(DeckRules, NastranDeckKeepsThemAndPlantedMistakesDoNot) {
  make();
  const std::string script = "nastran_rules.py";
  ASSERT_EQ(rules(script, "m.bdf"), 0) << read("rules.log");
  EXPECT_NE(read("m.bdf").find("$ surfaces that face each other, without contact here: contact_B_C and contact_C_B"),
            std::string::npos);
  const std::string text = read("m.bdf"), tie = text.substr(text.find("RBE2"), 41);  // with its end of line
  ASSERT_EQ(tie.back(), '\n');
  // with the corners of its face in the last two fields of 16
  const std::string load = text.substr(text.find("PLOAD4"), 144);
  std::string turned = load;
  turned.replace(112, 32, load.substr(128, 16) + load.substr(112, 16));
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {tie, tie + tie},
           {"RBE2    ", "RBE3    "},
           {"SPC = 1", ""},
           {"LOAD = 2", ""},
           {"PSOLID         2", "PSOLID         9"},
           {"MAT1*                  1           1000.", "MAT1*                  1            1000"},
           {"CTETRA         1", "CTETRA         2"},
           {"ENDDATA", "ENDDAT"},
           {load, turned},
           {"SPCD*                  2", "SPCD*                  7"}})
    breaks(script, "m.bdf", from, to);
}

TEST_P(DeckRules, OtherDecksCarrySetsMaterialsAndTheLoadCase) {
  write_mesh("m.vtu", block(4, 2, 2, {1, 1, 1}, [](int i, int, int) { return i + 1; }));
  law(R"("1": {"E_MPa": 17000, "poisson": 0.3, "density_t_mm3": 2e-9}, "*": {"E_MPa": 1000, "poisson": 0.3, "density_t_mm3": 1e-9})",
      R"({"fixed": [{"set": "side"}], "moved": [{"set": "end", "mm": [0.1, null, 0]}], "gravity_mm_s2": [0, 0, -9810],
          "loaded": [{"set": "label_2_cap_high", "force_N": [1, 2, 3]}, {"set": "label_3_cap_high", "pressure_MPa": 0.25}]})");
  fem("m.vtu --parts A=1,2 B=3,4 --select side=plane:0,0,0,1,0,0 --select end=plane:4,0,0,1,0,0 --materials law.json "
      "-o m.cdb -o m.k -o m.exo -o m.med --order " +
      std::to_string(GetParam()));
  const std::string warned = read("fem.log");
  EXPECT_NE(warned.find("m.exo: the format holds no load case"), std::string::npos) << warned;
  EXPECT_EQ(warned.find("m.cdb"), warned.find("m.cdb\n")) << "nothing is lost in .cdb: " << warned;
  const int code =
      run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/other_decks.py' m.cdb m.k m.exo m.med", "summary");
  if (code != 0 && read("summary.log").find("No module named") != std::string::npos)
    GTEST_SKIP() << "NOT TESTED: " << read("summary.log");
  ASSERT_EQ(code, 0) << read("summary.log");
  const nlohmann::json all = nlohmann::json::parse(read("summary.log"));
  const std::size_t side = GetParam() == 1 ? 9 : 25;
  for (const char* name : {"m.cdb", "m.k", "m.exo", "m.med"}) {
    const nlohmann::json& d = all[name];
    EXPECT_EQ(d["tets"], 96) << name;
    for (const char* label : {"label_1", "label_2", "label_3", "label_4"}) EXPECT_EQ(d["parts"][label], 24) << name;
    EXPECT_EQ(d["node_sets"]["side"], side) << name;
    if (std::string(name) != "m.cdb") {
      EXPECT_EQ(d["face_sets"]["side"], 8) << name;
    }
    EXPECT_EQ(d["E"], (std::vector<double>{1000, 17000})) << name;
    if (std::string(name) == "m.exo" || std::string(name) == "m.med") continue;
    EXPECT_EQ(d["held"], 3 * side + side) << name;
    EXPECT_EQ(d["moved"], side) << name;
    EXPECT_EQ(d["moved_mm"], 0.1) << name;
    EXPECT_EQ(d["coupled"], 3 * side) << name;
    EXPECT_EQ(d["coupled_apart"], 0) << name;
    EXPECT_EQ(d["gravity"], (std::vector<double>{0, 0, -9810})) << name;
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(d["force"][k], k + 1, 1e-6) << name;
      EXPECT_NEAR(d["pressed"][k], k == 2 ? -0.5 : 0, 1e-9) << name;  // 0.25 MPa on 2 mm2
    }
  }
}

}  // namespace
