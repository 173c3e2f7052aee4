// Materials: laws, mapping against an independent computation, margins, floors, bins; and what is refused.
#include <cmath>
#include <functional>
#include <set>

#include "base/error.h"
#include "blocks.h"
#include "fem/assign_materials.h"
#include "fem/name_sets.h"
#include "model/space.h"
#include "solver.h"
#include "volume/raise_order.h"

using namespace stackmesh;
using blocks::block;

namespace {

constexpr const char* kHead =
    R"({"schema": "stackmesh-law-1", "units": {"length": "mm", "force": "N", "stress": "MPa"}, )";
constexpr const char* kCalibration =
    R"("calibration": {"intensity": "HU", "density": "g/cm3", "slope": 0.001, "intercept": 0.1}, )";
/// E = 1000 * rho, with rho straight from the calibration.
constexpr const char* kLinear =
    R"("laws": {"line": {"steps": [{"from": "qct_density", "to": "E", "unit": "MPa", "factor": 1000}]}}, )";

class Materials : public solver::SolverTest {
 protected:
  MaterialPlan plan(const std::string& text) const { return read_law(write("law.json", text)); }
  void law_is_refused(const std::string& text, const std::vector<std::string>& parts) const {
    try {
      plan(text);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::input);
      const std::string what = e.what();
      EXPECT_EQ(what.find('\n'), std::string::npos);
      for (const std::string& p : parts)
        EXPECT_NE(what.find(p), std::string::npos) << "'" << p << "' is not in: " << what;
    }
  }
};

/// A grid of 1 mm voxels over [-5, 15]^3 with a field given at world positions.
IntensityVolume image_of(const std::function<double(Vec3)>& field) {
  IntensityVolume v;
  v.size = {20, 20, 20};
  v.origin_mm = {-4.5, -4.5, -4.5};
  for (int k = 0; k < 20; ++k)
    for (int j = 0; j < 20; ++j)
      for (int i = 0; i < 20; ++i) v.values.push_back(static_cast<float>(field(v.world(i, j, k))));
  return v;
}

TEST_F(Materials, KnownLawsGiveTheirPublishedValues) {
  const MaterialPlan p =
      plan(std::string(kHead) + kCalibration + R"("labels": {"1": {"law": "morgan2003_femoral_neck", "poisson": 0.3},
      "2": {"law": "keller1994", "poisson": 0.3}}})");
  const double qct = 0.001 * 800 + 0.1, ash = 0.877 * qct + 0.079;
  EXPECT_NEAR(p.laws.at("morgan2003_femoral_neck").at(800).young_mpa, 6850 * std::pow(ash / 0.6, 1.49), 1e-6);
  EXPECT_NEAR(p.laws.at("morgan2003_femoral_neck").at(800).density_t_mm3, ash / 0.6 * 1e-9, 1e-18);
  EXPECT_NEAR(p.laws.at("keller1994").at(800).young_mpa, 10500 * std::pow(ash, 2.29), 1e-6);
  EXPECT_EQ(p.laws.at("keller1994").at(-5000).young_mpa, 0);
}

TEST_F(Materials, UnitsOfTheCalibrationAreTurned) {
  const auto modulus = [&](const std::string& calibration) {
    return plan(std::string(kHead) + "\"calibration\": {\"intensity\": \"HU\", " + calibration +
                R"(}, "labels": {"*": {"law": "keller1994", "poisson": 0.3}}})")
        .laws.at("keller1994")
        .at(500)
        .young_mpa;
  };
  const double meant = modulus(R"("density": "g/cm3", "slope": 0.001, "intercept": 0.1)");
  EXPECT_NEAR(modulus(R"("density": "mg/cm3", "slope": 1, "intercept": 100)"), meant, 1e-9 * meant);
  EXPECT_NEAR(modulus(R"("density": "kg/m3", "slope": 1, "intercept": 100)"), meant, 1e-9 * meant);
  const MaterialPlan own = plan(std::string(kHead) + kCalibration + R"("laws": {"gpa": {"steps": [
      {"from": "qct_density", "to": "rho", "unit": "mg/cm3", "factor": 1000},
      {"from": "rho", "to": "E", "unit": "GPa", "pieces": [{"up_to": 300, "factor": 0.001}, {"factor": 1e-6, "exponent": 2, "offset": 0.21}]}]}},
      "labels": {"*": {"law": "gpa", "poisson": 0.3}}})");
  EXPECT_NEAR(own.laws.at("gpa").at(100).young_mpa, 200, 1e-9);                // 200 mg/cm3, first piece
  EXPECT_NEAR(own.laws.at("gpa").at(900).young_mpa, 1000 * (1 + 0.21), 1e-9);  // 1000 mg/cm3, second piece
}

TEST_F(Materials, BadLawsAreRefusedInOneLineThatSaysWhere) {
  const std::string labels = R"("labels": {"1": {"E_MPa": 1, "poisson": 0.3}}})", head = kHead;
  law_is_refused("{", {"no JSON", "law.json"});
  law_is_refused("[]", {"{ }"});
  law_is_refused("{}", {"schema"});
  law_is_refused(R"({"schema": "stackmesh-law-1", )" + labels, {"units", "MPa"});
  law_is_refused(R"({"schema": "stackmesh-law-1", "units": {"length": "m", "force": "N", "stress": "Pa"}, )" + labels,
                 {"length is not mm"});
  law_is_refused(R"({"schema": "stackmesh-law-1", "units": {"length": "mm", "force": "N"}, )" + labels,
                 {"\"stress\"", "units"});
  law_is_refused(
      head + R"("calibration": {"intensity": "HU", "density": "g/cm3", "slope": -0.001, "intercept": 0}, )" + labels,
      {"slope is not above 0"});
  law_is_refused(head + R"("calibration": {"intensity": "HU", "slope": 0.001, "intercept": 0}, )" + labels,
                 {"\"density\"", "calibration"});
  law_is_refused(
      head + R"("calibration": {"intensity": "HU", "density": "furlong", "slope": 0.001, "intercept": 0}, )" + labels,
      {"furlong"});
  law_is_refused(head + R"("labels": {"1": {"E_MPa": 0, "poisson": 0.3}}})", {"not above 0", "label \"1\""});
  law_is_refused(head + R"("labels": {"1": {"E_MPa": 5}}})", {"poisson"});
  law_is_refused(head + R"("labels": {"1": {"E_MPa": 5, "poisson": 0.5}}})", {"Poisson"});
  law_is_refused(head + R"("labels": {"1": {"poisson": 0.3}}})", {"exactly one"});
  law_is_refused(head + R"("labels": {"1": {"law": "none", "poisson": 0.3}}})", {"unknown law \"none\"", "keller1994"});
  law_is_refused(head + R"("labels": {"1": {"law": "keller1994", "poisson": 0.3}}})", {"needs a \"calibration\""});
  law_is_refused(head + R"("labels": {"1": {"E_MPa": 5, "poisson": 0.3, "colour": 3}}})", {"unknown entry \"colour\""});
  law_is_refused(head + R"("labels": {"1": {"E_MPa": 5, "poisson": 0.3, "density_t_mm3": 1.9}}})", {"t/mm3"});
  law_is_refused(
      head + kCalibration +
          R"("laws": {"a": {"steps": [{"from": "qct_density", "to": "rho", "unit": "g/cm3", "factor": 1}]}}, )" +
          labels,
      {"last step"});
  law_is_refused(
      head + kCalibration + R"("laws": {"a": {"steps": [{"from": "qct_density", "to": "E", "factor": 1}]}}, )" + labels,
      {"\"unit\"", "step 1"});
  law_is_refused(head + kCalibration + kLinear +
                     R"("labels": {"1": {"law": "line", "poisson": 0.3, "floor_MPa": 5, "ceiling_MPa": 4}}})",
                 {"ceiling"});
  law_is_refused(head + R"("load_case": {"loaded": [{"set": "a"}]}, )" + labels, {"force_N"});
  EXPECT_THROW(read_law("/nowhere/law.json"), Error);
}

TEST_F(Materials, LinearFieldIsIntegratedExactlyInsideAndNearlyAtTheBorder) {
  const IntensityVolume image = image_of([](Vec3 p) { return 300 + 20 * p.x - 11 * p.y + 7 * p.z; });
  const MaterialPlan p =
      plan(std::string(kHead) + kCalibration + kLinear + R"("labels": {"1": {"law": "line", "poisson": 0.3}}})");
  for (const bool second : {false, true}) {
    TetMesh mesh = block(4, 4, 4, {2, 2, 2});
    if (second) mesh = raise_order(mesh).mesh;
    SolverModel m = name_sets(mesh, {}, {});
    const MaterialReport r = assign_materials(m, &p, &image);
    std::size_t inner = 0;
    for (std::size_t t = 0; t < m.mesh.tets.size(); ++t) {
      Vec3 c;
      bool at_border = false;
      for (const std::int32_t v : m.mesh.tets[t]) {
        const Vec3 q = m.mesh.points[v];
        c = c + 0.25 * q;
        at_border = at_border || std::min({q.x, q.y, q.z}) < 1 || std::max({q.x, q.y, q.z}) > 7;
      }
      // At the border the last voxel's value is continued over half a voxel.
      EXPECT_NEAR(m.sets.modulus_mpa[t], 1000 * (0.001 * (300 + 20 * c.x - 11 * c.y + 7 * c.z) + 0.1),
                  at_border ? 10 : 0.02);
      inner += at_border ? 0 : 1;
    }
    EXPECT_EQ(inner, 8u * 6);
    EXPECT_NEAR(r.labels[0].young_mean_mpa, 1000 * (0.001 * (300 + 16 * 4) + 0.1), 1);
    EXPECT_EQ(r.labels[0].voxels, 512u);
  }
}

TEST_F(Materials, AverageOfTheModulusIsNotTheModulusOfTheAverage) {
  // A checkerboard of 1 mm cells, 0 or 1000 HU, under a square law.
  const IntensityVolume image = image_of([](Vec3 p) {
    return 1000.0 * (static_cast<int>(std::floor(p.x) + std::floor(p.y) + std::floor(p.z) + 100) % 2);
  });
  const std::string law =
      std::string(kHead) +
      R"("calibration": {"intensity": "HU", "density": "g/cm3", "slope": 0.001, "intercept": 0}, "laws": {"sq": {"steps": [
      {"from": "qct_density", "to": "E", "unit": "MPa", "factor": 1000, "exponent": 2}]}}, "mapping": {"average": ")";
  SolverModel a = name_sets(block(2, 2, 2, {4, 4, 4}), {}, {}), b = name_sets(block(2, 2, 2, {4, 4, 4}), {}, {});
  const std::string end = R"("}, "labels": {"1": {"law": "sq", "poisson": 0.3}}})";
  const MaterialPlan field = plan(law + "modulus" + end), mean = plan(law + "intensity" + end);
  const double e_field = assign_materials(a, &field, &image).labels[0].young_mean_mpa;
  const double e_mean = assign_materials(b, &mean, &image).labels[0].young_mean_mpa;
  EXPECT_NEAR(e_mean, 250, 15);  // (0.5 g/cm3)^2
  // Linear between voxel centres: the mean of the square is 1/4 + 1/4 * (1/3)^3 of the full contrast's.
  EXPECT_NEAR(e_field, 1000 * (0.25 + 0.25 / 27), 5);
  EXPECT_GT(e_field, 1.015 * e_mean);
}

TEST_F(Materials, OnlyVoxelsOfTheLabelSpeakForIt) {
  // The block [0, 8]^3 is 500 HU, its outermost voxel layer 900 (partial volume), the outside -1000.
  const IntensityVolume image = image_of([](Vec3 p) {
    const double inside = std::min({p.x, p.y, p.z, 8 - p.x, 8 - p.y, 8 - p.z});
    return inside < 0 ? -1000.0 : inside < 1 ? 900.0 : 500.0;
  });
  const std::string law = std::string(kHead) + kCalibration + kLinear + R"("mapping": {"erode_px": )";
  const auto moduli = [&](int erode) {
    SolverModel m = name_sets(block(4, 4, 4, {2, 2, 2}), {}, {});
    const MaterialPlan p =
        plan(law + std::to_string(erode) + R"(}, "labels": {"1": {"law": "line", "poisson": 0.3}}})");
    assign_materials(m, &p, &image);
    return m.sets.modulus_mpa;
  };
  for (const double e : moduli(0)) {
    EXPECT_GE(e, 600 - 1e-6);  // never the outside's
    EXPECT_LE(e, 1000 + 1e-6);
  }
  // the layer is taken off, and the inside continued to the border
  for (const double e : moduli(1)) EXPECT_NEAR(e, 600, 1e-3);
}

TEST_F(Materials, FloorsAndCeilingsAreCountedAndAMissingFloorNamesTheElement) {
  const IntensityVolume image = image_of([](Vec3 p) { return p.x < 4 ? -400.0 : 2000.0; });
  SolverModel m = name_sets(block(2, 2, 2, {4, 4, 4}), {{1, "femur"}}, {});
  const std::string law =
      std::string(kHead) + kCalibration + kLinear + R"("labels": {"femur": {"law": "line", "poisson": 0.3)";
  MaterialPlan p = plan(law + R"(, "floor_MPa": 10, "ceiling_MPa": 1500}}})");
  const MaterialReport r = assign_materials(m, &p, &image);
  EXPECT_NEAR(r.labels[0].clamped_low + r.labels[0].clamped_high, 1, 0.51);
  EXPECT_GT(r.labels[0].clamped_low, 0.2);
  EXPECT_GT(r.labels[0].clamped_high, 0.2);
  EXPECT_EQ(r.labels[0].young_min_mpa, 10);
  EXPECT_EQ(r.labels[0].young_max_mpa, 1500);
  p = plan(law + "}}}");
  try {
    assign_materials(m, &p, &image);
    ADD_FAILURE() << "a negative modulus was accepted";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("element "), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("femur"), std::string::npos);
    EXPECT_NE(std::string(e.what()).find("floor_MPa"), std::string::npos);
  }
}

TEST_F(Materials, BinsHoldEveryElementOnceAndKeepTheMean) {
  const IntensityVolume image = image_of([](Vec3 p) { return 100 + 60 * p.x + 30 * p.y * p.z; });
  for (const char* how : {"equal_count", "equal_modulus"}) {
    SolverModel m = name_sets(block(4, 4, 4, {2, 2, 2}), {}, {});
    const MaterialPlan p =
        plan(std::string(kHead) + kCalibration + kLinear + R"("mapping": {"bins": 20, "binning": ")" + how +
             R"("}, "labels": {"1": {"law": "line", "poisson": 0.3}}})");
    const MaterialReport r = assign_materials(m, &p, &image);
    EXPECT_LE(r.labels[0].materials, 20u);
    EXPECT_GT(r.labels[0].materials, 5u);
    std::set<std::int32_t> seen;
    double binned = 0, exact = 0;
    for (const ElementMaterial& b : m.sets.materials) {
      EXPECT_FALSE(b.tets.empty());
      for (const std::int32_t t : b.tets) {
        EXPECT_TRUE(seen.insert(t).second);
        binned += b.young_mpa;  // all elements have the same volume
        exact += m.sets.modulus_mpa[t];
        EXPECT_LE(std::abs(b.young_mpa / m.sets.modulus_mpa[t] - 1), r.labels[0].bin_error_rel + 1e-12);
      }
    }
    EXPECT_EQ(seen.size(), m.mesh.tets.size());
    EXPECT_NEAR(binned / exact, 1, 1e-12);
  }
}

TEST_F(Materials, LogarithmicBinsKeepEveryElementWithinHalfABin) {
  // 10 to 20,000 MPa, most of it soft, a few elements hard: what bins of equal count get wrong by more than half.
  const IntensityVolume image = image_of([](Vec3 p) {
    return p.x < 6.5 ? 10 + 3 * p.y + 0.7 * p.z * p.z
                     : 10 * std::pow(10, 0.55 * (p.x - 6)) * (1 + 0.1 * p.y) * (1 + 0.05 * p.z);
  });
  const auto bins = [&](const std::string& mapping) {
    SolverModel m = name_sets(block(8, 8, 8, {1, 1, 1}), {}, {});
    const MaterialPlan p =
        plan(std::string(kHead) +
             R"("laws": {"line": {"steps": [{"from": "grey", "to": "E", "unit": "MPa", "factor": 1}]}}, )" + mapping +
             R"("labels": {"1": {"law": "line", "poisson": 0.3, "ceiling_MPa": 20000}}})");
    const MaterialReport r = assign_materials(m, &p, &image);
    double worst = 0;
    std::set<std::int32_t> seen;
    for (const ElementMaterial& b : m.sets.materials)
      for (const std::int32_t t : b.tets) {
        EXPECT_TRUE(seen.insert(t).second);
        worst = std::max(worst, std::abs(b.young_mpa / m.sets.modulus_mpa[t] - 1));
      }
    EXPECT_EQ(seen.size(), m.mesh.tets.size());
    EXPECT_NEAR(r.labels[0].bin_error_rel, worst, 1e-12);
    EXPECT_GT(r.labels[0].young_max_mpa / r.labels[0].young_min_mpa, 10);
    return std::make_pair(worst, std::log(r.labels[0].young_max_mpa / r.labels[0].young_min_mpa));
  };
  const auto [by_default, range] = bins("");
  EXPECT_LT(by_default, 0.02);
  EXPECT_LE(by_default, std::tanh(range / 400) * 1.000001);  // half a bin of 200
  const auto [coarse, same_range] = bins(R"("mapping": {"bins": 20}, )");
  EXPECT_LE(coarse, std::tanh(same_range / 40) * 1.000001);
  EXPECT_GT(coarse, by_default);
  EXPECT_GT(bins(R"("mapping": {"bins": 20, "binning": "equal_count"}, )").first, 0.1);
}

TEST_F(Materials, RasMeshesMeetTheSameVoxels) {
  const IntensityVolume image = image_of([](Vec3 p) { return 300 + 20 * p.x - 11 * p.y; });
  const MaterialPlan p =
      plan(std::string(kHead) + kCalibration + kLinear + R"("labels": {"1": {"law": "line", "poisson": 0.3}}})");
  SolverModel lps = name_sets(block(2, 2, 2, {4, 4, 4}), {}, {}), ras = lps;
  change_space(ras.mesh, Space::ras);
  ASSERT_EQ(ras.mesh.points[0].x, -lps.mesh.points[0].x);
  assign_materials(lps, &p, &image);
  assign_materials(ras, &p, &image);
  for (std::size_t t = 0; t < lps.sets.modulus_mpa.size(); ++t)
    EXPECT_NEAR(lps.sets.modulus_mpa[t], ras.sets.modulus_mpa[t], 1e-6);
}

TEST_F(Materials, MappedModuliAgreeWithNearestVoxelSumsOnAnObliqueLeftHandedCt) {
  const std::string oracle = "/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/map_oracle.py' ";
  const int made = run(oracle + "make .", "make");
  if (made == 77 || made == 127) GTEST_SKIP() << "NOT TESTED: needs /usr/bin/python3 with numpy, nibabel and VTK";
  ASSERT_EQ(made, 0) << read("make.log");
  write(
      "law.json",
      std::string(kHead) +
          R"("calibration": {"intensity": "HU", "density": "g/cm3", "slope": 0.001, "intercept": 0.05}, "laws": {"neck": {"steps": [
      {"from": "qct_density", "to": "E", "unit": "MPa", "factor": 6850, "exponent": 1.49}]}}, "labels": {"*": {"law": "neck", "poisson": 0.3}}})");
  for (const char* order : {"1", "2"}) {
    fem(std::string("labels.nii.gz --edge-length 5 --image ct.nii.gz --materials law.json --order ") + order +
        " -o model.vtu");
    EXPECT_EQ(run(oracle + "check model.vtu ct.nii.gz 0.001 0.05", "check"), 0) << read("check.log");
  }
}

class BadInput : public solver::SolverTest {
 protected:
  void SetUp() override {
    SolverTest::SetUp();
    write_mesh("block.vtu", block(2, 2, 2, {4, 4, 4}, [](int i, int, int) { return i + 1; }));
  }
  std::string law(const std::string& labels) const {
    return write("law.json", std::string(kHead) + kCalibration + kLinear + "\"labels\": {" + labels + "}}");
  }
};

TEST_F(BadInput, IsOneClearLineAndLeavesNothing) {
  law(R"("1": {"E_MPa": 5, "poisson": 0.3}, "7": {"E_MPa": 5, "poisson": 0.3})");
  refuses(3, "block.vtu --materials law.json", {"label '7'", "not in the mesh", "label_2"});
  law(R"("1": {"E_MPa": 5, "poisson": 0.3})");
  refuses(3, "block.vtu --materials law.json", {"label 2", "no material"});
  refuses(3, "block.vtu --select a=box:50,50,50,60,60,60", {"selection 'a' is empty", "nearest"});
  refuses(2, "block.vtu --select a=ball:1,1,1", {"unknown criterion"});
  refuses(3, "block.vtu --select a=in:label_1_oter", {"set 'label_1_oter'", "the nearest are label_1_outer, "});
  refuses(3, "block.vtu --parts A=1 B=9", {"label '9'", "--parts 9"});
  refuses(3, "block.vtu --skin 9=0.3", {"label '9'", "--skin 9"});
  refuses(2, "block.vtu --parts A", {"NAME=LABELS"});
  refuses(2, "block.vtu --skin 1=0", {"not above 0"});
  refuses(3, "block.vtu --skin 1=0.3 --materials " + law(R"("*": {"E_MPa": 5, "poisson": 0.3})"),
          {"skin", "no material"});
  refuses(2, "block.vtu --image ct.nii.gz", {"--materials"});
  law(R"("*": {"law": "line", "poisson": 0.3})");
  refuses(2, "block.vtu --materials law.json", {"no image"});
  refuses(3, "block.vtu --materials law.json --image nowhere.nii.gz", {"does not exist"});
  refuses(3, "nothing.vtu", {"nothing.vtu"});
}

TEST_F(BadInput, SetsOfALoadCaseThatAreNotThereNameTheNearest) {
  const auto fixed = [&](const std::string& set) {
    return write("law.json", std::string(kHead) +
                                 R"("labels": {"*": {"E_MPa": 5, "poisson": 0.3}}, "load_case": {"fixed": [{"set": ")" +
                                 set + "\"}]}}");
  };
  fixed("label_2_cap_lo");
  refuses(3, "block.vtu --materials law.json",
          {"'label_2_cap_lo', which the model does not have", "the nearest are label_2_cap_low, "});
  TetMesh wedge = block(2, 2, 2, {4, 4, 4});
  for (Vec3& p : wedge.points) p.z += 0.4 * p.x;  // no end is level
  write_mesh("wedge.vtu", wedge);
  fixed("label_1_cap_high");
  refuses(3, "wedge.vtu --materials law.json", {"label 1 has no flat high end", "--caps flat", "--select"});
}

TEST_F(BadInput, MistakesAreToldBeforeAnythingIsMeshed) {
  const std::string labels = "'" STACKMESH_TESTDATA "/femur.nii.gz' --progress plain -o refused.inp ";
  const auto early = [&](int code, const std::string& arguments, const std::string& part) {
    EXPECT_EQ(run("'" STACKMESH_PROGRAM "' fem " + labels + arguments, "fem"), code) << read("fem.log");
    EXPECT_NE(read("fem.log").find(part), std::string::npos) << read("fem.log");
    EXPECT_EQ(read("fem.log").find("contours "), std::string::npos) << read("fem.log");
  };
  law(R"("*": {"E_MPa": 5, "poisson": 0.3}, "7": {"E_MPa": 5, "poisson": 0.3})");
  early(3, "--materials law.json", "label '7', which is not in the mesh");
  law(R"("1": {"E_MPa": 5, "poisson": 0.3})");
  early(3, "--materials law.json", "label 2 (label_2)");
  law(R"("*": {"law": "line", "poisson": 0.3})");
  early(2, "--materials law.json", "no image");
  early(3, "--parts A=1 B=9", "--parts 9");
  early(3, "--skin 9=1", "--skin 9");
  early(2, "--select a=ball:1,1,1", "unknown criterion");
  early(3, "--select a=of:5", "label '5'");
  early(3, "--select a=points:nowhere.mrk.json,5", "nowhere.mrk.json");
}

TEST_F(BadInput, ElementsInsideOutAreListed) {
  TetMesh mesh = block(2, 2, 2, {4, 4, 4});
  std::swap(mesh.tets[4][2], mesh.tets[4][3]);
  std::swap(mesh.tets[11][2], mesh.tets[11][3]);
  stackmesh::AtomicFiles files;
  mesh.faces.clear();
  write_mesh("bad.vtu", mesh);
  refuses(3, "bad.vtu", {"2 of 48 elements", "not positive", "elements 5, 12"});
}

TEST_F(BadInput, ImageThatDoesNotOverlapTheMesh) {
  const int made = run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/map_oracle.py' make .", "make");
  if (made != 0) GTEST_SKIP() << "NOT TESTED: needs /usr/bin/python3 with numpy, nibabel and VTK";
  TetMesh far = block(2, 2, 2, {4, 4, 4});
  for (Vec3& p : far.points) p = p + Vec3{500, 0, 0};
  write_mesh("far.vtu", far);
  law(R"("*": {"law": "line", "poisson": 0.3})");
  refuses(3, "far.vtu --materials law.json --image ct.nii.gz", {"does not overlap the mesh", "label 1"});
}

TEST_F(BadInput, NamesFileAndGivenMeshReachTheDecks) {
  write("names.ctbl", "1 Inner 1 2 3 255\n2 inner 1 2 3 255\n");
  fem("block.vtu --names names.ctbl --order 1 --parts A=1 B=2 --skin 1=0.3 -o m.inp -o m.feb -o m.msh -o m.bdf -o "
      "m.vtu --report r.json");
  EXPECT_NE(read("m.inp").find("ELSET=inner_2"), std::string::npos);
  EXPECT_NE(read("m.inp").find("*SURFACE, NAME=contact_A_B"), std::string::npos);
  EXPECT_NE(read("m.feb").find("<SurfacePair name=\"pair_A_B\">"), std::string::npos);
  EXPECT_NE(read("m.msh").find("\"contact_B_A\""), std::string::npos);
  EXPECT_NE(read("m.bdf").find("nodes of contact_A_B"), std::string::npos);
  for (const char* deck : {"m.inp", "m.feb", "m.bdf"})
    EXPECT_NE(read(deck).find("mm, N, MPa, t/mm3"), std::string::npos) << deck;
  EXPECT_EQ(run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/decks.py' m.feb", "feb"), 0)
      << read("feb.log");
  const auto f = report().at("fem");
  EXPECT_EQ(f.at("nodes"), 27 + 9);
  EXPECT_EQ(f.at("shells"), 2 * (4 + 4 * 2));
  EXPECT_EQ(f.at("placeholder_materials"), true);
}

}  // namespace
