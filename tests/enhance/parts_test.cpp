// The parts of the enhancement on their own, each against what is known exactly: contact of triangles, the guard, the
// reference, the sizes.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "enhance/guard.h"
#include "enhance/reference.h"
#include "enhance/sizing.h"
#include "enhance_shapes.h"

using namespace stackmesh;
using namespace stackmesh::testing_support;

namespace {

// ---- contact: an oracle in whole numbers, by segments against triangles

using Point = std::array<std::int64_t, 3>;
using Triangle = std::array<Point, 3>;

Point minus(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Point times(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
std::int64_t dot_of(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
int sign(std::int64_t x) {
  return (x > 0) - (x < 0);
}
int side(const Triangle& t, const Point& p) {
  return sign(dot_of(times(minus(t[1], t[0]), minus(t[2], t[0])), minus(p, t[0])));
}

/// p in the plane of t: is it inside or on the rim?
bool holds(const Triangle& t, const Point& p) {
  const Point n = times(minus(t[1], t[0]), minus(t[2], t[0]));
  int least = 1;
  for (int i = 0; i < 3; ++i)
    least = std::min(least, sign(dot_of(times(minus(t[(i + 1) % 3], t[i]), minus(p, t[i])), n)));
  return least >= 0;
}

bool segments_meet(const Point& a, const Point& b, const Point& c, const Point& d, const Point& normal) {
  const auto turn = [&](const Point& p, const Point& q, const Point& r) {
    return sign(dot_of(times(minus(q, p), minus(r, p)), normal));
  };
  const auto between = [](const Point& p, const Point& q, const Point& r) {  // r on the line p q
    for (int i = 0; i < 3; ++i)
      if (r[i] < std::min(p[i], q[i]) || r[i] > std::max(p[i], q[i])) return false;
    return true;
  };
  const int s = turn(a, b, c), t = turn(a, b, d), u = turn(c, d, a), v = turn(c, d, b);
  if (s * t < 0 && u * v < 0) return true;
  return (s == 0 && between(a, b, c)) || (t == 0 && between(a, b, d)) || (u == 0 && between(c, d, a)) ||
         (v == 0 && between(c, d, b));
}

bool segment_meets(const Point& a, const Point& b, const Triangle& t) {
  const int sa = side(t, a), sb = side(t, b);
  if (sa * sb > 0) return false;
  if (sa == 0 && sb == 0) {
    if (holds(t, a) || holds(t, b)) return true;
    const Point n = times(minus(t[1], t[0]), minus(t[2], t[0]));
    for (int i = 0; i < 3; ++i)
      if (segments_meet(a, b, t[i], t[(i + 1) % 3], n)) return true;
    return false;
  }
  if (sa == 0) return holds(t, a);
  if (sb == 0) return holds(t, b);
  // The line passes all three edges on the same side, or through some.
  int low = 0, high = 0;
  for (int i = 0; i < 3; ++i) {
    const int s = sign(dot_of(times(minus(t[i], a), minus(t[(i + 1) % 3], a)), minus(b, a)));
    low = std::min(low, s), high = std::max(high, s);
  }
  return low >= 0 || high <= 0;
}

bool oracle(const Triangle& s, const Triangle& t) {
  for (int i = 0; i < 3; ++i)
    if (segment_meets(s[i], s[(i + 1) % 3], t) || segment_meets(t[i], t[(i + 1) % 3], s)) return true;
  return false;
}

Corners3 corners_of(const Triangle& t) {
  Corners3 c;
  for (int i = 0; i < 3; ++i)
    c[i] = {static_cast<double>(t[i][0]), static_cast<double>(t[i][1]), static_cast<double>(t[i][2])};
  return c;
}

TEST(TriangleContact, AgreesWithAnOracleInWholeNumbers) {
  std::mt19937 random(7);
  std::size_t meet = 0, apart = 0;
  for (int i = 0; i < 60000; ++i) {
    // small ranges: many touch, some are coplanar
    const int range = i % 3 == 0 ? 2 : 6, height = i % 5 == 0 ? 1 : range;
    const auto point = [&] {
      return Point{static_cast<int>(random() % range), static_cast<int>(random() % range),
                   static_cast<int>(random() % height)};
    };
    const Triangle s = {point(), point(), point()}, t = {point(), point(), point()};
    const auto flat = [](const Triangle& x) { return times(minus(x[1], x[0]), minus(x[2], x[0])) == Point{0, 0, 0}; };
    if (flat(s) || flat(t)) continue;
    const bool expected = oracle(s, t);
    ASSERT_EQ(triangles_meet(corners_of(s), corners_of(t), {}), expected) << "pair " << i;
    ASSERT_EQ(triangles_meet(corners_of(t), corners_of(s), {}), expected) << "pair " << i << ", the other way round";
    if (!expected) {
      const NearestPoints near = nearest_points(corners_of(s), corners_of(t));
      ASSERT_GT(near.squared, 0) << "pair " << i;
      ASSERT_NEAR(dot(near.on_s - near.on_t, near.on_s - near.on_t), near.squared, 1e-9);
      for (int k = 0; k < 20; ++k) {  // no two points of them are nearer
        const double a = (random() % 1000) / 999.0, b = (random() % 1000) / 999.0 * (1 - a),
                     c = (random() % 1000) / 999.0, d = (random() % 1000) / 999.0 * (1 - c);
        const Corners3 p = corners_of(s), q = corners_of(t);
        const Vec3 x = (1 - a - b) * p[0] + (a * p[1] + b * p[2]), y = (1 - c - d) * q[0] + (c * q[1] + d * q[2]);
        ASSERT_GE(dot(x - y, x - y), near.squared - 1e-9) << "pair " << i;
      }
      if (certainly_apart(corners_of(s), corners_of(t), 0.5)) {
        ASSERT_GE(near.squared, 0.25 - 1e-9) << "pair " << i;
      }
    }
    ++(expected ? meet : apart);
  }
  EXPECT_GT(meet, 10000u);
  EXPECT_GT(apart, 10000u);
}

TEST(TriangleContact, SharedCornersAreNoContactButFoldsAre) {
  const Corners3 s = {Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, 4, 0}};
  SharedCorners edge;
  edge.count = 2;
  edge.in_s = {0, 1, 0}, edge.in_t = {0, 1, 0};
  EXPECT_FALSE(triangles_meet(s, {Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, -4, 0}}, edge));
  EXPECT_TRUE(triangles_meet(s, {Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{1, 1, 0}}, edge));  // folded onto it
  SharedCorners corner;
  corner.count = 1;
  EXPECT_FALSE(triangles_meet(s, {Vec3{0, 0, 0}, Vec3{-4, 0, 1}, Vec3{0, -4, 1}}, corner));
  EXPECT_TRUE(triangles_meet(s, {Vec3{0, 0, 0}, Vec3{1, 1, 1}, Vec3{1, 1, -1}}, corner));
}

// ---- guard

/// What the guard says to a vertex that moves.
bool may_move(Guard& guard, const ComplexMesh& mesh, std::int32_t v, const Vec3& to, double clearance_mm = 0) {
  std::vector<std::int32_t> removed(mesh.star[v].begin(), mesh.star[v].end());
  std::vector<std::array<std::int32_t, 3>> added;
  for (const std::int32_t t : removed) added.push_back(mesh.triangles[t].v);
  Change c;
  c.removed = &removed;
  c.added = &added;
  c.moved = v;
  c.to = to;
  c.clearance_mm = clearance_mm;
  return guard.allows(c);
}

TEST(Guard, RefusesWhatCrossesComesTooNearOrFolds) {
  ComplexMesh mesh(two_plates(8, 2, 1), 0, 1);  // label 2 hangs 1 mm above label 1
  Guard guard(mesh, 20);
  guard.rebuild(1);
  std::int32_t v = -1;  // in the middle of the upper side of the lower plate
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(mesh.points.size()); ++i)
    if (std::abs(mesh.points[i].z - 2) < 1e-9 && norm(mesh.points[i] - Vec3{4, 4, 2}) < 1e-6) v = i;
  ASSERT_GE(v, 0);
  const Vec3 at = mesh.points[v];
  EXPECT_TRUE(may_move(guard, mesh, v, at + Vec3{0, 0, 0.3}));
  EXPECT_EQ(guard.refused_contact + guard.refused_angle + guard.refused_clearance, 0u);
  EXPECT_FALSE(may_move(guard, mesh, v, at + Vec3{0, 0, 1.2})) << "through the plate above";
  EXPECT_EQ(guard.refused_contact, 1u);
  EXPECT_FALSE(may_move(guard, mesh, v, at + Vec3{0, 0, 0.8}, 0.5)) << "nearer than the clearance";
  EXPECT_EQ(guard.refused_clearance, 1u);
  EXPECT_TRUE(may_move(guard, mesh, v, at + Vec3{0, 0, 0.8}, 0.1));
  EXPECT_FALSE(may_move(guard, mesh, v, at + Vec3{0, 0, -2.5})) << "through the plate's own underside";
  EXPECT_FALSE(may_move(guard, mesh, v, at + Vec3{3, 0, 0})) << "over its neighbours, in their plane";
}

TEST(Guard, CountsTheContactsOfAWholeComplex) {
  InterfaceComplex c = two_plates(8, 2, 1);
  EXPECT_EQ(count_contacts(ComplexMesh(c, 0, 1), 1), 0u);
  for (Vec3& p : c.points)
    if (p.z > 2.5) p.z -= 1.5;  // the upper plate sinks into the lower one
  EXPECT_GT(count_contacts(ComplexMesh(c, 0, 1), 1), 10u);
}

// ---- reference

TEST(Reference, IsNearerToABallThanItsTrianglesAreAndKnowsItsNormals) {
  const double radius = 10;
  const ComplexMesh mesh(ball(radius, 3), 1e300, 1);
  const Reference reference(mesh, 2, 1);
  const std::int32_t patch = mesh.triangles[0].patch;
  double flat = 0, bulged = 0, turned = 0;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 500; ++i) {
    Vec3 n{normal(random), normal(random), normal(random)};
    n = (1 / norm(n)) * n;
    const auto foot = reference.nearest((radius + 0.5) * n, patch, 3, -1, 0);
    ASSERT_TRUE(foot);
    bulged = std::max(bulged, std::abs(norm(foot->point) - radius));
    flat = std::max(flat, std::abs(radius + 0.5 - foot->distance_mm - radius));
    turned =
        std::max(turned, std::acos(std::min(1.0, std::abs(dot(foot->normal, (1 / norm(foot->point)) * foot->point)))));
  }
  EXPECT_GT(flat, 0.04);           // the sagitta of its triangles
  EXPECT_LT(bulged, 0.35 * flat);  // the reference bulges over them
  EXPECT_LT(turned * 180 / M_PI, 2);
  EXPECT_FALSE(reference.nearest({3 * radius, 0, 0}, patch, 1, -1, 0)) << "beyond its reach";
  EXPECT_FALSE(reference.nearest({radius, 0, 0}, patch + 2, 5, -1, 0)) << "another patch";
}

// ---- sizes

TEST(Sizing, BendsAreOneOverTheRadius) {
  for (const double radius : {4.0, 16.0}) {
    const ComplexMesh mesh(ball(radius, 4), 1e300, 1);
    const std::vector<double> bends = surface_bends(mesh, 1);
    for (const double b : bends) ASSERT_NEAR(b * radius, 1, 0.12);
  }
}

TEST(Sizing, WallsAreAsThickAsTheyAre) {
  const ComplexMesh mesh(two_plates(20, 2, 0.5), 0, 1);
  const std::vector<double> wall = wall_thickness(mesh, 5, 1);
  std::size_t inner = 0;
  for (std::size_t v = 0; v < wall.size(); ++v) {
    const Vec3& p = mesh.points[v];
    if (p.x < 4 || p.x > 16 || p.y < 4 || p.y > 16) continue;
    ++inner;
    EXPECT_NEAR(wall[v], 2, 1e-9) << p.z;  // the gap of 0.5 is background: no elements are made there
  }
  EXPECT_GT(inner, 20u);
  for (const double w : wall_thickness(mesh, 0.1, 1)) EXPECT_TRUE(std::isinf(w)) << "nothing is as near";
}

TEST(Sizing, ShellsAndSizesAreWhatTheyAreAskedToBe) {
  const ComplexMesh mesh(cube(10, 10), 1e300, 1);
  std::map<Label, ShellCount> shells;
  for (const double s : shell_sizes(mesh, &shells)) ASSERT_NEAR(s, 10, 1e-6);
  EXPECT_EQ(shells.at(1), (ShellCount{1, 0}));
  const ComplexMesh large(ball(50, 4), 1e300, 1);  // so large that nothing but the length requested counts
  SizingOptions o;
  o.edge_length_mm = 3;
  o.shell_mm.assign(large.points.size(), 1e300);
  o.wall_mm.assign(large.points.size(), std::numeric_limits<double>::infinity());
  const std::vector<double> sizes = edge_sizes(large, o);
  for (const double s : sizes) ASSERT_NEAR(s, 3, 1e-12);
  EXPECT_NEAR(expected_triangles(large, sizes) / (4 * M_PI * 2500 / (kTriangleArea * 9)), 1, 0.01);
  o.label_edge_mm[1] = 1.5;
  for (const double s : edge_sizes(large, o)) ASSERT_NEAR(s, 1.5, 1e-12);
}

TEST(Sizing, GradationLimitsGrowthAlongEveryEdge) {
  const ComplexMesh mesh(cube(10, 10), 1e300, 1);
  std::vector<double> size(mesh.points.size(), 100);
  size[0] = 0.5;
  grade_sizes(mesh, 1.3, size);
  EXPECT_EQ(size[0], 0.5);
  double largest = 0;
  for (const auto& [a, b] : mesh.edges()) {
    EXPECT_LE(std::abs(size[a] - size[b]), std::log(1.3) * norm(mesh.points[a] - mesh.points[b]) * (1 + 1e-12));
    largest = std::max({largest, size[a], size[b]});
  }
  EXPECT_GT(largest, 3);  // far corners of the cube are 17 mm away
  EXPECT_LT(largest, 0.5 + std::log(1.3) * 31);
}

}  // namespace
