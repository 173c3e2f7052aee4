// What the remesher does where its gentle means fail: needles along curves, folds, tips, long faces, sheets too near.
#include <algorithm>
#include <cmath>

#include "checks.h"
#include "enhance/enhance.h"
#include "enhance/local_operations.h"
#include "enhance/separate.h"
#include "enhance_shapes.h"
#include "sections/extract.h"
#include "sections/polygons.h"
#include "stitch/stitch.h"

using namespace stackmesh;
using namespace stackmesh::testing_support;

namespace {

EnhanceResult enhance(const InterfaceComplex& c, double edge_mm, double pixel_mm = 1) {
  EnhanceOptions o;
  o.edge_length_mm = edge_mm;
  o.pixel_mm = o.gap_mm = pixel_mm;
  o.smooth_passes = 0;
  Monitor quiet;
  return enhance_complex(c, o, quiet);
}

double largest_bend_deg(const InterfaceComplex& c) {
  const std::vector<double> bends = bends_deg(c);
  return *std::max_element(bends.begin(), bends.end());
}

double longest_edge(const InterfaceComplex& c) {
  double longest = 0;
  for (const InterfaceTriangle& t : c.triangles)
    for (int k = 0; k < 3; ++k) longest = std::max(longest, norm(c.points[t.v[k]] - c.points[t.v[(k + 1) % 3]]));
  return longest;
}

/// Number of the triangle that holds all three corners at these places, or -1.
int find_triangle(const InterfaceComplex& c, const Vec3& p, const Vec3& q) {
  for (std::size_t t = 0; t < c.triangles.size(); ++t) {
    int hits = 0;
    for (std::int32_t v : c.triangles[t].v) hits += norm(c.points[v] - p) < 1e-12 || norm(c.points[v] - q) < 1e-12;
    if (hits == 2) {
      const auto& v = c.triangles[t].v;
      if (c.points[v[0]].z == c.points[v[1]].z && c.points[v[0]].z == c.points[v[2]].z) return static_cast<int>(t);
    }
  }
  return -1;
}

/// Cuts a triangle into three at p.
void insert_point(InterfaceComplex& c, int triangle, const Vec3& p) {
  const InterfaceTriangle t = c.triangles[triangle];
  const auto n = static_cast<std::int32_t>(c.points.size());
  c.points.push_back(p);
  for (int k = 0; k < 3; ++k) {
    InterfaceTriangle part = t;
    part.v = {t.v[k], t.v[(k + 1) % 3], n};
    if (k == 0) c.triangles[triangle] = part;
    else c.triangles.push_back(part);
  }
}

}  // namespace

TEST(EnhanceMending, ANeedleAlongTheRimOfACapJoinsTheRim) {
  // No flip may turn the rim's edge, and a split of it leaves the needle.
  InterfaceComplex c = cube(10, 1);
  const int t = find_triangle(c, {0, 0, 10}, {10, 0, 10});
  ASSERT_GE(t, 0);
  insert_point(c, t, {4.3, 0.01, 10});
  ASSERT_LT(check_surface(c).angle_min_deg, 0.2);
  const EnhanceResult r = enhance(c, 2);
  const SurfaceCheck check = check_surface(r.complex);
  EXPECT_EQ(r.level, SurfaceLevel::enhanced);
  EXPECT_GT(check.angle_min_deg, 22);
  EXPECT_EQ(check.self_intersections, 0u);
  EXPECT_NEAR(surface_of(check, 1).volume_mm3, 1000, 5);
  double cap = 0;
  for (const InterfaceTriangle& f : r.complex.triangles) {
    const Vec3 &a = r.complex.points[f.v[0]], &b = r.complex.points[f.v[1]], &d = r.complex.points[f.v[2]];
    if (a.z == 10 && b.z == 10 && d.z == 10) cap += 0.5 * norm(cross(b - a, d - a));
  }
  EXPECT_NEAR(cap, 100, 0.5);
}

TEST(EnhanceMending, AFoldIsTakenOut) {
  // The upper face runs forth, back and forth again over a strip: three layers a tenth of a mm apart.
  InterfaceComplex c = cube(20, 20);
  for (Vec3& p : c.points) {
    if (p.z != 20 || p.x < 5.5 || p.x > 14.5) continue;
    if (p.y == 9) p = {p.x, 9.8, 20.1};
    if (p.y == 10) p = {p.x, 9.3, 20.0};
    if (p.y == 11) p = {p.x, 10.4, 20.0};
  }
  ASSERT_EQ(check_surface(c).self_intersections, 0u);
  ASSERT_GT(largest_bend_deg(c), 160);
  const EnhanceResult r = enhance(c, 1);
  const SurfaceCheck check = check_surface(r.complex);
  EXPECT_EQ(r.level, SurfaceLevel::enhanced);
  EXPECT_EQ(check.self_intersections, 0u);
  EXPECT_LT(largest_bend_deg(r.complex), 130);  // the cube's own edges bend by 90
  EXPECT_GT(check.angle_min_deg, 15);
  EXPECT_NEAR(surface_of(check, 1).volume_mm3, surface_of(check_surface(c), 1).volume_mm3, 8);
}

TEST(EnhanceMending, FacesLongerThanABlockAreSplit) {
  // A drum of fine walls: its flat ends are triangles from rim to rim, which fit into no block.
  LabelContours file;
  file.path = "drum";
  file.label = 1;
  for (int k = 0; k < 24; ++k) {
    ContourSection section;
    section.z_mm = 0.5 * k;
    ContourPolygon p;
    for (int i = 0; i < 760; ++i)
      p.points.push_back({60 * std::cos(2 * M_PI * i / 760), 60 * std::sin(2 * M_PI * i / 760)});
    section.polygons.push_back(p);
    file.sections.push_back(section);
  }
  std::vector<Warning> warnings;
  Monitor quiet;
  StitchOptions flat;
  flat.caps = Caps::flat;
  Stack stack = sections_from_contours({file}, warnings);
  const InterfaceComplex drum = stitch_sections(stack, flat, quiet).complex;
  ASSERT_GT(drum.points.size(), 16000u);
  ASSERT_GT(longest_edge(drum), 60);
  const EnhanceResult r = enhance(drum, 0.9, 0.5);
  EXPECT_EQ(r.level, SurfaceLevel::enhanced);
  EXPECT_LT(longest_edge(r.complex), 2);
  EXPECT_GT(check_surface(r.complex).angle_min_deg, 20);
}

TEST(EnhanceMending, ATipOnALoopOfThreeEdgesCanBeReplacedByATriangle) {
  InterfaceComplex c = ball(10, 2);
  const std::size_t before = c.triangles.size();
  const std::array<std::int32_t, 3> loop = c.triangles[0].v;
  const Vec3 middle = (1 / 3.0) * (c.points[loop[0]] + c.points[loop[1]] + c.points[loop[2]]);
  insert_point(c, 0, 1.2 * middle);
  insert_point(c, 0, 1.3 * middle);
  ComplexMesh mesh(c, 1e9);
  std::vector<std::int32_t> around;
  mesh.edge_triangles(loop[0], loop[1], around);
  ASSERT_EQ(around.size(), 2u);
  std::vector<std::int32_t> disc;
  int sides = 0;
  for (std::int32_t t : around) {
    const std::vector<std::int32_t> d = mesh.disc_behind(loop, t, 80);
    if (!d.empty()) {
      disc = d;
      ++sides;
    }
  }
  EXPECT_EQ(sides, 1);  // the rest of the ball is more than 80 triangles
  ASSERT_EQ(disc.size(), 5u);
  mesh.replace_disc(disc, {loop});
  const InterfaceComplex after = mesh.to_complex();
  EXPECT_EQ(after.triangles.size(), before);
  const SurfaceCheck check = check_surface(after);
  EXPECT_EQ(check.open_edges, 0u);
  EXPECT_NEAR(surface_of(check, 1).volume_mm3, surface_of(check_surface(ball(10, 2)), 1).volume_mm3, 1e-9);
}

TEST(EnhanceMending, APleatIsCutOutAndWhatIsThickStays) {
  // One vertex of a flat face lies beyond its neighbour, a little above it: three layers. A spike is a part of the
  // body.
  for (const bool spike : {false, true}) {
    InterfaceComplex c = cube(20, 20);
    const auto v =
        static_cast<std::int32_t>(std::find_if(c.points.begin(), c.points.end(),
                                               [](const Vec3& p) { return p.x == 10 && p.y == 10 && p.z == 20; }) -
                                  c.points.begin());
    c.points[v] = spike ? Vec3{10, 10, 23} : Vec3{11.15, 10, 20.05};
    const double volume = surface_of(check_surface(c), 1).volume_mm3;
    ASSERT_EQ(check_surface(c).self_intersections, 0u);
    if (!spike) ASSERT_GT(largest_bend_deg(c), 150);
    ComplexMesh mesh(c, 1e9);
    std::vector<double> size(mesh.points.size(), 1);
    std::vector<std::int32_t> hints(mesh.points.size(), -1);
    const Reference reference(mesh, 1, 1);
    const RemeshOptions options;
    LocalOperations ops(mesh, size, hints, reference, options);
    ops.guard.rebuild(1);
    bool done = false;
    for (std::size_t i = 0; i < mesh.star[v].size() && !done; ++i) done = ops.unfold(mesh.star[v][i]);
    EXPECT_EQ(done, !spike);
    const SurfaceCheck check = check_surface(mesh.to_complex());
    EXPECT_EQ(check.open_edges, 0u);
    EXPECT_EQ(check.self_intersections, 0u);
    EXPECT_NEAR(surface_of(check, 1).volume_mm3, done ? 8000 : volume, 1e-9);
    EXPECT_EQ(check.triangles < c.triangles.size(), done);
    EXPECT_GE(check.triangles + 4, c.triangles.size());
    if (done) EXPECT_NEAR(largest_bend_deg(mesh.to_complex()), 90, 1e-9);  // the cube's own edges
  }
}

TEST(EnhanceMending, SheetsTooNearArePartedAndNoFurther) {
  const InterfaceComplex c = two_plates(10, 4, 0.05);
  const auto gap = [](const ComplexMesh& m) {
    double low = 1e9, high = -1e9;  // of what faces the gap, in its middle
    for (const Vec3& p : m.points)
      if (std::abs(p.x - 5) < 3 && std::abs(p.y - 5) < 3) {
        if (p.z > 3 && p.z < 4.025) high = std::max(high, p.z);
        if (p.z >= 4.025 && p.z < 5) low = std::min(low, p.z);
      }
    return low - high;
  };
  ComplexMesh mesh(c, 1e9);
  ASSERT_NEAR(gap(mesh), 0.05, 1e-12);
  std::vector<double> size(mesh.points.size(), 1.0);
  MoveLimits keep;
  keep.size_mm = &size;
  keep.clearance_rel = 0.1;
  EXPECT_GT(separate_sheets(mesh, size, 0.2, keep, 1).moved, 50u);
  EXPECT_GT(gap(mesh), 0.15);
  EXPECT_LT(gap(mesh), 0.3);
  EXPECT_EQ(check_surface(mesh.to_complex()).self_intersections, 0u);
  ComplexMesh far(two_plates(10, 4, 0.5), 1e9);
  const std::vector<Vec3> places = far.points;
  size.assign(far.points.size(), 1.0);
  EXPECT_EQ(separate_sheets(far, size, 0.2, keep, 1).moved, 0u);
}
