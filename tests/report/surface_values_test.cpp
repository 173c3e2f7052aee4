// What the page colours a solver model's surface by.
#include "report/surface_values.h"

#include <gtest/gtest.h>

using namespace stackmesh;

namespace {

/// Two tets on one face; the first one's outer faces are one set, one of them a set of its own, too.
SolverModel model() {
  SolverModel m;
  m.mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  m.mesh.tets = {{0, 1, 2, 3}, {1, 2, 3, 4}};
  m.mesh.labels = {1, 2};
  m.sets.surfaces = {{"outer", "", {{0, 0}, {0, 1}, {0, 3}}}, {"small", "", {{0, 0}}}};
  m.sets.node_sets = {{"outer", "", {0, 1, 2, 3}}, {"small", "", {0, 1, 2}}};
  m.sets.modulus_mpa = {10, 1000};
  LoadStep step;
  step.supports.push_back({"small", {0, 0, 0}});
  step.pressures.push_back({"outer", 1});
  m.sets.steps.push_back(step);
  return m;
}

const InterfaceComplex kSurface = {{{0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}},
                                   {{{0, 1, 2}, 1, 0}, {{1, 2, 3}, 1, 0}}};

TEST(SurfaceValues, AFaceShowsItsSmallestSetAndAllThatActs) {
  const SurfaceValues all = surface_values(model(), {});
  const std::vector<TriangleValues> v = values_on(kSurface, all);
  ASSERT_EQ(v.size(), 2u);
  EXPECT_EQ(all.sets.at(v[0].set - 1), "small");
  EXPECT_EQ(all.sets.at(v[1].set - 1), "outer");
  EXPECT_EQ(v[0].acts, 3);  // held, and pressed as a part of the other set
  EXPECT_EQ(v[1].acts, 2);
  EXPECT_EQ(v[0].modulus, 1);  // the smallest
  EXPECT_EQ(all.modulus_high_mpa, 1000);
  EXPECT_EQ(v[0].mises, 0);  // unknown
}

TEST(SurfaceValues, StressIsTheMeanOfTheCorners) {
  const SurfaceValues all = surface_values(model(), {0, 0, 3, 6, 12});
  const std::vector<TriangleValues> v = values_on(kSurface, all);
  EXPECT_EQ(all.mises_high_mpa, 12);
  EXPECT_EQ(v[0].mises, 1 + 21);  // 1 of 12 MPa
  EXPECT_EQ(v[1].mises, 1 + 42);
}

TEST(SurfaceValues, ASurfaceThatIsNotTheModelsHasNone) {
  InterfaceComplex other = kSurface;
  for (Vec3& p : other.points) p.x += 0.5;
  EXPECT_TRUE(values_on(other, surface_values(model(), {})).empty());
}

}  // namespace
