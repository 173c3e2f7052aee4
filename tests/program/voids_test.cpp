// --void: a label that bounds the others and is not filled.
#include <cmath>
#include <sstream>

#include "program.h"

namespace program {
namespace {

class Voids : public ProgramTest {
 protected:
  /// A .cnt file of squares with that half side, one every 5 mm.
  std::string squares(const std::string& name, double half, int from, int to) const {
    std::ostringstream text;
    text << "S " << to - from + 1 << "\n";
    for (int k = from; k <= to; ++k)
      text << "v 4 z " << 5 * k << "\n{\n"
           << -half << ' ' << -half << "\n"
           << half << ' ' << -half << "\n"
           << half << ' ' << half << "\n"
           << -half << ' ' << half << "\n}\n";
    return write(name, text.str());
  }
  /// A block of 40 x 40 x 30 mm, and a hollow of 20 x 20 in it.
  std::vector<std::string> drawn(int from, int to) const {
    return {"1=" + squares("wall.cnt", 20, 0, 6), "2=" + squares("hollow.cnt", 10, from, to)};
  }
  static std::vector<std::string> with(std::vector<std::string> head, const std::vector<std::string>& inputs,
                                       const std::vector<std::string>& tail) {
    head.insert(head.end(), inputs.begin(), inputs.end());
    head.insert(head.end(), tail.begin(), tail.end());
    return head;
  }
  static double number(const Json& r, int label, const char* field) { return row(r, label).at(field).get<double>(); }
  static std::size_t faces(const Json& r, const std::string& set) {
    for (const Json& s : r.at("fem").at("sets"))
      if (s.at("name") == set) return s.at("faces");
    return 0;
  }
};

TEST_F(Voids, AHollowIsClosedAndEmpty) {
  succeeds(with({"mesh"}, drawn(2, 4), {"--void", "2", "-o", out("a.vtu"), "--report", out("R.json")}));
  const Json r = report();
  EXPECT_EQ(r.at("volume").at("closure"), "verified");
  EXPECT_EQ(row(r, 1).at("void"), false);
  EXPECT_EQ(row(r, 2).at("void"), true);
  EXPECT_EQ(row(r, 2).at("closed"), true);
  EXPECT_TRUE(row(r, 2).at("tets").is_null());
  EXPECT_EQ(row(r, 1).at("components"), 1);
  EXPECT_NEAR(number(r, 2, "surface_volume_mm3"), 20 * 20 * 10, 0.005 * 4000);
  EXPECT_NEAR(number(r, 1, "tet_volume_mm3"), 40 * 40 * 30 - 20 * 20 * 10, 0.005 * 44000);
  EXPECT_NEAR(number(r, 1, "tet_volume_mm3"), number(r, 1, "surface_volume_mm3"), 1e-6);
  EXPECT_EQ(r.at("volume").at("tets"), row(r, 1).at("tets"));
}

TEST_F(Voids, EveryFormatIsValidAgainstTheLabelsWithTheVoid) {
  const std::vector<std::string> inputs = drawn(2, 6);
  std::vector<std::string> outputs = {"--void", "2"};
  for (const char* name : {"a.vtu", "a.vtk", "a.msh", "a.inp", "a.mesh", "a.bdf", "a.feb", "a.vtp", "a.ply", "a.off"})
    outputs.insert(outputs.end(), {"-o", out(name)});
  succeeds(with({"mesh"}, inputs, outputs));
  for (const char* name : {"a.vtu", "a.vtk", "a.msh", "a.inp", "a.mesh", "a.vtp", "a.ply", "a.off"}) {
    succeeds(with({"validate", out(name), "--against"}, inputs, {"--void", "2", "--report", out("R.json")}));
    const Json r = report();
    ASSERT_EQ(r.at("labels").size(), 1u) << name;
    EXPECT_NEAR(number(r, 1, "surface_volume_mm3"), 40 * 40 * 30 - 20 * 20 * 20, 0.005 * 40000) << name;
    EXPECT_EQ(row(r, 1).at("genus"), 0) << name;  // a cup
  }
  EXPECT_NE(read_file(out("a.inp")).find("S_label_1_label_2"), std::string::npos);  // the wall by itself
}

TEST_F(Voids, PressureActsOnTheWallAlone) {
  // A cup: of the pressure on its inner wall the floor's share is left.
  const std::string law = write(
      "law.json",
      R"({"schema": "stackmesh-law-1", "units": {"length": "mm", "force": "N", "stress": "MPa", "density": "t/mm3"},
    "labels": {"*": {"E_MPa": 1, "poisson": 0.3, "density_t_mm3": 1e-9}},
    "load_case": {"fixed": [{"set": "label_1_cap_low"}], "loaded": [{"set": "label_1_inner_2", "pressure_MPa": 0.1}]}})");
  for (const std::vector<std::string>& how : {std::vector<std::string>{"--void", "2"},
                                              {"--label", "1", "--keep-sets", "2"},
                                              {"--void", "2", "--order", "1", "--refine", "1"}}) {
    std::vector<std::string> tail = how;
    tail.insert(tail.end(), {"--materials", law, "-o", out("a.inp"), "--report", out("R.json")});
    succeeds(with({"fem"}, drawn(2, 6), tail));
    const Json r = report();
    const Json force = r.at("fem").at("load_case").at("force_n");
    EXPECT_NEAR(force.at(2).get<double>(), -0.1 * 20 * 20, 0.2);
    EXPECT_NEAR(force.at(0).get<double>(), 0, 0.2);
    EXPECT_GT(faces(r, "label_1_inner_2"), 100u);
    EXPECT_GT(faces(r, "label_1_cap_high"), 20u);
    EXPECT_EQ(row(r, 2).at("closed"), true);
  }
  // The mesh file knows its void.
  succeeds(with({"mesh"}, drawn(2, 6), {"--void", "2", "-o", out("b.vtu")}));
  succeeds({"fem", out("b.vtu"), "--materials", law, "-o", out("b.inp"), "--report", out("R.json")});
  EXPECT_NEAR(report().at("fem").at("load_case").at("force_n").at(2).get<double>(), -40, 0.2);
}

TEST_F(Voids, OfALabelVolumeAreWhatTheyWouldBeFilled) {
  const std::string file = testdata("femur.nii.gz");
  succeeds({"mesh", file, "--edge-length", "5", "-o", out("a.vtu"), "--report", out("R.json")});
  const Json filled = report();
  succeeds({"mesh", file, "--edge-length", "5", "--void", "2", "-o", out("a.vtu"), "--report", out("R.json")});
  const Json hollow = report();
  // Points of the surface may move for the worst tets, which a void has not: a thousandth of a volume at most.
  for (int label : {1, 2})
    EXPECT_NEAR(number(hollow, label, "surface_volume_mm3") / number(filled, label, "surface_volume_mm3"), 1, 1e-3)
        << label;
  EXPECT_NEAR(number(hollow, 1, "tet_volume_mm3") / number(filled, 1, "tet_volume_mm3"), 1, 1e-3);
  EXPECT_TRUE(row(hollow, 2).at("tet_volume_mm3").is_null());
  EXPECT_GT(number(hollow, 2, "dice"), 0.99);
}

TEST_F(Voids, StayApartWhereTheOthersAreMerged) {
  // The wall in two halves, side by side, and a hollow in both.
  const auto beside = [&](const std::string& name, double x0, double x1) {
    std::ostringstream text;
    text << "S 7\n";
    for (int k = 0; k <= 6; ++k)
      text << "v 4 z " << 5 * k << "\n{\n" << x0 << " -20\n" << x1 << " -20\n" << x1 << " 20\n" << x0 << " 20\n}\n";
    return write(name, text.str());
  };
  const std::vector<std::string> halves = {"3=" + beside("left.cnt", -20, 0), "1=" + beside("right.cnt", 0, 20),
                                           "2=" + squares("hollow.cnt", 10, 2, 4)};
  succeeds(with({"mesh"}, halves, {"--void", "2", "--merge", "-o", out("a.vtu"), "--report", out("R.json")}));
  const Json r = report();
  ASSERT_EQ(r.at("labels").size(), 2u);
  EXPECT_EQ(row(r, 2).at("void"), true);
  EXPECT_EQ(row(r, 1).at("components"), 1);
  EXPECT_NEAR(number(r, 1, "tet_volume_mm3"), 40 * 40 * 30 - 20 * 20 * 10, 0.005 * 44000);
  EXPECT_NEAR(number(r, 2, "surface_volume_mm3"), 20 * 20 * 10, 0.005 * 4000);
  // Voxels: the other labels of a heart become one beside a void.
  succeeds({"surface", testdata("heart4.nii.gz"), "--raw", "-o", out("a.vtp"), "--report", out("R.json")});
  const Json apart = report();
  const int first = apart.at("labels")[0].at("label"), last = apart.at("labels").back().at("label");
  succeeds({"surface", testdata("heart4.nii.gz"), "--raw", "--merge", "--void", std::to_string(last), "-o",
            out("a.vtp"), "--report", out("R.json")});
  const Json merged = report();
  ASSERT_EQ(merged.at("labels").size(), 2u);
  double sum = 0;
  for (const Json& l : apart.at("labels"))
    if (l.at("label") != last) sum += l.at("input_volume_mm3").get<double>();
  EXPECT_NEAR(number(merged, first, "input_volume_mm3"), sum, 1e-6);
  EXPECT_NEAR(number(merged, last, "input_volume_mm3"), number(apart, last, "input_volume_mm3"), 1e-6);
}

TEST_F(Voids, AreAskedForInVain) {
  fails(2, with({"mesh"}, drawn(2, 4), {"--void", "1,2", "-o", out("a.vtu")}), {"every label is a void"});
  fails(3, with({"mesh"}, drawn(2, 4), {"--void", "7", "-o", out("a.vtu")}),
        {"label '7' is not in the input", "--void 7"});
  fails(2, {"validate", out("a.vtu"), "--void", "2"}, {"--against"});
}

}  // namespace
}  // namespace program
