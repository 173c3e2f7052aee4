// Materials beyond the linear isotropic one, and where fibres go: against closed forms, and in CalculiX.
#include <cmath>

#include "base/error.h"
#include "blocks.h"
#include "fem/assign_materials.h"
#include "fem/name_sets.h"
#include "solver.h"

using namespace stackmesh;
using blocks::block;

namespace {

class Fibres : public solver::SolverTest {
 protected:
  void rules(const std::string& name) const {
    EXPECT_EQ(run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/febio_rules.py' " + name + ".feb", "rules"),
              0)
        << read("rules.log");
    EXPECT_EQ(
        run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/nastran_rules.py' " + name + ".bdf", "rules"), 0)
        << read("rules.log");
  }
};

constexpr const char* kOrthotropic =
    R"("model": "orthotropic", "E_MPa": [1000, 200, 200], "poisson": [0, 0, 0], "G_MPa": [80, 80, 80])";

TEST_F(Fibres, TurnThroughAFlatWallAsTheRuleSays) {
  // Laplace's equation between two parallel faces is x / 4, whatever the mesh.
  TetMesh mesh = block(4, 3, 3, {1, 1, 1});
  blocks::disturb(mesh, 4, 3, 3, {1, 1, 1});
  SetOptions sets;
  sets.selections = {"inner=plane:0,0,0,1,0,0", "outer=plane:4,0,0,1,0,0"};
  SolverModel m = name_sets(mesh, {}, sets);
  law(std::string("\"1\": {") + kOrthotropic +
          R"(, "fibres": {"from": "inner", "to": "outer", "angles_deg": [60, -60], "along": [0, 0, 2]}})",
      "{}");
  const MaterialPlan plan = read_law(at("law.json"));
  assign_materials(m, &plan, nullptr);
  ASSERT_EQ(m.sets.axes.size(), m.mesh.tets.size());
  for (std::size_t t = 0; t < m.mesh.tets.size(); ++t) {
    double x = 0;
    for (const std::int32_t v : m.mesh.tets[t]) x += 0.25 * m.mesh.points[v].x;
    const double angle = (60 - 120 * x / 4) * M_PI / 180;
    const Vec3 meant = {0, std::cos(angle), std::sin(angle)};  // around: z x x = y
    EXPECT_LT(norm(m.sets.axes[t][0] - meant), 1e-8);
    // the third axis goes through the wall
    EXPECT_LT(norm(cross(m.sets.axes[t][0], m.sets.axes[t][1]) - Vec3{1, 0, 0}), 1e-8);
  }
}

TEST_F(Fibres, GoRoundATube) {
  // A quarter of a tube about z, radii 10 and 20 mm: the depth is log(r / 10) / log 2, and a fibre of 0 degrees goes
  // round.
  TetMesh mesh = block(6, 10, 2, {1, 1, 2});
  for (Vec3& p : mesh.points) {
    const double r = 10 * std::pow(2, p.x / 6), angle = p.y / 10 * M_PI / 2;
    p = {r * std::cos(angle), r * std::sin(angle), p.z};
  }
  SetOptions sets;
  sets.selections = {"inner=sphere:0,0,0,10.8&normal:1,1,0,180", "outer=normal:1,1,0,50"};
  sets.sharp_deg = 60;
  SolverModel m = name_sets(mesh, {}, sets);
  // The inner face is the set of all faces at the smaller radius; heights reach to 4 mm.
  law(std::string("\"1\": {") + kOrthotropic +
          R"(, "fibres": {"from": "label_1_outer_2", "to": "label_1_outer_1", "angles_deg": [0, 0], "along": [0, 0, 1]}})",
      "{}");
  const MaterialPlan plan = read_law(at("law.json"));
  assign_materials(m, &plan, nullptr);
  double worst = 0;
  for (std::size_t t = 0; t < m.mesh.tets.size(); ++t) {
    Vec3 c;
    for (const std::int32_t v : m.mesh.tets[t]) c = c + 0.25 * m.mesh.points[v];
    const Vec3 around = (1 / std::hypot(c.x, c.y)) * Vec3{-c.y, c.x, 0};
    worst = std::max(worst, std::acos(std::min(1.0, std::abs(dot(around, m.sets.axes[t][0])))) * 180 / M_PI);
  }
  EXPECT_LT(worst, 10);  // a cell spans 9 degrees
}

TEST_F(Fibres, StretchedAlongThemABarIsStiffAcrossThemSoft) {
  NEEDS_CCX();
  write_mesh("bar.vtu", block(2, 2, 6, {1, 1, 2}));
  const std::string rule = R"("fibres": {"from": "left", "to": "right", "along": [0, 0, 1], "angles_deg": )";
  const std::vector<std::pair<std::string, double>> cases = {
      {R"("axes": {"fibre": [0, 0, 1], "across": [1, 0, 0]})", 1000},
      {R"("axes": {"fibre": [1, 0, 0], "across": [0, 0, 1]})", 200},
      {rule + "[90, 90]}", 1000},
      {rule + "[0, 0]}", 200}};
  for (const auto& [where, young] : cases) {
    law(std::string("\"1\": {") + kOrthotropic + ", " + where + "}",
        R"({"fixed": [{"set": "label_1_cap_low"}], "loaded": [{"set": "label_1_cap_high", "pressure_MPa": -10}]})");
    fem("bar.vtu --select left=plane:0,0,0,1,0,0 --select right=plane:2,0,0,1,0,0 --materials law.json -o bar.inp -o "
        "bar.feb -o bar.bdf -o bar_out.vtu");
    rules("bar");
    EXPECT_NE(read("bar.feb").find("type=\"mat_axis\""), std::string::npos);
    EXPECT_NE(read("bar_out.vtu").find("Name=\"fibre\" NumberOfComponents=\"3\""), std::string::npos);
    solve("bar");
    expect_answer("end bar.frd 12 0 0 " + std::to_string(10 * 12 / young) + " 1e-3");
  }
}

TEST_F(Fibres, DistributedOrientationsTurnElementByElement) {
  NEEDS_CCX();
  // From 90 degrees at one side to 0 at the other: stiffer than all across, softer than all along.
  write_mesh("bar.vtu", block(4, 2, 6, {0.5, 1, 2}));
  law(std::string("\"1\": {") + kOrthotropic +
          R"(, "fibres": {"from": "left", "to": "right", "along": [0, 0, 1], "angles_deg": [90, 0]}})",
      R"({"fixed": [{"set": "label_1_cap_low"}], "moved": [{"set": "label_1_cap_high", "mm": [0, 0, 0.12]}]})");
  fem("bar.vtu --select left=plane:0,0,0,1,0,0 --select right=plane:2,0,0,1,0,0 --materials law.json -o bar.inp -o "
      "bar.bdf");
  EXPECT_NE(read("bar.inp").find("*DISTRIBUTION, NAME=DOR_M_label_1"), std::string::npos);
  EXPECT_NE(read("fem.log").find("fibres that turn from element to element are not written"), std::string::npos)
      << read("fem.log");
  solve("bar");
  expect_answer("reaction bar.frd 12 20 0.4");  // 8 N if all lay across, 40 N along
}

TEST_F(Fibres, RubberPullsAsMooneyAndRivlinSay) {
  NEEDS_CCX();
  write_mesh("bar.vtu", block(1, 1, 4, {2, 2, 3}));
  law(R"("1": {"model": "mooney_rivlin", "C10_MPa": 0.7, "C01_MPa": 0.3, "bulk_MPa": 500})",
      R"({"fixed": [{"set": "label_1_cap_low", "axes": "z"}, {"set": "sx", "axes": "x"}, {"set": "sy", "axes": "y"}],
          "moved": [{"set": "label_1_cap_high", "mm": [null, null, 6]}], "increments": 4})");
  fem("bar.vtu --select sx=plane:0,0,0,1,0,0 --select sy=plane:0,0,0,0,1,0 --materials law.json -o bar.inp -o bar.feb "
      "-o bar.bdf");
  rules("bar");
  solve("bar");
  const double s = 1.5;
  expect_answer("reaction bar.frd 12 " + std::to_string(4 * 2 * (s - 1 / (s * s)) * (0.7 + 0.3 / s)) + " 0.01");
}

TEST_F(Fibres, MistakesAreNamed) {
  write_mesh("bar.vtu", block(2, 2, 6, {1, 1, 2}));
  const auto refused = [&](const std::string& material, const std::vector<std::string>& parts) {
    law("\"1\": {" + material + "}", "{}");
    refuses(3, "bar.vtu --materials law.json", parts);
  };
  refused(R"("model": "jelly")", {"label \"1\"", "neo_hooke"});
  refused(R"("model": "neo_hooke", "C10_MPa": 1)", {"no \"bulk_MPa\""});
  refused(R"("model": "neo_hooke", "C10_MPa": 1, "bulk_MPa": 1)", {"two thirds of the shear modulus"});
  refused(kOrthotropic, {"exactly one of \"fibres\" and \"axes\""});
  refused(
      R"("model": "orthotropic", "E_MPa": [1000, 10, 10], "poisson": [0.3, 0.3, 1.2], "G_MPa": [80, 80, 80], "axes": {"fibre": [1, 0, 0], "across": [0, 1, 0]})",
      {"no such material can be"});
  refused(std::string(kOrthotropic) +
              R"(, "fibres": {"from": "label_1_cap_lo", "to": "label_1_cap_high", "along": [1, 0, 0]})",
          {"'label_1_cap_lo'", "label_1_cap_low"});
  refused(std::string(kOrthotropic) +
              R"(, "fibres": {"from": "label_1_outer", "to": "label_1_cap_high", "along": [1, 0, 0]})",
          {"only those of the other set"});
  law(R"("1": {"model": "holzapfel", "C10_MPa": 0.01, "k1_MPa": 0.1, "k2": 5, "bulk_MPa": 10, "axes": {"fibre": [1, 0, 0], "across": [0, 1, 0]}})",
      "{}");
  fem("bar.vtu --materials law.json -o bar.inp -o bar.feb");
  EXPECT_NE(read("fem.log").find("CalculiX has no Holzapfel-Gasser-Ogden material"), std::string::npos)
      << read("fem.log");
  EXPECT_EQ(run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/febio_rules.py' bar.feb", "rules"), 0)
      << read("rules.log");
}

}  // namespace
