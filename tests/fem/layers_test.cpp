// Solver models with layers of wedges: CalculiX finds what is known beforehand, and every deck keeps its format's
// rules.
#include <array>
#include <cmath>
#include <functional>
#include <tuple>

#include "solver.h"

namespace {

class LayerModels : public solver::SolverTest {
 protected:
  /// A label volume about the origin's voxel corner: label(x, y, z) at voxel centres, mm.
  void labels(const std::string& name, std::array<int, 3> size, double spacing_mm, std::array<double, 3> origin,
              const std::function<int(double, double, double)>& label) const {
    const std::string h = std::to_string(spacing_mm);
    std::string text =
        "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: " + std::to_string(size[0]) + " " +
        std::to_string(size[1]) + " " + std::to_string(size[2]) + "\nspace directions: (" + h + ",0,0) (0," + h +
        ",0) (0,0," + h + ")\nspace origin: (" + std::to_string(origin[0]) + "," + std::to_string(origin[1]) + "," +
        std::to_string(origin[2]) + ")\nencoding: raw\nendian: little\n\n";
    for (int k = 0; k < size[2]; ++k)
      for (int j = 0; j < size[1]; ++j)
        for (int i = 0; i < size[0]; ++i)
          text += static_cast<char>(
              label(origin[0] + spacing_mm * i, origin[1] + spacing_mm * j, origin[2] + spacing_mm * k));
    write(name, text);
  }
  void expect_layer_answer(const std::string& arguments) const {
    EXPECT_EQ(run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/layer_answers.py' " + arguments, "answer"),
              0)
        << read("answer.log");
  }
  std::size_t wedges() const { return report().at("volume").at("wedges").get<std::size_t>(); }
  std::size_t pyramids() const { return report().at("volume").at("pyramids").get<std::size_t>(); }
  static constexpr const char* kAsStored = " --no-enhance --band 0 --caps flat --interpolate 0";
};

TEST_F(LayerModels, HollowSphereUnderPressureHasItsStressAtBothSurfaces) {
  NEEDS_CCX();
  labels("sphere.nrrd", {36, 36, 36}, 2, {-35, -35, -35}, [](double x, double y, double z) {
    const double r = std::sqrt(x * x + y * y + z * z);
    return r >= 20 && r <= 30 ? 1 : 0;
  });
  law(R"("1": {"E_MPa": 1000, "poisson": 0.3})",
      R"({"fixed": [{"set": "pz", "axes": "xy"}, {"set": "px", "axes": "yz"}, {"set": "py", "axes": "xz"}], "loaded": [{"set": "inside", "pressure_MPa": 1}]})");
  // Without layers linear tetrahedra miss a third of the stress inside (0.317, 0.177; measured 0.104, 0.047 with them);
  // quadratic ones 0.049, 0.026.
  for (const auto& [order, inner, outer] : {std::tuple(1, "0.13", "0.06"), std::tuple(2, "0.055", "0.032")}) {
    fem("sphere.nrrd --edge-length 4 --order " + std::to_string(order) +
        " --layer 1=2,2 --select pz=sphere:0,0,30,4 --select px=sphere:30,0,0,4 --select py=sphere:0,30,0,4 --select "
        "inside=sphere:0,0,0,25 --materials law.json -o sphere.inp --report r.json");
    EXPECT_GT(wedges(), 1000u);
    EXPECT_NE(read("sphere.inp").find(order == 1 ? "TYPE=C3D6, ELSET=label_1" : "TYPE=C3D15, ELSET=label_1"),
              std::string::npos);
    solve("sphere");
    expect_layer_answer("sphere sphere.frd " + std::string(inner) + " " + outer);
  }
}

TEST_F(LayerModels, AStripBendsAsItMust) {
  NEEDS_CCX();
  labels("strip.nrrd", {64, 16, 12}, 1, {-1.5, -2.5, -3.5},
         [](double x, double y, double z) { return x > 0 && x < 60 && y > 0 && y < 10 && z > 0 && z < 4 ? 1 : 0; });
  law(R"("1": {"E_MPa": 1000, "poisson": 0})",
      R"({"fixed": [{"set": "root"}], "loaded": [{"set": "tip", "force_N": [0, 0, 1]}]})");
  // linear: 0.63 and 0.85 without layers
  for (const auto& [order, tip, stress] : {std::tuple(1, "0.3", "0.65"), std::tuple(2, "0.003", "0.005")}) {
    fem("strip.nrrd" + std::string(kAsStored) + " --axis x --order " + std::to_string(order) +
        " --layer 1=1,2 --select root=plane:0,0,0,1,0,0 --select tip=plane:60,0,0,1,0,0 --materials law.json -o "
        "strip.inp --report r.json");
    EXPECT_GT(wedges(), 500u);
    solve("strip");
    expect_layer_answer("strip strip.frd " + std::string(tip) + " " + stress);
  }
}

TEST_F(LayerModels, PatchTestIsExactButForPyramidsOfSecondOrder) {
  NEEDS_CCX();
  labels("bar.nrrd", {12, 12, 20}, 1, {-1.5, -1.5, -1.5}, [](double x, double y, double z) {
    return x > 0 && x < 8 && y > 0 && y < 8 && z > 0 && z < 16 ? (z < 8 ? 1 : 2) : 0;
  });
  for (const bool two : {false, true})
    for (const int order : {1, 2}) {
      law(R"("*": {"E_MPa": 1000, "poisson": 0.3})",
          R"({"fixed": [{"set": "low", "axes": "z"}, {"set": "side_x", "axes": "x"}, {"set": "side_y", "axes": "y"}],
          "loaded": [{"set": "high", "force_N": [0, 0, 640]}]})");
      fem("bar.nrrd" + std::string(kAsStored) + (two ? "" : " --merge") + " --axis z --order " + std::to_string(order) +
          " --layer 1=1,2 --select low=plane:0,0,0,0,0,1 --select high=plane:0,0,16,0,0,1 --select "
          "side_x=plane:0,0,0,1,0,0 --select side_y=plane:0,0,0,0,1,0 --materials law.json"
          " -o bar.inp -o bar.feb -o bar.bdf --report r.json");
      EXPECT_GT(wedges(), 50u);
      EXPECT_EQ(pyramids() > 0, two);  // where the layer ends at label 2
      solve("bar");
      // CalculiX has no pyramids: of second order they are wedges whose third side is an edge, whose sides do not quite
      // fit those of 10-node tetrahedra.
      expect_layer_answer(two && order == 2 ? "patch bar.frd 1e-4 0.4" : "patch bar.frd 2e-6 0.001");
      for (const char* ending : {"feb", "bdf"})
        EXPECT_EQ(run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/" +
                          std::string(ending[0] == 'f' ? "febio" : "nastran") + "_rules.py' bar." + ending,
                      "rules"),
                  0)
            << read("rules.log");
    }
}

TEST_F(LayerModels, MaterialsFromAnImageReachWedges) {
  labels("bar.nrrd", {12, 12, 20}, 1, {-1.5, -1.5, -1.5},
         [](double x, double y, double z) { return x > 0 && x < 8 && y > 0 && y < 8 && z > 0 && z < 16 ? 1 : 0; });
  labels("image.nrrd", {12, 12, 20}, 1, {-1.5, -1.5, -1.5},
         [](double, double, double z) { return static_cast<int>(std::lround(100 + 5 * z)); });
  write("law.json", R"({"schema": "stackmesh-law-1", "units": {"length": "mm", "force": "N", "stress": "MPa"},
      "laws": {"l": {"source": "a test", "steps": [{"from": "intensity", "to": "modulus", "unit": "MPa", "factor": 10}]}}, "labels": {"1": {"law": "l", "poisson": 0.3}}})");
  const int code =
      run("'" STACKMESH_PROGRAM "' fem bar.nrrd" + std::string(kAsStored) +
              " --axis z --order 1 --layer 1=1,2 --image image.nrrd --materials law.json -o bar.vtu --report r.json",
          "fem");
  ASSERT_EQ(code, 0) << read("fem.log");
  EXPECT_EQ(run("/usr/bin/python3 -c \"import meshio, numpy as np; m = meshio.read('bar.vtu'); "
                "ok = all(np.abs(e - 10 * (100 + 5 * np.array([m.points[c].mean(axis=0)[2] for c in b.data]))).max() < "
                "60 for b, e in zip(m.cells, m.cell_data['modulus_MPa']) if b.type != 'triangle'); "
                "assert ok and any(b.type == 'wedge' for b in m.cells)\"",
                "check"),
            0)
      << read("check.log");
}

TEST_F(LayerModels, WhatCannotBeIsRefused) {
  write(
      "law.json",
      R"({"schema": "stackmesh-law-1", "units": {"length": "mm", "force": "N", "stress": "MPa"}, "labels": {"*": {"E_MPa": 1000, "poisson": 0.3}},
      "load_case": {"fixed": [{"set": "label_1_cap_low"}], "loaded": [{"set": "label_1_cap_high", "force_N": [0, 0, 1]}]}})");
  refuses(2, "'" STACKMESH_TESTDATA "/femur.nii.gz' --layer 1=1,2 --materials law.json --accuracy 5%",
          {"--accuracy cuts tetrahedra, not wedges"});
  fem("'" STACKMESH_TESTDATA "/femur.nii.gz' --edge-length 14 --layer 1=1,1 -o a.vtu");
  refuses(2, "a.vtu --refine 1", {"the mesh has wedges", "--refine"});
  refuses(2, "a.vtu --layer 1=1,1", {"--layer needs the labels"});
  fem("a.vtu -o b.inp --report r.json");  // given as a mesh they stay
  EXPECT_GT(wedges(), 1000u);
  EXPECT_EQ(report().at("fem").at("elements").get<std::size_t>(),
            wedges() + report().at("volume").at("tets").get<std::size_t>());
}

}  // namespace
