// Facts about whole enhancements: random stacks, thin and tiny labels, determinism, refusals.
#include "enhance/enhance.h"

#include <cmath>
#include <cstdlib>
#include <map>
#include <numeric>

#include "base/error.h"
#include "checks.h"
#include "enhance_shapes.h"
#include "random_stacks.h"

using namespace stackmesh;
using namespace stackmesh::testing_support;

namespace {

EnhanceOptions options_of(const Stack& stack) {
  EnhanceOptions o;
  o.pixel_mm = stack.pixel_mm;
  const std::size_t n = stack.sections.size();
  o.gap_mm =
      n > 1 ? (stack.sections.back().z_mm - stack.sections.front().z_mm) / static_cast<double>(n - 1) : stack.pixel_mm;
  return o;
}

EnhanceResult enhance(const InterfaceComplex& c, const EnhanceOptions& o) {
  Monitor quiet;
  return enhance_complex(c, o, quiet);
}

bool is_named(const std::vector<Warning>& warnings, Label label) {
  for (const Warning& w : warnings)
    if (w.where == "label " + std::to_string(label)) return true;
  return false;
}

double mean_bend_deg(const InterfaceComplex& c) {
  const std::vector<double> bends = bends_deg(c);
  return std::accumulate(bends.begin(), bends.end(), 0.0) / static_cast<double>(bends.size());
}

/// What must hold of any enhanced complex; "" if it does.
std::string broken(const InterfaceComplex& before, const EnhanceResult& after) {
  std::string out;
  const SurfaceCheck was = check_surface(before), is = check_surface(after.complex);
  if (is.open_edges) out += std::to_string(is.open_edges) + " open edges; ";
  if (is.self_intersections) out += std::to_string(is.self_intersections) + " self-intersections; ";
  if (was.labels.size() != is.labels.size()) return out + "labels were lost";
  for (std::size_t i = 0; i < was.labels.size(); ++i) {
    const LabelSurface &a = was.labels[i], &b = is.labels[i];
    const std::string name = "label " + std::to_string(a.label);
    if (!b.closed) out += name + " is open; ";
    if (a.components != b.components)
      out += name + " went from " + std::to_string(a.components) + " to " + std::to_string(b.components) + " pieces; ";
    if (a.euler != b.euler) out += name + " changed its genus; ";
    if (std::abs(b.volume_mm3 / a.volume_mm3 - 1) > 0.05 && !is_named(after.warnings, a.label) &&
        after.level == SurfaceLevel::enhanced)
      out +=
          name + " changed its volume by " + std::to_string(b.volume_mm3 / a.volume_mm3 - 1) + " without a warning; ";
  }
  return out;
}

}  // namespace

TEST(EnhanceComplex, KeepsRandomStacksClosedAndFreeOfIntersections) {
  const char* wanted = std::getenv("STACKMESH_RANDOM_STACKS");  // more for a campaign
  const std::uint64_t count = wanted ? std::stoull(wanted) : 40;
  std::uint64_t enhanced = 0;
  for (std::uint64_t seed = 0; seed < count; ++seed) {
    const Stitched s = stitch_volume(random_volume(seed), 0.5);
    EnhanceOptions o = options_of(s.stack);
    if (seed % 3 == 1) o.edge_length_mm = 2 * o.pixel_mm;
    if (seed % 3 == 2) o.edge_length_mm = 0.7 * o.pixel_mm;
    const EnhanceResult r = enhance(s.complex(), o);
    EXPECT_EQ(broken(s.complex(), r), "") << "seed " << seed << ", level " << to_text(r.level);
    enhanced += r.level == SurfaceLevel::enhanced;
  }
  EXPECT_GE(enhanced + 1 + count / 100, count);
}

namespace {

/// How far neighbouring triangles bend on average, with edges of 2 mm, on a slanted ball of voxels of 1 mm: of each
/// `step` voxels in a row only the first was looked at.
std::vector<double> bends_of_ball(int step, const std::vector<int>& passes) {
  const int n = 24;
  LabelVolume v;
  v.size = {n, n, n};
  v.voxels.assign(n * n * n, 0);
  v.labels = {{0, ""}, {1, ""}};
  const auto first = [&](int i) { return i - i % step + 0.5 * (step - 1); };
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        if (std::hypot(first(i) - 11.3, first(j) - 11.6, first(k) - 11.8) < 9) v.voxels[v.index(i, j, k)] = 1;
  const Stitched s = stitch_volume(v, 0.5);
  EnhanceOptions o = options_of(s.stack);
  o.edge_length_mm = 2;
  std::vector<double> bends;
  for (int count : passes) {
    o.smooth_passes = count;
    const EnhanceResult r = enhance(s.complex(), o);
    EXPECT_EQ(broken(s.complex(), r), "") << count;
    EXPECT_NEAR(
        surface_of(check_surface(r.complex), 1).volume_mm3 / surface_of(check_surface(s.complex()), 1).volume_mm3, 1,
        0.005);
    bends.push_back(mean_bend_deg(r.complex));
  }
  return bends;
}

}  // namespace

TEST(EnhanceComplex, StepsOfSingleVoxelsGoByDefault) {
  const std::vector<double> bends = bends_of_ball(1, {0, 5, 15});
  EXPECT_LT(bends[1], 0.5 * bends[0]);
  EXPECT_LT(bends[1], 9);  // edges of 2 on a radius of 9 bend by 7
  EXPECT_LT(bends[2], 1.05 * bends[1]);
}

TEST(EnhanceComplex, MorePassesTakeLargerStepsAway) {
  const std::vector<double> bends = bends_of_ball(2, {0, 5, 6, 15});
  EXPECT_LT(bends[1], 0.9 * bends[0]);
  EXPECT_LT(bends[3], 0.7 * bends[0]);
}

TEST(EnhanceComplex, GivesTheSameBytesWhateverTheThreadCount) {
  const Stitched s = stitch_volume(random_volume(7), 0.5);
  EnhanceOptions o = options_of(s.stack);
  o.threads = 1;
  const InterfaceComplex one = enhance(s.complex(), o).complex, again = enhance(s.complex(), o).complex;
  o.threads = 2;
  const InterfaceComplex two = enhance(s.complex(), o).complex;
  EXPECT_TRUE(same_bytes(one, again));
  EXPECT_TRUE(same_bytes(one, two));
}

TEST(EnhanceComplex, OneVoxelStaysAsASmallClosedShape) {
  const Stitched s =
      stitch_volume(volume_of({{"0000", "0000", "0000"}, {"0000", "0100", "0000"}, {"0000", "0000", "0000"}}), 0.5);
  for (double edge : {0.5, 2.0, 50.0}) {
    EnhanceOptions o = options_of(s.stack);
    o.edge_length_mm = edge;
    const EnhanceResult r = enhance(s.complex(), o);
    EXPECT_EQ(broken(s.complex(), r), "") << edge;
    EXPECT_EQ(r.level, SurfaceLevel::enhanced) << edge;
    EXPECT_GT(surface_of(check_surface(r.complex), 1).volume_mm3,
              0.7 * surface_of(check_surface(s.complex()), 1).volume_mm3)
        << edge;
  }
}

TEST(EnhanceComplex, TouchingLabelsStayConforming) {
  const Stitched s = stitch_volume(volume_of({{"000000", "011220", "011220", "011220", "000000"},
                                              {"000000", "011220", "011220", "013320", "000000"},
                                              {"000000", "011220", "013320", "013320", "000000"}}),
                                   0.5);
  for (double edge : {0.6, 1.5}) {
    EnhanceOptions o = options_of(s.stack);
    o.edge_length_mm = edge;
    const EnhanceResult r = enhance(s.complex(), o);
    EXPECT_EQ(broken(s.complex(), r), "");
    EXPECT_EQ(r.level, SurfaceLevel::enhanced) << edge;
    EXPECT_GT(interface_area(r.complex, 1, 2), 0.5 * interface_area(s.complex(), 1, 2));
    EXPECT_GT(interface_area(r.complex, 2, 3), 0.5 * interface_area(s.complex(), 2, 3));
  }
}

TEST(EnhanceComplex, AThinGapIsNotClosed) {
  const InterfaceComplex c = two_plates(20, 2, 0.05);
  EnhanceOptions o;
  o.edge_length_mm = 2;
  const EnhanceResult r = enhance(c, o);
  EXPECT_EQ(broken(c, r), "");
  EXPECT_EQ(r.level, SurfaceLevel::enhanced);
}

TEST(EnhanceComplex, FlatCapsStayPlane) {
  const std::vector<const char*> disc = {"00000000", "00111100", "01111110", "01111110",
                                         "01111110", "01111110", "00111100", "00000000"};
  StitchOptions flat;
  flat.caps = Caps::flat;
  const Stitched s = stitch_volume(volume_of({disc, disc, disc, disc}), 0.5, flat);
  double low = 1e9, high = -1e9;
  for (const Vec3& p : s.complex().points) {
    low = std::min(low, p.z);
    high = std::max(high, p.z);
  }
  EnhanceOptions o = options_of(s.stack);
  o.edge_length_mm = 1;
  const EnhanceResult r = enhance(s.complex(), o);
  const auto cap_area = [&](const InterfaceComplex& c, double z) {
    double sum = 0;
    for (const InterfaceTriangle& t : c.triangles) {
      const Vec3 &a = c.points[t.v[0]], &b = c.points[t.v[1]], &d = c.points[t.v[2]];
      if (a.z == z && b.z == z && d.z == z) sum += 0.5 * norm(cross(b - a, d - a));
    }
    return sum;
  };
  EXPECT_EQ(broken(s.complex(), r), "");
  EXPECT_EQ(r.level, SurfaceLevel::enhanced);
  EXPECT_GT(cap_area(s.complex(), low), 20);
  EXPECT_NEAR(cap_area(r.complex, low), cap_area(s.complex(), low), 0.08 * cap_area(s.complex(), low));
  EXPECT_NEAR(cap_area(r.complex, high), cap_area(s.complex(), high), 0.08 * cap_area(s.complex(), high));
  for (const Vec3& p : r.complex.points) EXPECT_TRUE(p.z >= low && p.z <= high) << p.z;
}

TEST(EnhanceComplex, ACubeKeepsItsVolumeAndCorners) {
  const InterfaceComplex c = cube(10, 10);
  EnhanceOptions o;
  o.edge_length_mm = 2;
  const EnhanceResult r = enhance(c, o);
  EXPECT_EQ(broken(c, r), "");
  EXPECT_EQ(r.level, SurfaceLevel::enhanced);
  const SurfaceCheck check = check_surface(r.complex);
  EXPECT_NEAR(surface_of(check, 1).volume_mm3, 1000, 10);
  EXPECT_GT(check.angle_min_deg, 20);
  EXPECT_LT(check.triangles, 1200u);
  for (int corner = 0; corner < 8; ++corner) {
    double nearest = 1e9;
    for (const Vec3& p : r.complex.points)
      nearest =
          std::min(nearest, norm(p - Vec3{corner & 1 ? 10.0 : 0.0, corner & 2 ? 10.0 : 0.0, corner & 4 ? 10.0 : 0.0}));
    EXPECT_LT(nearest, 0.4) << corner;
  }
}

TEST(EnhanceComplex, ABallGetsGoodTrianglesOfTheSizeAskedFor) {
  const InterfaceComplex c = ball(10, 4);
  EnhanceOptions o;
  o.edge_length_mm = 2;
  const EnhanceResult r = enhance(c, o);
  EXPECT_EQ(broken(c, r), "");
  EXPECT_EQ(r.level, SurfaceLevel::enhanced);
  const SurfaceCheck check = check_surface(r.complex);
  EXPECT_NEAR(surface_of(check, 1).volume_mm3 / surface_of(check_surface(c), 1).volume_mm3, 1, 0.005);
  EXPECT_GT(check.angle_min_deg, 28);
  EXPECT_GT(check.angle_median_deg, 48);
  EXPECT_GT(check.edge_median_mm, 1.4);
  EXPECT_LT(check.edge_median_mm, 2.2);
}

TEST(EnhanceComplex, CurvatureDecidesTheSizeWhenNoneIsAskedFor) {
  EnhanceOptions o;
  o.edge_min_mm = 0.1;
  o.edge_max_mm = 50;
  o.deviation_mm = 0.2;
  const double small = check_surface(enhance(ball(5, 4), o).complex).edge_median_mm;
  const double large = check_surface(enhance(ball(20, 5), o).complex).edge_median_mm;
  EXPECT_NEAR(large / small, 2, 0.6);  // the length goes with the root of the radius
}

TEST(EnhanceComplex, ATargetOfTetrahedraMakesEdgesLongerAndSaysSo) {
  EnhanceOptions o;
  o.edge_max_mm = 1.0;
  const InterfaceComplex c = ball(10, 4);
  const EnhanceResult fine = enhance(c, o);
  EXPECT_NEAR(static_cast<double>(fine.expected_triangles) / static_cast<double>(fine.complex.triangles.size()), 1,
              0.25);
  EXPECT_EQ(fine.coarsened, 1);
  o.target_tets = fine.expected_tets / 4;
  const EnhanceResult coarse = enhance(c, o);
  EXPECT_EQ(broken(c, coarse), "");
  EXPECT_NEAR(static_cast<double>(coarse.expected_tets) / static_cast<double>(*o.target_tets), 1, 0.05);
  // Triangles go with the square of the length, tetrahedra with up to its cube.
  EXPECT_GT(coarse.coarsened, std::cbrt(4.0));
  EXPECT_LT(coarse.coarsened, 2.1);
  const double triangles = static_cast<double>(fine.complex.triangles.size()) / (coarse.coarsened * coarse.coarsened);
  EXPECT_NEAR(static_cast<double>(coarse.complex.triangles.size()) / triangles, 1, 0.25);
  EXPECT_FALSE(coarse.warnings.empty());
}

TEST(EnhanceComplex, ATargetThatWasAskedForMakesEdgesShorterToo) {
  EnhanceOptions o;
  o.pixel_mm = 1;
  const InterfaceComplex c = ball(10, 4);
  const EnhanceResult usual = enhance(c, o);
  o.target_tets = 3 * usual.expected_tets;
  const EnhanceResult fine = enhance(c, o);
  EXPECT_EQ(broken(c, fine), "");
  EXPECT_LT(fine.coarsened, 0.85);
  EXPECT_NEAR(static_cast<double>(fine.expected_tets) / static_cast<double>(*o.target_tets), 1, 0.05);
  o.target_tets.reset();
  o.usual_target = true;  // far fewer than that: nothing to do
  EXPECT_EQ(enhance(c, o).coarsened, 1);
}

TEST(EnhanceComplex, ALongerEdgeLengthNeverMakesMoreTriangles) {
  const InterfaceComplex c = ball(10, 4);
  std::size_t before = 0;
  for (const double length : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 6.5, 7.0, 9.0, 12.0, 18.0, 40.0}) {
    EnhanceOptions o;
    o.pixel_mm = 1;
    o.edge_length_mm = length;
    const std::size_t now = enhance(c, o).complex.triangles.size();
    if (before != 0) {
      EXPECT_LE(static_cast<double>(now), 1.02 * static_cast<double>(before)) << length;
    }
    before = now;
  }
  EXPECT_LT(before, 300U);
}

TEST(EnhanceComplex, LabelsGetTheirOwnEdgeLength) {
  InterfaceComplex c = ball(6, 4), other = ball(6, 4);
  const auto first = static_cast<std::int32_t>(c.points.size());
  for (const Vec3& p : other.points) c.points.push_back(p + Vec3{20, 0, 0});
  for (InterfaceTriangle t : other.triangles) {
    for (std::int32_t& v : t.v) v += first;
    t.below = 2;
    c.triangles.push_back(t);
  }
  EnhanceOptions o;
  o.edge_length_mm = 2;
  o.label_edge_mm[2] = 0.8;
  const EnhanceResult r = enhance(c, o);
  EXPECT_EQ(broken(c, r), "");
  EXPECT_EQ(r.level, SurfaceLevel::enhanced);
  std::map<Label, int> count;
  for (const InterfaceTriangle& t : r.complex.triangles) ++count[std::max(t.below, t.above)];
  EXPECT_GT(count[2], 4 * count[1]);
}

TEST(EnhanceComplex, RefusesWhatMakesNoSense) {
  const InterfaceComplex c = ball(10, 3);
  const auto kind = [&](const EnhanceOptions& o) {
    try {
      enhance(c, o);
    } catch (const Error& e) {
      return static_cast<int>(e.kind());
    }
    return 0;
  };
  EnhanceOptions o;
  EXPECT_EQ(kind(o), 0);
  o.edge_length_mm = 0.0;
  EXPECT_EQ(kind(o), 2);
  o.edge_length_mm = -1.0;
  EXPECT_EQ(kind(o), 2);
  o.edge_length_mm = 0.001;  // a billion triangles
  EXPECT_EQ(kind(o), 2);
  o.edge_length_mm = 2.0;
  o.gradation = 1;
  EXPECT_EQ(kind(o), 2);
}

TEST(EnhanceComplex, ItIsSaidWhereEdgesStayShorterAndWhy) {
  const auto told = [](const InterfaceComplex& c, double edge_mm) {
    EnhanceOptions o;
    o.edge_length_mm = edge_mm;
    Monitor quiet;
    std::string all;
    for (const Warning& w : enhance_complex(c, o, quiet).warnings) all += w.text + "\n";
    return all;
  };
  EXPECT_EQ(told(ball(10, 4), 2).find("shorter than"), std::string::npos);
  const std::string plates = told(two_plates(20, 0.5, 5), 5);
  EXPECT_NE(plates.find("shorter than the 5 mm"), std::string::npos) << plates;
  EXPECT_NE(plates.find("% where walls are thin"), std::string::npos) << plates;
}

TEST(EnhanceComplex, SaysSoWhenTheEdgeLengthIsTooLarge) {
  EnhanceOptions o;
  o.edge_length_mm = 100;
  const InterfaceComplex c = ball(10, 3);
  const EnhanceResult r = enhance(c, o);
  EXPECT_EQ(broken(c, r), "");
  EXPECT_EQ(r.level, SurfaceLevel::enhanced);
  EXPECT_TRUE(is_named(r.warnings, 1));
}
