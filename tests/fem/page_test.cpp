// docs/fem.md is run, and its schema of law files says what the program says.
#include "base/error.h"
#include "fem/material_law.h"
#include "solver.h"

using namespace stackmesh;

namespace {

class FemPage : public solver::SolverTest {};

TEST_F(FemPage, FiguresAreThoseOfARun) {
  const int code = run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/fem_page.py' '" STACKMESH_SOURCE_DIR
                       "' '" STACKMESH_PROGRAM "' '" STACKMESH_SHARED_DATA "/torso_totalseg'",
                       "page");
  if (code == 77 || code == 127) GTEST_SKIP() << "NOT TESTED: " << read("page.log");
  EXPECT_EQ(code, 0) << read("page.log");
}

TEST_F(FemPage, SchemaAndProgramTakeAndRefuseTheSame) {
  const std::string head =
      R"({"schema": "stackmesh-law-1", "units": {"length": "mm", "force": "N", "stress": "MPa"}, "labels": )";
  const std::string linear = R"({"*": {"E_MPa": 5, "poisson": 0.3}})";
  std::vector<std::string> laws;
  const auto material = [&](const std::string& m) { laws.push_back(head + R"({"1": )" + m + "}}"); };
  const auto acts = [&](const std::string& l) { laws.push_back(head + linear + R"(, "load_case": )" + l + "}"); };
  const auto contact = [&](const std::string& c) { laws.push_back(head + linear + R"(, "contact": [)" + c + "]}"); };
  laws.push_back(head + linear + "}");
  laws.push_back(head + linear + R"(, "mapping": {"binning": "logarithmic", "bins": 20}})");
  laws.push_back(head + linear + R"(, "mapping": {"binning": "random"}})");
  laws.push_back(head + linear + R"(, "extra": 1})");
  laws.push_back(R"({"schema": "stackmesh-law-1", "labels": {}})");
  material(R"({"E_MPa": 5})");
  material(R"({"E_MPa": -5, "poisson": 0.3})");
  material(R"({"E_MPa": 5, "poisson": 0.5})");
  material(R"({"law": "keller1994"})");
  material(R"({"model": "neo_hooke", "C10_MPa": 1, "bulk_MPa": 100, "density_t_mm3": 1e-9})");
  material(R"({"model": "neo_hooke", "C10_MPa": 1})");
  material(R"({"model": "mooney_rivlin", "C10_MPa": 1, "C01_MPa": 0.1, "bulk_MPa": 100})");
  material(
      R"({"model": "mooney_rivlin", "C10_MPa": 1, "C01_MPa": 0.1, "bulk_MPa": 100, "axes": {"fibre": [1, 0, 0], "across": [0, 1, 0]}})");
  material(
      R"({"model": "orthotropic", "E_MPa": [3, 2, 1], "poisson": [0, 0, 0], "G_MPa": [1, 1, 1], "axes": {"fibre": [1, 0, 0], "across": [0, 1, 0]}})");
  material(R"({"model": "orthotropic", "E_MPa": [3, 2, 1], "poisson": [0, 0, 0], "G_MPa": [1, 1, 1]})");
  material(
      R"({"model": "holzapfel", "C10_MPa": 1, "k1_MPa": 1, "k2": 1, "bulk_MPa": 9, "fibres": {"from": "a", "to": "b", "along": [0, 0, 1]}})");
  material(
      R"({"model": "holzapfel", "C10_MPa": 1, "k1_MPa": 1, "k2": 1, "kappa": 0.5, "bulk_MPa": 9, "fibres": {"from": "a", "to": "b", "along": [0, 0, 1]}})");
  acts("{}");
  acts(R"({"fixed": []})");
  acts(
      R"({"fixed": [{"set": "a", "axes": "xz"}], "moved": [{"set": "b", "mm": [null, 1, 0]}], "loaded": [{"set": "c", "force_N": [1, 2, 3], "moment_Nmm": [1, 0, 0]}]})");
  acts(R"({"fixed": [{"set": "a", "axes": "w"}]})");
  acts(R"({"fixed": [{"axes": "x"}]})");
  acts(R"({"loaded": [{"set": "c", "force_N": [1, 2, 3], "pressure_MPa": 1}]})");
  acts(R"({"loaded": [{"set": "c"}]})");
  acts(R"({"gravity_mm_s2": [0, 0, -9810], "large_displacements": true, "increments": 4})");
  acts(R"({"gravity_mm_s2": [0, -9810]})");
  acts(R"({"increments": 0})");
  acts(
      R"({"points": [{"name": "P", "set": "a", "mm": [0, 0, 0]}], "loaded": [{"point": "P", "moment_Nmm": [1, 0, 0]}], "fixed": [{"point": "P", "rotations": "xy"}]})");
  acts(R"({"points": [{"name": "P", "set": "a"}]})");
  acts(R"({"points": [{"name": "P", "set": "a", "mm": [0, 0, 0], "coupling": "loose"}]})");
  acts(R"({"springs": [{"set": "a", "N_per_mm": [1, 0, 0]}, {"set": "b", "MPa_per_mm": 2}]})");
  acts(R"({"springs": [{"set": "a", "N_per_mm": [1, 0, 0], "MPa_per_mm": 2}]})");
  acts(R"({"steps": [{"name": "one", "fixed": [{"set": "a"}]}, {"type": "frequency", "modes": 3}]})");
  acts(R"({"steps": [{"type": "explicit"}]})");
  contact(R"({"parts": ["A", "B"], "type": "contact", "friction": 0.1, "stiffness_MPa_mm": 5, "stabilise": 0.001})");
  contact(R"({"parts": ["A", "B"], "type": "contact", "stabilise": 2})");
  contact(R"({"parts": ["A"], "type": "tie"})");
  std::string names, said;
  for (std::size_t i = 0; i < laws.size(); ++i) {
    names += " '" + write("law" + std::to_string(i) + ".json", laws[i]) + "'";
    try {
      read_law(at("law" + std::to_string(i) + ".json"));
      said += "valid\n";
    } catch (const Error&) {
      said += "invalid\n";
    }
  }
  for (const char* name : {"femur_law.json", "femur_ct_law.json"}) {
    names += std::string(" '" STACKMESH_TESTDATA "/") + name + "'";
    said += "valid\n";
  }
  ASSERT_EQ(run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/law_schema.py' '" STACKMESH_SOURCE_DIR
                "/docs/law.schema.json'" +
                    names,
                "schema"),
            0)
      << read("schema.log");
  std::istringstream lines(read("schema.log")), ours(said);
  std::size_t i = 0;
  for (std::string line, mine; std::getline(ours, mine); ++i) {
    ASSERT_TRUE(std::getline(lines, line));
    EXPECT_EQ(line.substr(0, line.find(':')), mine) << line << "\n" << (i < laws.size() ? laws[i] : "testdata");
  }
  std::size_t refused = 0;
  for (std::size_t at = said.find("invalid"); at != std::string::npos; at = said.find("invalid", at + 1)) ++refused;
  EXPECT_GT(refused, 15u);
  EXPECT_GT(i - refused, 12u);
}

}  // namespace
