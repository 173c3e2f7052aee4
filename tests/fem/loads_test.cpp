// Loads, points, springs and steps of the law file: CalculiX runs the decks unedited and finds what is known
// beforehand.
#include <cmath>

#include "blocks.h"
#include "solver.h"

using namespace stackmesh;
using blocks::block;

namespace {

class Loads : public solver::SolverTest {
 protected:
  /// A bar of 2 x 2 x 12 mm along z, E = 1000 MPa, Poisson's ratio 0 (so that beam theory is exact), and a law file
  /// with this load case.
  void bar(const std::string& load_case, const std::string& name, int order = 2) const {
    write_mesh("bar.vtu", block(2, 2, 6, {1, 1, 2}));
    law(R"("1": {"E_MPa": 1000, "poisson": 0, "density_t_mm3": 1e-7})", load_case);
    fem("bar.vtu --materials law.json --report r.json --order " + std::to_string(order) + " -o " + name + ".inp -o " +
        name + ".feb -o " + name + ".bdf");
    rules(name);
  }
  /// The other decks keep the rules of their formats.
  void rules(const std::string& name) const {
    EXPECT_EQ(run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/febio_rules.py' " + name + ".feb", "rules"),
              0)
        << read("rules.log");
    EXPECT_EQ(
        run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/nastran_rules.py' " + name + ".bdf", "rules"), 0)
        << read("rules.log");
  }
  /// An eighth of a hollow sphere, radii 10 and 20 mm, its cut faces on the planes x, y, z = 0, loaded from inside.
  void sphere(int n, const std::string& material, double pressure, const std::string& more) const {
    TetMesh mesh = block(n, n, n, {1, 1, 1}, [n](int i, int j, int k) { return std::max({i, j, k}) >= n / 2 ? 1 : 0; });
    for (Vec3& p : mesh.points) {
      const double cube = std::max({p.x, p.y, p.z});
      if (cube > 0) p = (20.0 * cube / n / norm(p)) * p;
    }
    write_mesh("sphere.vtu", mesh);
    law("\"1\": " + material,
        R"({"fixed": [{"set": "sx", "axes": "x"}, {"set": "sy", "axes": "y"}, {"set": "sz", "axes": "z"}],
        "loaded": [{"set": "inside", "pressure_MPa": )" +
            std::to_string(pressure) + "}]" + more + "}");
    fem("sphere.vtu --materials law.json --select sx=plane:0,0,0,1,0,0 --select sy=plane:0,0,0,0,1,0 --select "
        "sz=plane:0,0,0,0,0,1"
        " --select inside=sphere:0,0,0,12 -o sphere.inp -o sphere.feb -o sphere.bdf");
    rules("sphere");
    EXPECT_NE(read("sphere.inp").find("*DSLOAD\ninside, P, "), std::string::npos);
    solve("sphere");
  }
};

constexpr double kEi = 1000 * 16.0 / 12;

TEST_F(Loads, CantileverBendsUnderItsOwnWeight) {
  NEEDS_CCX();
  bar(R"({"fixed": [{"set": "label_1_cap_low"}], "gravity_mm_s2": [9810, 0, 0]})", "weight");
  solve("weight");
  const double q = 1e-7 * 9810 * 4, bent = q * std::pow(12, 4) / (8 * kEi), sheared = q * 144 / (2 * 500 * 4 * 5.0 / 6);
  expect_answer("end weight.frd 12 " + std::to_string(bent + sheared) + " 0 0 0.01");
}

TEST_F(Loads, MomentsOfASetAPointAndADistributingPointBendTheBarToTheSameArc) {
  NEEDS_CCX();
  const std::string end = std::to_string(10 * 144 / (2 * kEi));  // M L^2 / 2 E I
  const std::string held = R"({"fixed": [{"set": "label_1_cap_low"}], )";
  const std::string point = R"("points": [{"name": "P", "set": "label_1_cap_high", "mm": [1, 1, 12], "coupling": ")";
  bar(held + R"("loaded": [{"set": "label_1_cap_high", "moment_Nmm": [0, 10, 0]}]})", "of_set");
  bar(held + point + R"(rigid"}], "loaded": [{"point": "P", "moment_Nmm": [0, 10, 0]}]})", "rigid");
  bar(held + point + R"(distributing"}], "loaded": [{"point": "P", "moment_Nmm": [0, 10, 0]}]})", "spread");
  bar(held + point + R"(rigid"}], "moved": [{"point": "P", "rad": [null, 0.09, null]}]})", "turned");  // M L / E I
  // A force beside the axis: 5 N at 2 mm is a moment of 10 Nmm, and stretches the bar.
  bar(held +
          R"("points": [{"name": "P", "set": "label_1_cap_high", "mm": [-1, 1, 12], "coupling": "distributing"}], "loaded": [{"point": "P", "force_N": [0, 0, 5]}]})",
      "beside");
  for (const char* name : {"of_set", "rigid", "spread", "turned"}) {
    solve(name);
    expect_answer(std::string("end ") + name + ".frd 12 " + end + " 0 0 1e-4");
  }
  solve("beside");
  expect_answer("end beside.frd 12 " + end + " 0 " + std::to_string(5.0 * 12 / 4000) + " 1e-3");
}

TEST_F(Loads, RefiningComesCloserToTheAnswer) {
  NEEDS_CCX();
  write_mesh("bar.vtu", block(2, 2, 6, {1, 1, 2}));
  law(R"("1": {"E_MPa": 1000, "poisson": 0})",
      R"({"fixed": [{"set": "label_1_cap_low"}], "loaded": [{"set": "label_1_cap_high", "moment_Nmm": [0, 10, 0]}]})");
  double before = 1e9;
  for (const int times : {0, 1, 2}) {
    const std::string name = "refined" + std::to_string(times);
    fem("bar.vtu --materials law.json --order 1 --refine " + std::to_string(times) + " --report r.json -o " + name +
        ".inp");
    EXPECT_EQ(report().at("fem").at("elements").get<std::size_t>(), std::size_t{144} << (3 * times));
    solve(name);
    run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/fem_answers.py' end " + name + ".frd 12 " +
            std::to_string(10 * 144 / (2 * kEi)) + " 0 0 1e-4",
        "answer");
    const std::string text = read("answer.log"), what = "worst difference ";
    const double off = std::stod(text.substr(text.find(what) + what.size()));
    EXPECT_LT(off, 0.6 * before) << times;
    before = off;
  }
  EXPECT_LT(before, 0.2 * 0.54);
}

TEST_F(Loads, LargeDisplacementsRollTheBarToACircle) {
  NEEDS_CCX();
  bar(R"({"fixed": [{"set": "label_1_cap_low"}], "large_displacements": true, "increments": 5,
          "points": [{"name": "P", "set": "label_1_cap_high", "mm": [1, 1, 12]}], "loaded": [{"point": "P", "moment_Nmm": [0, 50, 0]}]})",
      "roll");
  EXPECT_NE(read("roll.inp").find("*STEP, NLGEOM"), std::string::npos);
  solve("roll");
  EXPECT_EQ(read("ccx.log").find("WARNING"), std::string::npos) << read("ccx.log");
  const double turn = 50 * 12 / kEi, radius = 12 / turn;
  expect_answer("end roll.frd 12 " + std::to_string(radius * (1 - std::cos(turn))) + " 0 " +
                std::to_string(radius * std::sin(turn) - 12) + " 0.01");
}

TEST_F(Loads, SpringsAndAFoundationGiveWayByTheLoadOverTheirStiffness) {
  NEEDS_CCX();
  const std::string load = R"(], "loaded": [{"set": "label_1_cap_high", "force_N": [0, 0, -40]}]})";
  for (const int order : {1, 2}) {
    const std::string name = std::to_string(order), deep = std::to_string(-40 / 200.0 - 10 * 12 / 1000.0);
    bar(R"({"springs": [{"set": "label_1_cap_low", "N_per_mm": [50, 50, 200]})" + load, "springs" + name, order);
    // A foundation of 50 MPa/mm on 4 mm2 is 200 N/mm, along z only: softer springs keep the bar from sliding.
    bar(R"({"springs": [{"set": "label_1_cap_low", "MPa_per_mm": 50}, {"set": "label_1_cap_low", "N_per_mm": [1, 1, 0]})" +
            load,
        "foundation" + name, order);
    for (const std::string kind : {"springs", "foundation"}) {
      solve(kind + name);
      expect_answer("end " + kind + name + ".frd 12 0 0 " + deep + " 1e-4");
      expect_answer("end " + kind + name + ".frd 0 0 0 -0.2 1e-4");
    }
  }
}

TEST_F(Loads, PressurisedSphereWidensAsLameSays) {
  NEEDS_CCX();
  sphere(6, R"({"E_MPa": 1000, "poisson": 0.3})", 10, "");
  const double a = 10, b = 20, a3 = a * a * a, b3 = b * b * b;
  expect_answer("sphere sphere.frd 10 " +
                std::to_string(10 * a3 / (b3 - a3) * (0.4 * a / 1000 + 1.3 * b3 / (2 * 1000 * a * a))) + " 0.015");
}

TEST_F(Loads, PressureFollowsASphereOfRubberThatItInflates) {
  NEEDS_CCX();
  // Incompressible neo-Hookean shell: p = mu / 2 (f(outer) - f(inner)), f = stretch^-4 + 4 / stretch. A force that
  // stayed as it was at the beginning would widen it far less, since the inner face grows by 1.69.
  const double stretch = 1.3, outer = std::cbrt(1 + (stretch * stretch * stretch - 1) / 8);
  const auto f = [](double s) { return std::pow(s, -4) + 4 / s; };
  const double mu = 2, pressure = mu / 2 * (f(outer) - f(stretch));
  sphere(4, R"({"model": "neo_hooke", "C10_MPa": 1, "bulk_MPa": 500})", pressure, R"(, "increments": 5)");
  EXPECT_NE(read("sphere.inp").find("*HYPERELASTIC, NEO HOOKE\n1, 0.004\n"), std::string::npos);
  expect_answer("sphere sphere.frd 10 3 0.06");
}

TEST_F(Loads, NaturalFrequencyOfAClampedBar) {
  NEEDS_CCX();
  write_mesh("long.vtu", block(2, 2, 20, {1, 1.5, 2}));
  law(R"("1": {"E_MPa": 1000, "poisson": 0, "density_t_mm3": 1e-9})",
      R"({"fixed": [{"set": "label_1_cap_low"}], "steps": [{"type": "frequency", "modes": 3}]})");
  fem("long.vtu --materials law.json -o long.inp -o long.feb -o long.bdf");
  rules("long");
  EXPECT_EQ(read("long.bdf").find("SOL 103"), read("long.bdf").find("SOL "));
  solve("long");
  const double section = 6, inertia = 3 * 8 / 12.0;  // about the weak axis
  const double first =
      std::pow(1.8751, 2) / (2 * M_PI) * std::sqrt(1000 * inertia / (1e-9 * section * std::pow(40, 4)));
  expect_answer("frequency long.dat " + std::to_string(first) + " 0.015");
}

TEST_F(Loads, EachStepSaysAllThatActsInIt) {
  NEEDS_CCX();
  bar(R"({"fixed": [{"set": "label_1_cap_low"}], "steps": [
          {"name": "pull", "loaded": [{"set": "label_1_cap_high", "force_N": [0, 0, 40]}], "gravity_mm_s2": [9810, 0, 0]},
          {"name": "press", "loaded": [{"set": "label_1_cap_high", "pressure_MPa": 5}]}]})",
      "steps");
  const auto steps = report().at("fem").at("load_case").at("steps");
  ASSERT_EQ(steps.size(), 2u);
  EXPECT_NEAR(steps[1].at("force_n")[2].get<double>(), -20, 1e-9);
  solve("steps");
  // the last step: no pull, no weight
  expect_answer("end steps.frd 12 0 0 " + std::to_string(-5 * 12 / 1000.0) + " 1e-4");
}

TEST_F(Loads, BodiesThatNothingHoldsAreNamed) {
  // A bar, and a crumb beside it.
  write_mesh("crumb.vtu", block(8, 2, 6, {1, 1, 2}, [](int i, int j, int k) {
               return i < 2 ? 1 : i == 7 && j == 0 && k == 5 ? 1 : 0;
             }));
  const std::string material = R"("1": {"E_MPa": 1000, "poisson": 0.3})";
  law(material,
      R"({"fixed": [{"set": "label_1_cap_low"}], "loaded": [{"set": "label_1_cap_high", "force_N": [0, 0, -40]}]})");
  refuses(3, "crumb.vtu --materials law.json",
          {"1 of 2 bodies are not supported", "label 1 (label_1) of 6 elements and 2 mm3 at (7.5, 0.5, 11), loaded",
           "--min-piece"});
  // Without a load case they are listed, the crumb after the bar.
  law(material, "{}");
  fem("crumb.vtu --materials law.json --report r.json --report r.html -o crumb.inp");
  const auto bodies = report().at("fem").at("bodies");
  ASSERT_EQ(bodies.size(), 2u);
  EXPECT_EQ(bodies[1].at("elements"), 6);
  EXPECT_NEAR(bodies[1].at("volume_mm3").get<double>(), 2, 1e-9);
  EXPECT_NE(read("fem.log").find("label 1 (label_1), 6 elements, 2 mm3 at (7.5, 0.5, 11)"), std::string::npos)
      << read("fem.log");
  EXPECT_NE(read("r.html").find("a load case must hold each of them"), std::string::npos);
  write_mesh("bar.vtu", block(2, 2, 6, {1, 1, 2}));
  const auto with = [&](const std::string& load_case) { law(material, load_case); };
  const std::string loaded = R"("loaded": [{"set": "label_1_cap_high", "force_N": [0, 0, -40]}]})";
  with("{" + loaded);
  refuses(3, "bar.vtu --materials law.json", {"not supported"});
  with(R"({"fixed": [], )" + loaded);
  refuses(3, "bar.vtu --materials law.json", {"\"fixed\" is an empty list"});
  with(R"({"fixed": [{"set": "label_1_cap_low", "axes": "z"}], )" + loaded);
  refuses(3, "bar.vtu --materials law.json", {"not supported"});
  with(R"({"fixed": [{"set": "label_1_cap_low", "axes": "z"}, {"set": "side", "axes": "x"}], )" + loaded);
  refuses(3, "bar.vtu --select side=plane:0,0,0,1,0,0 --materials law.json",
          {"not supported", "it can move along (0, 1, 0)"});
  // Held in one plane only: it turns about what is left.
  with(R"({"fixed": [{"set": "label_1_cap_low", "axes": "xy"}, {"set": "label_1_cap_high", "axes": "z"}], )" + loaded);
  fem("bar.vtu --materials law.json -o held.inp");
  // Tied and rubbing parts count; a part that only slides does not.
  write_mesh("two.vtu", block(2, 2, 4, {1, 1, 1}, [](int, int, int k) { return k < 2 ? 1 : 2; }));
  const std::string two =
      R"({"fixed": [{"set": "label_1_cap_low"}], "loaded": [{"set": "label_2_cap_high", "force_N": [0, 0, -40]}]})";
  law(R"("*": {"E_MPa": 1000, "poisson": 0.3})", two);
  fem("two.vtu --parts A=1 B=2 --materials law.json -o tied.inp");
  refuses(3, "two.vtu --parts A=1 B=2 --contact contact --materials law.json",
          {"1 of 2 bodies", "label 2", "friction"});
  law(R"("*": {"E_MPa": 1000, "poisson": 0.3})", two,
      R"("contact": [{"parts": ["A", "B"], "type": "contact", "friction": 0.1}], )");
  fem("two.vtu --parts A=1 B=2 --contact contact --materials law.json -o rubbing.inp");
  // Springs hold, and a frequency step needs no support, but densities.
  with(R"({"springs": [{"set": "label_1_outer", "MPa_per_mm": 1}], )" + loaded);
  fem("bar.vtu --materials law.json -o springs.inp");
  with(R"({"steps": [{"type": "frequency"}]})");
  refuses(3, "bar.vtu --materials law.json", {"density", "label 1"});
}

TEST_F(Loads, MistakesOfALoadCaseAreNamed) {
  write_mesh("bar.vtu", block(2, 2, 6, {1, 1, 2}));
  const auto refused = [&](const std::string& load_case, const std::vector<std::string>& parts) {
    law(R"("1": {"E_MPa": 1000, "poisson": 0.3})", load_case);
    refuses(3, "bar.vtu --materials law.json", parts);
  };
  const std::string fixed = R"({"fixed": [{"set": "label_1_cap_low"}], )";
  refused(fixed + R"("gravity_mm_s2": [0, 0, -9.81]})", {"9806.65 mm/s2"});
  refused(fixed + R"("gravity_mm_s2": [0, 0, -9810]})", {"density", "label 1"});
  refused(fixed + R"("loaded": [{"point": "P", "force_N": [1, 0, 0]}]})", {"point \"P\" is not in \"points\""});
  refused(fixed + R"("points": [{"name": "P", "set": "label_1_cap_hi", "mm": [0, 0, 0]}]})",
          {"'label_1_cap_hi'", "label_1_cap_high"});
  refused(fixed + R"("points": [{"name": "P", "set": "label_1_cap_low", "mm": [0, 0, 0]}]})", {"bound to point 'P'"});
  refused(
      fixed +
          R"("points": [{"name": "P", "set": "label_1_cap_high", "mm": [0, 0, 0], "coupling": "distributing"}], "moved": [{"point": "P", "mm": [1, 0, 0]}]})",
      {"distributing", "cannot be held or moved"});
  refused(fixed + R"("steps": [{"type": "frequency", "loaded": [{"set": "label_1_cap_high", "force_N": [1, 0, 0]}]}]})",
          {"a frequency step has no loads"});
  refused(fixed + R"("steps": [{"type": "dynamic"}]})", {"step 1", "neither"});
  refused(fixed + R"("springs": [{"set": "label_1_cap_high", "N_per_mm": [0, 0, 0]}]})",
          {"negative, or 0 along all axes"});
}

}  // namespace
