// Complexes without a crossing whose labels contradict each other, and the guard that lets none come about.
#include "validate/label_agreement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "enhance/smoothing.h"
#include "shapes.h"
#include "validate/check_surface.h"
#include "validate/self_intersections.h"

using namespace stackmesh;

namespace {

/// Two tets that share the face A B C: label 1 with D, label 2 with E; C turned about the edge A B by an angle, D at 0
/// degrees, E at 80.
InterfaceComplex book(double degrees) {
  const auto at = [](double r, double angle) {
    return Vec3{r * std::cos(angle * M_PI / 180), r * std::sin(angle * M_PI / 180), 0.5};
  };
  InterfaceComplex c;
  c.points = {{0, 0, 0}, {0, 0, 1}, at(1, degrees), at(0.5, 0), at(1, 80)};
  const auto add = [&](std::int32_t x, std::int32_t y, std::int32_t z, Label below, Label above) {
    c.triangles.push_back({{x, y, z}, below, above});
  };
  // Outwards for C between D and E.
  add(0, 3, 1, 1, 0), add(1, 3, 2, 1, 0), add(0, 2, 3, 1, 0);
  add(0, 1, 4, 2, 0), add(1, 2, 4, 2, 0), add(0, 4, 2, 2, 0);
  add(0, 1, 2, 1, 2);
  return c;
}

InterfaceComplex both(InterfaceComplex a, const InterfaceComplex& b) {
  const auto n = static_cast<std::int32_t>(a.points.size());
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  for (InterfaceTriangle t : b.triangles) {
    for (std::int32_t& v : t.v) v += n;
    a.triangles.push_back(t);
  }
  return a;
}

}  // namespace

TEST(LabelAgreement, ASheetTurnedThroughAnotherIsFound) {
  EXPECT_EQ(check_surface(book(40)).open_edges, 0u);
  EXPECT_EQ(check_surface(book(40)).self_intersections, 0u);
  const InterfaceComplex turned = book(-20);
  EXPECT_EQ(find_self_intersections(turned, 1, 10).count, 0u);  // nothing crosses
  const SurfaceCheck check = check_surface(turned);
  EXPECT_EQ(check.open_edges, 0u);
  EXPECT_GT(check.self_intersections, 0u);
  EXPECT_FALSE(check.intersecting_pairs.empty());
}

TEST(LabelAgreement, APieceInTheWrongLabelIsFound) {
  const InterfaceComplex around = test::box({0, 0, 0}, {10, 10, 10}, 1);
  for (const bool inside : {false, true}) {
    const Vec3 low = inside ? Vec3{3, 3, 3} : Vec3{13, 3, 3}, high = low + Vec3{1, 1, 1};
    EXPECT_EQ(check_surface(both(around, test::box(low, high, 2))).self_intersections, inside ? 1u : 0u);
    InterfaceComplex held = test::box(low, high, 2);
    for (InterfaceTriangle& t : held.triangles)
      if (t.above == 0) t.above = 1;
      else if (t.below == 0) t.below = 1;
    EXPECT_EQ(check_surface(both(around, held)).self_intersections, inside ? 0u : 1u);
  }
}

TEST(LabelAgreement, ManyNestedPiecesAgreeWhicheverWayTheyAreNumbered) {
  InterfaceComplex c = test::icosphere(20, 2, 1, {0, 0, 0});
  for (int i = 0; i < 12; ++i) c = both(c, test::icosphere(1, 1, 2 + i % 3, {30.0 + 3 * i, 0.1 * i, 0.2 * i}));
  EXPECT_EQ(find_label_conflicts(c, 2, 10).count, 0u);
  c = both(c, test::icosphere(1, 1, 5, {3, 2, 1}));  // of the outside, but within label 1
  EXPECT_EQ(find_label_conflicts(c, 2, 10).count, 1u);
}

TEST(LabelAgreement, TheGuardLetsNoSheetTurnThroughAnother) {
  ComplexMesh mesh(book(40), 1e9);
  std::fill(mesh.pinned.begin(), mesh.pinned.end(), 0);
  std::vector<Vec3> to = mesh.points;
  to[2] = book(-20).points[2];
  MoveLimits keep;
  keep.sheet_angle_deg = 1;
  const SmoothingResult r = move_guarded(mesh, to, keep, 1);
  EXPECT_GT(r.held_back, 0u);
  EXPECT_EQ(check_surface(mesh.to_complex()).self_intersections, 0u);
  to = book(60).points;  // between the two it may move
  EXPECT_EQ(move_guarded(mesh, to, keep, 1).held_back, 0u);
}
