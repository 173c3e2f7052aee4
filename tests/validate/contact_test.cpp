// The exact pair classification against an independent definition: the intersection as CGAL's exact kernel
// constructs it, minus what the triangles share by index.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <gtest/gtest.h>

#include <random>

#include "validate/check_surface.h"
#include "validate/exact.h"
#include "validate/triangle_contact.h"

namespace stackmesh {
namespace {

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using Corners = std::array<std::int32_t, 3>;

Exact::Point_3 exact(const Vec3& p) {
  return {p.x, p.y, p.z};
}

bool meet_by_definition(const std::vector<Vec3>& p, const Corners& s, const Corners& t) {
  std::vector<std::int32_t> shared;
  for (const auto v : s)
    if (std::find(t.begin(), t.end(), v) != t.end()) shared.push_back(v);
  if (shared.size() == 3) return true;
  const Exact::Triangle_3 a(exact(p[s[0]]), exact(p[s[1]]), exact(p[s[2]]));
  const Exact::Triangle_3 b(exact(p[t[0]]), exact(p[t[1]]), exact(p[t[2]]));
  const auto common = CGAL::intersection(a, b);
  if (!common) return false;
  if (shared.empty()) return true;
  if (shared.size() == 1) {
    const auto* point = boost::get<Exact::Point_3>(&*common);
    return !(point && *point == exact(p[shared[0]]));
  }
  return boost::get<Exact::Segment_3>(&*common) == nullptr;  // convex, holds the edge: a segment is the edge itself
}

bool has_area(const std::vector<Vec3>& p, const Corners& t) {
  return !CGAL::collinear(exact(p[t[0]]), exact(p[t[1]]), exact(p[t[2]]));
}

/// Compares count and pairs of check_surface with the definition. Returns how many pairs met.
std::size_t compare(const InterfaceComplex& c) {
  std::vector<std::array<std::int32_t, 2>> expected;
  std::size_t flat = 0;
  const std::int32_t n = static_cast<std::int32_t>(c.triangles.size());
  for (std::int32_t i = 0; i < n; ++i) {
    if (!has_area(c.points, c.triangles[i].v)) {
      expected.push_back({i, i});
      ++flat;
      continue;
    }
    for (std::int32_t j = i + 1; j < n; ++j)
      if (has_area(c.points, c.triangles[j].v) && meet_by_definition(c.points, c.triangles[i].v, c.triangles[j].v))
        expected.push_back({i, j});
  }
  const SurfaceCheck check = check_surface(c, {1, 1000});
  EXPECT_EQ(check.intersecting_pairs, expected);
  EXPECT_EQ(check.self_intersections, expected.size());
  EXPECT_EQ(check.degenerate_triangles, flat);
  return expected.size();
}

template <class Coordinate>
std::size_t random_soups(int soups, int points, int triangles, unsigned seed, Coordinate coordinate) {
  std::mt19937 random(seed);
  std::size_t met = 0;
  for (int s = 0; s < soups && !testing::Test::HasFailure(); ++s) {
    InterfaceComplex c;
    for (int i = 0; i < points; ++i) c.points.push_back({coordinate(random), coordinate(random), coordinate(random)});
    for (int i = 0; i < triangles; ++i) {
      Corners v;
      for (auto& x : v) x = static_cast<std::int32_t>(random() % points);
      c.triangles.push_back({v, 1, 0});
    }
    met += compare(c);
  }
  return met;
}

TEST(TriangleContact, AgreesWithTheExactKernelOnDegenerateIntegerSoups) {
  EXPECT_GT(random_soups(20000, 7, 7, 1, [](std::mt19937& r) { return double(r() % 4); }), 50000u);
}

TEST(TriangleContact, AgreesWithTheExactKernelOnCubeCorners) {
  EXPECT_GT(random_soups(3000, 8, 8, 2, [](std::mt19937& r) { return double(r() % 2); }), 1000u);
}

TEST(TriangleContact, AgreesWithTheExactKernelWherePairsRarelyMeet) {
  EXPECT_GT(random_soups(200, 24, 12, 3, [](std::mt19937& r) { return r() * (7.3 / 4294967296.0); }), 100u);
}

TEST(TriangleContact, AgreesWithTheExactKernelWithinOneUlp) {
  // Coordinates that differ by multiples of an ulp about 1000: every float filter is at its limit.
  EXPECT_GT(random_soups(500, 7, 7, 4, [](std::mt19937& r) { return 1000 + (r() % 4) * 0x1p-43; }), 1000u);
}

TEST(TriangleContact, AgreesWithTheExactKernelOnTiltedNearlyFlatSoups) {
  std::mt19937 random(5);
  for (int s = 0; s < 300 && !HasFailure(); ++s) {
    InterfaceComplex c;
    for (int i = 0; i < 8; ++i) {
      const double x = random() % 4, y = random() % 4;
      c.points.push_back({0.1 * x, 0.1 * y, 0.1 * x + 0.3 * y});  // in a plane but for rounding
    }
    for (int i = 0; i < 8; ++i) {
      Corners v;
      for (auto& x : v) x = static_cast<std::int32_t>(random() % 8);
      c.triangles.push_back({v, 1, 0});
    }
    compare(c);
  }
}

bool collide(const std::vector<Vec3>& p, Corners s, Corners t) {
  const bool one = triangles_collide(p, s, t);
  EXPECT_EQ(one, triangles_collide(p, t, s));
  EXPECT_EQ(one, triangles_collide(p, {s[1], s[2], s[0]}, {t[2], t[1], t[0]}));
  return one;
}

TEST(TriangleContact, GapOfATrillionthIsNoContact) {
  const std::vector<Vec3> p = {{0, 0, 0},     {1, 0, 0},     {0, 1, 0},     {0.2, 0.2, 1e-12},
                               {0.3, 0.2, 1}, {0.2, 0.3, 1}, {0.2, 0.2, 0}, {0.2, 0.2, -1e-12}};
  EXPECT_FALSE(collide(p, {0, 1, 2}, {3, 4, 5}));
  EXPECT_TRUE(collide(p, {0, 1, 2}, {6, 4, 5}));  // touches with a corner
  EXPECT_TRUE(collide(p, {0, 1, 2}, {7, 4, 5}));  // pierced by a trillionth
}

TEST(TriangleContact, SharedCornerThatCrossesIsContact) {
  const std::vector<Vec3> p = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {1, 1, -1}, {1, 0.5, 1}, {-1, -1, -1}, {-1, -1, 1}};
  EXPECT_TRUE(collide(p, {0, 1, 2}, {0, 3, 4}));
  EXPECT_FALSE(collide(p, {0, 1, 2}, {0, 5, 6}));
}

TEST(TriangleContact, SharedEdgeMeetsOnlyWhenFoldedFlat) {
  const std::vector<Vec3> p = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, -1, 0}, {0.5, 1, 1e-12}, {0, 1, 0}};
  EXPECT_TRUE(collide(p, {0, 1, 2}, {1, 0, 3}));
  EXPECT_FALSE(collide(p, {0, 1, 2}, {1, 0, 4}));
  EXPECT_FALSE(collide(p, {0, 1, 2}, {1, 0, 5}));
  EXPECT_TRUE(collide(p, {0, 1, 2}, {1, 0, 6}));  // the same triangle with a corner of its own
  EXPECT_TRUE(collide(p, {0, 1, 2}, {1, 0, 2}));
}

TEST(Exact, OrientationIsRightWhereDoublesAreNot) {
  const Vec3 a{0.1, 0.1, 0.1}, b{0.2, 0.2, 0.2 + 0x1p-54}, c{0.4, 0.4, 0.4}, d{1, 7, 3};
  using P = Exact::Point_3;
  EXPECT_EQ(exact_orientation(a, b, c, d), static_cast<int>(CGAL::orientation(P(a.x, a.y, a.z), P(b.x, b.y, b.z),
                                                                              P(c.x, c.y, c.z), P(d.x, d.y, d.z))));
  EXPECT_EQ(exact_orientation({0, 0, 0}, {1e-120, 0, 0}, {0, 1e-120, 0}, {0, 0, 1e-120}), 1);
  EXPECT_TRUE(exact_collinear({0, 0, 0}, {1, 1, 1}, {3, 3, 3}));
  EXPECT_FALSE(exact_collinear({0, 0, 0}, {1, 1, 1}, {3, 3, 3 + 0x1p-51}));
}

}  // namespace
}  // namespace stackmesh
