// `fem --accuracy`: stress out of displacements, errors estimated, meshes refined until they are small.
#include <cmath>

#include "base/error.h"
#include "blocks.h"
#include "fem/estimate_error.h"
#include "fem/recover_stress.h"
#include "meshio/read_frd.h"
#include "solver.h"
#include "volume/raise_order.h"

using namespace stackmesh;
using blocks::block;

namespace {

class AccuracyTest : public solver::SolverTest {};

SolverModel model_of(TetMesh mesh, double young_mpa, double poisson) {
  SolverModel model;
  ElementMaterial m{"M", 1, young_mpa, poisson, 0, {}, MaterialKind::linear, {}};
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) m.tets.push_back(static_cast<std::int32_t>(t));
  model.sets.materials.push_back(m);
  FaceSet end;
  end.name = "end";
  NodeSet nodes;
  nodes.name = "end";
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (int f = 0; f < 4; ++f) {
      bool there = true;
      for (const int k : kTetFaces[f]) there = there && mesh.points[mesh.tets[t][k]].x == 2;
      if (there) end.faces.push_back({static_cast<std::int32_t>(t), f});
    }
  for (std::size_t n = 0; n < mesh.points.size(); ++n)
    if (mesh.points[n].x == 2) nodes.nodes.push_back(static_cast<std::int32_t>(n));
  model.sets.surfaces.push_back(end);
  model.sets.node_sets.push_back(nodes);
  model.mesh = std::move(mesh);
  return model;
}

TetMesh two_cells(int order) {
  TetMesh mesh = block(2, 2, 2, {1, 1, 1}, [](int, int, int) { return 1; });
  return order == 1 ? mesh : raise_order(std::move(mesh), {}).mesh;
}

TEST(RecoverStress, LinearDisplacementIsAUniformStressWithoutError) {
  for (const int order : {1, 2}) {
    const SolverModel model = model_of(two_cells(order), 1000, 0.25);
    std::vector<Vec3> u;  // 0.001 along x, free across it, and a shear of 0.002 in xy
    for (const Vec3 p : model.mesh.points) u.push_back({0.001 * p.x + 0.002 * p.y, -0.00025 * p.y, -0.00025 * p.z});
    const StressMeasure m = recover_stress(model, u);
    ASSERT_EQ(m.sets.size(), 1u);
    const double expected = std::sqrt(1 + 3 * 0.8 * 0.8);  // 1 MPa, and G = 400 MPa times 0.002
    EXPECT_NEAR(m.sets[0].mises_rms_mpa, expected, 1e-9) << order;
    EXPECT_NEAR(m.sets[0].mises_max_mpa, expected, 1e-9);
    EXPECT_NEAR(m.sets[0].displacement_max_mm, norm(Vec3{0.006, -0.0005, -0.0005}), 1e-12);
    EXPECT_LT(m.zz_rel, 1e-7);
  }
}

TEST(RecoverStress, BendingIsExactInSecondOrderAndHasAnErrorInFirst) {
  double error[3] = {0, 0, 0};
  for (const int order : {1, 2}) {
    const SolverModel model = model_of(two_cells(order), 1000, 0);
    std::vector<Vec3> u;  // pure bending about z: stress along x is 2 (y - 1) MPa
    for (const Vec3 p : model.mesh.points) u.push_back({0.002 * p.x * (p.y - 1), -0.001 * p.x * p.x, 0});
    const StressMeasure m = recover_stress(model, u);
    error[order] = m.zz_rel;
    if (order == 2) {
      EXPECT_NEAR(m.sets[0].mises_max_mpa, 2, 1e-9);
    }
  }
  EXPECT_LT(error[2], 1e-7);
  EXPECT_GT(error[1], 0.2);
}

TEST(EstimateError, RichardsonFindsTheLimitOfAGeometricSequence) {
  std::vector<StressMeasure> measures(3);
  for (int k = 0; k < 3; ++k) {  // 10 + 4^-k: order 2
    measures[k].mises_rms_mpa = 10;
    measures[k].sets = {{"a", 10 + std::pow(0.25, k), 12, 0.5, 0, false}, {"held", std::pow(2, k), 12, 0.5, 0, true}};
  }
  const Accuracy three = estimate_error(measures, 1);
  EXPECT_NEAR(three.sets[0].mises_extrapolated_mpa, 10, 1e-12);
  EXPECT_NEAR(three.sets[0].order, 2, 1e-12);
  EXPECT_NEAR(three.error_rel, 0.0625 / 10, 1e-12);
  EXPECT_EQ(three.worst_set, "a");  // what is held does not count
  measures.pop_back();
  EXPECT_NEAR(estimate_error(measures, 2).sets[0].mises_extrapolated_mpa, 10, 1e-12);
}

TEST(EstimateError, WhatGrowsWithoutEndHasALargeError) {
  std::vector<StressMeasure> measures(3);
  for (int k = 0; k < 3; ++k) measures[k].sets = {{"a", std::pow(2, k), 12, 0.5, 0, false}};
  EXPECT_GT(estimate_error(measures, 2).error_rel, 0.3);
}

TEST_F(AccuracyTest, CantileverIsRefinedUntilItIsAccurateAndTheReportSaysSo) {
  NEEDS_CCX();
  write_mesh("m.vtu", block(8, 2, 2, {1, 1, 1}, [](int, int, int) { return 1; }));
  law(R"("*": {"E_MPa": 1000, "poisson": 0})",
      R"({"fixed": [{"set": "left"}], "loaded": [{"set": "right", "force_N": [0, 1, 0]}]})");
  const std::string sets =
      "m.vtu --select left=plane:0,0,0,1,0,0 --select right=plane:8,0,0,1,0,0 --materials law.json --report r.json ";
  fem(sets + "--accuracy 5% --order 1 -o one.inp");
  nlohmann::json a = report()["fem"]["accuracy"];
  EXPECT_FALSE(a["reached"]) << a;
  EXPECT_EQ(a["elements"], (std::vector<int>{192, 1536, 12288}));
  EXPECT_NE(read("fem.log").find("was not reached"), std::string::npos) << read("fem.log");
  EXPECT_EQ(places_of("accuracy"), std::vector<std::string>{"set " + a["worst_set"].get<std::string>()});
  fem(sets + "--accuracy 5% --order 2 -o two.inp");
  a = report()["fem"]["accuracy"];
  EXPECT_TRUE(a["reached"]) << a;
  EXPECT_LE(a["error_rel"], 0.05);
  EXPECT_EQ(report()["fem"]["elements"], a["elements"].back());  // the deck is the last mesh's
  const double bent = 1.0 * 8 * 8 * 8 / (3 * 1000 * (2.0 * 2 * 2 * 2 / 12)), sheared = 1.2 * 8 / (500.0 * 4);
  for (const auto& s : a["sets"]) {
    if (s["set"] != "right") continue;
    EXPECT_NEAR(double(s["displacement_max_mm"].back()) / (bent + sheared), 1, 0.02);
  }
  EXPECT_NE(read("fem.log").find("accuracy  "), std::string::npos);
}

TEST_F(AccuracyTest, WarningsOfAGivenMeshNameItsFile) {
  write_mesh("m.vtu", block(2, 2, 2, {1, 1, 1}, [](int, int, int) { return 1; }));
  fem("m.vtu --order 2 -o two.vtu");
  fem("two.vtu --order 1 --report r.json -o one.inp");
  EXPECT_EQ(places_of("element_order"), std::vector<std::string>{"two.vtu"});
}

TEST_F(AccuracyTest, RefusalsComeBeforeAnythingIsMeshed) {
  write_mesh("m.vtu", block(2, 2, 2, {1, 1, 1}, [](int, int, int) { return 1; }));
  law(R"("*": {"E_MPa": 1000, "poisson": 0})",
      R"({"fixed": [{"set": "left"}], "loaded": [{"set": "right", "force_N": [0, 1, 0]}]})");
  refuses(2, "m.vtu --materials law.json --accuracy 0%", {"accuracy"});
  refuses(2, "m.vtu --materials law.json --accuracy much", {"--accuracy"});
  EXPECT_EQ(run("PATH=/nowhere '" STACKMESH_PROGRAM "' fem m.vtu --materials law.json --accuracy 5% -o x.inp", "fem"),
            2);
  EXPECT_NE(read("fem.log").find("no ccx in PATH"), std::string::npos) << read("fem.log");
  if (!has_ccx()) return;
  refuses(2, "m.vtu --accuracy 5%", {"load case"});
}

TEST_F(AccuracyTest, ResultFilesThatAreCutOffAreRefused) {
  write("a.frd",
        "    1C\n    2C                             1\n -1         1 1.00000E+00 2.00000E+00 3.00000E+00\n -3\n"
        " -4  DISP        4    1\n -5  D1          1    2    1    0\n -1         1 1.00000E-01-2.00000E-01 "
        "0.00000E+00\n -3\n 9999\n");
  const FrdResult r = read_frd(at("a.frd"));
  EXPECT_EQ(r.numbers, std::vector<std::int64_t>{1});
  EXPECT_EQ(r.fields.at("DISP")[0][1], -0.2);
  const std::string whole = read("a.frd");
  for (const std::size_t at_byte : {std::size_t{0}, std::size_t{60}, whole.size() - 6}) {
    write("b.frd", whole.substr(0, at_byte));
    EXPECT_THROW(read_frd(at("b.frd")), Error) << at_byte;
  }
}

}  // namespace
