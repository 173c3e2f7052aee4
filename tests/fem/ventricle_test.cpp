// A left ventricle from drawn contours: its cavity a void, its wall of rubber, pressed from inside until it is at rest.
#include "solver.h"

namespace {

class Ventricle : public solver::SolverTest {};

TEST_F(Ventricle, IsInflatedThroughItsVoid) {
  const std::string data = STACKMESH_SHARED_DATA "/heart_sax_sunnybrook/SC-HF-I-2/";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "NOT TESTED: " << data << " is not there";
  NEEDS_CCX();
  write("names.txt", "1 wall 200 0 0 255\n2 cavity 0 0 200 255\n");
  law(R"("wall": {"model": "neo_hooke", "C10_MPa": 0.02, "bulk_MPa": 0.4, "density_t_mm3": 1.06e-9})",
      R"({"fixed": [{"set": "wall_cap_high"}], "loaded": [{"set": "wall_inner_cavity", "pressure_MPa": 0.00133}], "increments": 5})");
  fem("'1=" + data + "epi_ED.cnt' '2=" + data +
      "endo_ED.cnt' --void cavity --names names.txt --edge-min 6 --edge-max 12 --order 1 --materials law.json --report "
      "r.json -o lv.inp -o lv.feb");
  const nlohmann::json r = report();
  for (const nlohmann::json& label : r.at("labels")) EXPECT_EQ(label.at("genus"), 0) << label;
  for (const nlohmann::json& v : r.at("verdicts")) EXPECT_NE(v.at("status"), "fail") << v;
  solve("lv");
  const std::string steps = read("lv.sta");
  EXPECT_NE(steps.rfind("0.100000E+01  0.100000E+01"), std::string::npos) << steps;  // the whole load
  // Pressure on a cup is held by its rim: its opening times the pressure.
  const double force = -r.at("fem").at("load_case").at("force_n").at(2).get<double>();
  EXPECT_NEAR(force / 0.00133, 3565, 60);  // mm2
  expect_answer("hung lv.frd " + std::to_string(force) + " 2 5");
}

}  // namespace
