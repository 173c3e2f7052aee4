// The figures that let a smooth surface be smooth: distance outside of the band between voxel centres, voxel centres in
// the wrong label, bends; and what the verdicts make of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "shapes.h"
#include "validate/check_bends.h"
#include "validate/check_fidelity.h"
#include "validate/check_surface.h"
#include "validate/verdict.h"

namespace stackmesh {
namespace {

using namespace test;

FidelityOptions along(int axis, int threads = 1) {
  FidelityOptions o;
  o.stack_axis = axis, o.threads = threads;
  return o;
}

/// Label 1 fills the lower half of the grid.
LabelVolume half_full(bool oblique) {
  LabelVolume v = empty_volume(20, 20, 20, 1);
  fill(v, {0, 0, 0}, {20, 20, 10}, 1);
  if (!oblique) return v;
  v.spacing_mm = {0.8, 1.1, 2.5};
  v.origin_mm = {-100, 37.5, 1200};
  const double a = 0.3, b = 0.7;
  v.axes = {
      Vec3{std::cos(a), std::sin(a), 0}, Vec3{-std::sin(a) * std::cos(b), std::cos(a) * std::cos(b), std::sin(b)}, {}};
  v.axes[2] = cross(v.axes[0], v.axes[1]);
  return v;
}

/// A sheet of two triangles in the middle of the grid, far from its borders, `at` voxels above the face between full
/// and empty at its one side, `to` at the other.
InterfaceComplex sheet(const LabelVolume& v, double at, double to) {
  InterfaceComplex c;
  c.points = {v.world(5, 5, 9.5 + at), v.world(14, 5, 9.5 + to), v.world(14, 14, 9.5 + to), v.world(5, 14, 9.5 + at)};
  c.triangles = {{{0, 1, 2}, 1, 0}, {{0, 2, 3}, 1, 0}};
  return c;
}

TEST(BandDistance, APlaneIsOutsideByWhatItLeavesTheCellsBy) {
  for (const bool oblique : {false, true}) {
    const LabelVolume v = half_full(oblique);
    const double h = v.spacing_mm[2];
    for (int axis = 0; axis < 3; ++axis) {
      for (const double inside : {0.0, 0.3, -0.45, 0.5, -0.5}) {
        const BandDistance d = check_fidelity(sheet(v, inside, inside), v, along(axis))[0].band_distance_mm;
        EXPECT_EQ(d.mean, 0) << inside;
        EXPECT_EQ(d.max, 0) << inside;
        EXPECT_EQ(d.outside_share, 0) << inside;
      }
      for (const double offset : {0.75, -1.5, 4.0}) {
        const BandDistance d = check_fidelity(sheet(v, offset, offset), v, along(axis))[0].band_distance_mm;
        EXPECT_NEAR(d.mean, (std::abs(offset) - 0.5) * h, 1e-9);
        EXPECT_NEAR(d.max, (std::abs(offset) - 0.5) * h, 1e-9);
        EXPECT_EQ(d.outside_share, 1);
      }
      const BandDistance slope = check_fidelity(sheet(v, 0, 2), v, along(axis))[0].band_distance_mm;
      EXPECT_NEAR(slope.outside_share, 0.75, 1e-3);
      EXPECT_NEAR(slope.mean, 0.5625 * h, 2e-3 * h);  // the mean of x - 0.5 over 0.5 to 2, times three quarters
      EXPECT_NEAR(slope.max, 1.5 * h, 0.01 * h);
    }
  }
}

TEST(BandDistance, TheVoxelsOwnFacesAndASmoothCutAreBothPerfect) {
  // A plane that climbs by a voxel in seven: its voxels are a staircase, which lies in the band as the plane itself
  // does.
  LabelVolume v = empty_volume(30, 12, 12, 1);
  for (int k = 0; k < 12; ++k)
    for (int j = 0; j < 12; ++j)
      for (int i = 0; i < 30; ++i) v.voxels[v.index(i, j, k)] = k < 3.21 + i / 7.0;
  const LabelFidelity stairs = check_fidelity(voxel_surface(v), v, along(2))[0];
  EXPECT_EQ(stairs.band_distance_mm.max, 0);
  EXPECT_EQ(stairs.wrong_centres, 0u);
  InterfaceComplex c;
  c.points = {{0, 0, 3.21}, {29, 0, 3.21 + 29 / 7.0}, {29, 11, 3.21 + 29 / 7.0}, {0, 11, 3.21}};
  c.triangles = {{{0, 1, 2}, 1, 0}, {{0, 2, 3}, 1, 0}};
  const LabelFidelity plane = check_fidelity(c, v, along(2))[0];
  EXPECT_EQ(plane.band_distance_mm.max, 0);
  EXPECT_GT(plane.reverse_distance_mm.mean, 0.1);  // which says that the plane is bad
}

/// By looking at every cell of the grid.
struct Cell {
  Vec3 low, high;
};
std::vector<Cell> cells_of(const LabelVolume& v, int label) {
  std::vector<Cell> cells;
  const auto is = [&](int i, int j, int k) {
    return i >= 0 && j >= 0 && k >= 0 && i < v.size[0] && j < v.size[1] && k < v.size[2] &&
           v.voxels[v.index(i, j, k)] == label;
  };
  for (int k = -1; k < v.size[2]; ++k)
    for (int j = -1; j < v.size[1]; ++j)
      for (int i = -1; i < v.size[0]; ++i) {
        int n = 0;
        for (int c = 0; c < 8; ++c) n += is(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
        if (n > 0 && n < 8) cells.push_back({v.world(i, j, k), v.world(i + 1, j + 1, k + 1)});
      }
  return cells;
}
double distance_to(const std::vector<Cell>& cells, const Vec3& p) {
  double best = 1e300;
  for (const Cell& c : cells) {
    const double x = std::max({0.0, c.low.x - p.x, p.x - c.high.x}), y = std::max({0.0, c.low.y - p.y, p.y - c.high.y}),
                 z = std::max({0.0, c.low.z - p.z, p.z - c.high.z});
    best = std::min(best, x * x + y * y + z * z);
  }
  return std::sqrt(best);
}

TEST(BandDistance, AShrunkSphereAgreesWithAllCells) {
  LabelVolume v = empty_volume(30, 30, 18, 1);
  v.spacing_mm = {1, 1, 1.7};
  const Vec3 middle = {14.3, 14.6, 14.9};
  for (int k = 0; k < 18; ++k)
    for (int j = 0; j < 30; ++j)
      for (int i = 0; i < 30; ++i) v.voxels[v.index(i, j, k)] = norm(v.world(i, j, k) - middle) < 12;
  const std::vector<Cell> cells = cells_of(v, 1);
  double before = -1;
  for (const double shrunk : {0.0, 0.5, 1.0, 3.0, 6.0}) {
    const InterfaceComplex ball = icosphere(12 - shrunk, 4, 1, middle);
    const BandDistance d = check_fidelity(ball, v, along(2))[0].band_distance_mm;
    double area = 0, sum = 0, most = 0, outside = 0;
    for (const InterfaceTriangle& t : ball.triangles) {
      const Vec3 a = ball.points[t.v[0]], b = ball.points[t.v[1]], c = ball.points[t.v[2]];
      const double w = norm(cross(b - a, c - a)), x = distance_to(cells, (1.0 / 3) * (a + b + c));
      area += w, sum += w * x, most = std::max(most, x), outside += w * (x > 1e-4);
    }
    EXPECT_NEAR(d.mean, sum / area, 0.01) << shrunk;
    EXPECT_NEAR(d.max, most, 0.1) << shrunk;
    EXPECT_NEAR(d.outside_share, outside / area, 0.02) << shrunk;
    EXPECT_GT(d.mean, before);
    EXPECT_LT(d.mean, std::max(0.02, shrunk));
    before = d.mean;
  }
}

TEST(Components, OfAVoxelThatIsThinMayLieALittleBesideIt) {
  LabelVolume v = empty_volume(7, 7, 7, 1);
  v.spacing_mm = {1, 1, 0.2};
  v.voxels[v.index(3, 3, 3)] = 1;
  const Vec3 middle = v.world(3, 3, 3);
  const auto at = [&](double beside_mm) {
    return check_fidelity(icosphere(0.09, 2, 1, {middle.x, middle.y, middle.z + beside_mm}), v, along(2))[0];
  };
  // the voxel ends 0.1 above its centre; half of its longest side beyond that still is beside it
  for (const double beside : {0.0, 0.2, -0.55}) {
    EXPECT_EQ(at(beside).missing_components, 0) << beside;
    EXPECT_TRUE(at(beside).components_match) << beside;
  }
  for (const double beside : {0.65, -0.7, 1.0}) {
    EXPECT_EQ(at(beside).missing_components, 1) << beside;
    EXPECT_FALSE(at(beside).components_match) << beside;
  }
}

TEST(BandDistance, OfLabelsStoredFinerIsThatOfTheirBlocks) {
  std::mt19937 random(5);
  LabelVolume coarse = empty_volume(6, 5, 7, 2);
  coarse.spacing_mm = {2, 3, 1.5};
  for (auto& voxel : coarse.voxels) voxel = static_cast<std::uint16_t>(random() % 3);
  const int times[3] = {2, 3, 1};
  LabelVolume fine = empty_volume(12, 15, 7, 2);
  fine.spacing_mm = {1, 1, 1.5};
  fine.origin_mm = {-0.5, -1, 0};
  for (int k = 0; k < 7; ++k)
    for (int j = 0; j < 15; ++j)
      for (int i = 0; i < 12; ++i)
        fine.voxels[fine.index(i, j, k)] = coarse.voxels[coarse.index(i / times[0], j / times[1], k / times[2])];
  InterfaceComplex ball = icosphere(9, 4, 1, {5, 6, 5});
  const InterfaceComplex other = icosphere(7, 4, 2, {-2, 6, 5});
  for (const InterfaceTriangle& t : other.triangles) {
    const std::int32_t n = static_cast<std::int32_t>(ball.points.size());
    ball.triangles.push_back({{t.v[0] + n, t.v[1] + n, t.v[2] + n}, 2, 0});
  }
  ball.points.insert(ball.points.end(), other.points.begin(), other.points.end());
  for (int axis = 0; axis < 3; ++axis) {
    const auto expected = check_fidelity(ball, coarse, along(axis));
    FidelityOptions options = along(axis);
    const auto narrow = check_fidelity(ball, fine, options);
    options.band_mm = coarse.spacing_mm;
    const auto wide = check_fidelity(ball, fine, options);
    for (int l = 0; l < 2; ++l) {
      EXPECT_GT(expected[l].band_distance_mm.mean, 0.05);
      EXPECT_NEAR(wide[l].band_distance_mm.mean, expected[l].band_distance_mm.mean, 1e-9);
      EXPECT_NEAR(wide[l].band_distance_mm.max, expected[l].band_distance_mm.max, 1e-9);
      EXPECT_EQ(wide[l].band_distance_mm.outside_share, expected[l].band_distance_mm.outside_share);
      EXPECT_GT(narrow[l].band_distance_mm.mean, expected[l].band_distance_mm.mean + 0.01);
    }
  }
}

TEST(BandDistance, ManyLabelsBordersAndThreads) {
  std::mt19937 random(3);
  for (int round = 0; round < 8; ++round) {
    LabelVolume v = empty_volume(7, 6, 5, 3);
    for (auto& voxel : v.voxels) voxel = static_cast<std::uint16_t>(random() % 4);
    const InterfaceComplex faces = voxel_surface(v);
    InterfaceComplex moved = faces;
    for (Vec3& p : moved.points) p = p + Vec3{1.6, -0.7, 0.9};
    const auto one = check_fidelity(moved, v, along(round % 3, 1)), two = check_fidelity(moved, v, along(round % 3, 2));
    for (const LabelFidelity& l : check_fidelity(faces, v, along(round % 3))) EXPECT_EQ(l.band_distance_mm.max, 0);
    for (std::size_t l = 0; l < 3; ++l) {
      EXPECT_GT(one[l].band_distance_mm.max, 0);
      EXPECT_EQ(one[l].band_distance_mm.mean, two[l].band_distance_mm.mean);
      EXPECT_EQ(one[l].band_distance_mm.outside_share, two[l].band_distance_mm.outside_share);
    }
  }
  const LabelVolume none = empty_volume(4, 4, 4, 1);  // no voxels, no band
  EXPECT_TRUE(std::isnan(check_fidelity(box({0, 0, 0}, {2, 2, 2}, 1), none)[0].band_distance_mm.mean));
  EXPECT_TRUE(std::isnan(check_fidelity({}, half_full(false))[0].band_distance_mm.max));
}

TEST(WrongCentres, AreThoseLostAndThoseGained) {
  LabelVolume v = empty_volume(14, 12, 8, 2);
  fill(v, {2, 2, 2}, {10, 9, 6}, 1);
  fill(v, {11, 2, 2}, {12, 9, 6}, 2);
  InterfaceComplex c = voxel_surface(v);
  EXPECT_EQ(check_fidelity(c, v)[0].wrong_centres, 0u);
  for (Vec3& p : c.points) p.x += 1;
  const auto rows = check_fidelity(c, v);
  EXPECT_EQ(rows[0].wrong_centres, 2u * 28);  // a layer of 7 x 4 lost, one gained
  EXPECT_DOUBLE_EQ(rows[0].wrong_centres_share, 56 / 224.0);
  EXPECT_EQ(rows[1].wrong_centres, 2u * 28);
  EXPECT_DOUBLE_EQ(rows[1].wrong_centres_share, 2);
}

TEST(Bends, OfAFoldedStripAreKnown) {
  const double kDeg = 3.14159265358979323846 / 180;
  const double folds[] = {30, 50, -90}, lengths[] = {1, 2, 1.5, 0.5};
  InterfaceComplex c;
  double x = 0, z = 0, heading = 0, weight = 0;
  for (int k = 0; k <= 4; ++k) {
    c.points.push_back({x, 0, z}), c.points.push_back({x, 3, z});
    if (k == 4) break;
    const std::int32_t n = 2 * k;
    c.triangles.push_back({{n, n + 2, n + 3}, 1, 0}), c.triangles.push_back({{n, n + 3, n + 1}, 1, 0});
    x += lengths[k] * std::cos(heading * kDeg), z += lengths[k] * std::sin(heading * kDeg);
    weight += std::sqrt(lengths[k] * lengths[k] + 9);
    if (k < 3) heading += folds[k], weight += 3;
  }
  const BendCheck b = check_bends(c);
  ASSERT_EQ(b.labels.size(), 1u);
  for (const Bends& bends : {b.surface, b.labels[0].bends}) {
    EXPECT_EQ(bends.edges, 7u);  // three folds, four diagonals
    EXPECT_NEAR(bends.mean_deg, 3 * (30 + 50 + 90) / weight, 1e-9);
    EXPECT_DOUBLE_EQ(bends.above_40_share, 2 / 7.0);
  }
}

TEST(Bends, AFoldUponItselfIsHalfATurn) {
  InterfaceComplex c;
  c.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 1e-12}, {0, 1, 0}};
  c.triangles = {{{0, 1, 2}, 1, 0}, {{1, 0, 3}, 1, 0}};
  EXPECT_NEAR(check_bends(c).surface.mean_deg, 180, 1e-6);
  EXPECT_TRUE(std::isnan(check_bends({}).surface.mean_deg));
}

TEST(Bends, OfTouchingCubesCountEachPairOnceForTheWhole) {
  LabelVolume v = empty_volume(4, 3, 3, 2);
  fill(v, {1, 1, 1}, {2, 2, 2}, 1);
  fill(v, {2, 1, 1}, {3, 2, 2}, 2);
  const BendCheck b = check_bends(voxel_surface(v));
  ASSERT_EQ(b.labels.size(), 2u);
  for (const LabelBends& l : b.labels) {
    EXPECT_EQ(l.bends.edges, 18u);
    EXPECT_NEAR(l.bends.mean_deg, 90 * 12 / (12 + 6 * std::sqrt(2.0)), 1e-9);
    EXPECT_DOUBLE_EQ(l.bends.above_40_share, 12 / 18.0);
  }
  EXPECT_EQ(b.surface.edges, 35u);  // the diagonal of the shared face once
  EXPECT_NEAR(b.surface.mean_deg, 90 * 24 / (24 + 11 * std::sqrt(2.0)), 1e-9);
}

TEST(Bends, CubesThatTouchAlongAnEdgeAreTwoCubes) {
  LabelVolume v = empty_volume(4, 4, 3, 1);
  fill(v, {1, 1, 1}, {2, 2, 2}, 1);
  fill(v, {2, 2, 1}, {3, 3, 2}, 1);
  const InterfaceComplex c = voxel_surface(v);
  const SurfaceCheck s = check_surface(c);
  EXPECT_EQ(s.nonmanifold_edges, 1u);
  EXPECT_EQ(s.labels[0].nonmanifold_edges, 1u);
  const BendCheck b = check_bends(c, 2);
  EXPECT_EQ(b.surface.edges, 36u);
  EXPECT_NEAR(b.surface.mean_deg, 90 * 24 / (24 + 12 * std::sqrt(2.0)), 1e-9);
}

TEST(Bends, FallWithTheSizeOfTheTrianglesAndNotWithTheThreads) {
  const InterfaceComplex fine = icosphere(10, 4, 1), coarse = icosphere(10, 3, 1);
  EXPECT_NEAR(check_bends(coarse).surface.mean_deg / check_bends(fine).surface.mean_deg, 2, 0.02);
  EXPECT_EQ(check_bends(fine, 1).surface.mean_deg, check_bends(fine, 2).surface.mean_deg);
  EXPECT_EQ(check_bends(fine).surface.above_40_share, 0);
}

// ---- verdicts

struct Judgement {
  SurfaceCheck surface;
  std::vector<LabelFidelity> fidelity{1};
  BendCheck bends;
  Limits limits;

  Judgement() {
    surface.labels.resize(1);
    LabelFidelity& f = fidelity[0];
    surface.labels[0].label = f.label = 1;
    surface.labels[0].closed = true;
    f.input_voxels = f.mesh_voxels = 1000;
    f.dice = 1, f.components_match = true;
    bends.labels = {{1, {100, 3, 0}}};
    bends.surface = bends.labels[0].bends;
  }
  Status of(const std::string& id) const {
    JudgeInput in;
    in.surface = &surface, in.fidelity = &fidelity, in.bends = &bends;
    in.labels = {{1, ""}};
    in.pixel_mm = 1, in.voxel_mm = 2;
    for (const Verdict& v : judge(in, limits))
      if (v.id == id) return v.status;
    ADD_FAILURE() << "no verdict " << id;
    return Status::fail;
  }
};

TEST(Verdicts, DistanceToVoxelFacesHasNoneUnlessALimitIsSet) {
  Judgement j;
  j.fidelity[0].distance_mm = j.fidelity[0].reverse_distance_mm = {5, 30, 100};
  EXPECT_EQ(j.of("fidelity"), Status::pass);
  j.limits.p95_distance_warn_px = 10;
  EXPECT_EQ(j.of("fidelity"), Status::warn);
  j.limits.mean_distance_fail_px = 1;
  EXPECT_EQ(j.of("fidelity"), Status::fail);
}

TEST(Verdicts, FidelityFollowsTheBandAndTheWrongCentres) {
  const auto with = [](double mean, double max, double wrong) {
    Judgement j;
    j.fidelity[0].band_distance_mm = {mean, max, 0.5};
    j.fidelity[0].wrong_centres_share = wrong;
    return j;
  };
  EXPECT_EQ(with(0.19, 3.9, 0.09).of("fidelity"), Status::pass);
  EXPECT_EQ(with(0.21, 0, 0).of("fidelity"), Status::warn);  // a tenth of a voxel of 2 mm
  EXPECT_EQ(with(1.1, 0, 0).of("fidelity"), Status::fail);
  EXPECT_EQ(with(0, 4.1, 0).of("fidelity"), Status::warn);
  EXPECT_EQ(with(0, 21, 0).of("fidelity"), Status::fail);
  EXPECT_EQ(with(0, 0, 0.11).of("fidelity"), Status::warn);
  EXPECT_EQ(with(0, 0, 0.31).of("fidelity"), Status::fail);
  Judgement small = with(9, 90, 0.9);
  small.fidelity[0].input_voxels = 100;
  EXPECT_EQ(small.of("fidelity"), Status::warn);
}

TEST(Verdicts, RoughnessWarnsAndNeverFails) {
  Judgement j;
  EXPECT_EQ(j.of("roughness"), Status::pass);
  j.bends.labels[0].bends.above_40_share = 1;
  EXPECT_EQ(j.of("roughness"), Status::warn);
  j.limits.bends_warn_share = 1;
  EXPECT_EQ(j.of("roughness"), Status::pass);
}

}  // namespace
}  // namespace stackmesh
