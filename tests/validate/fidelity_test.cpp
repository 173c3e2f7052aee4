#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <gtest/gtest.h>

#include <random>

#include "base/error.h"
#include "shapes.h"
#include "validate/check_fidelity.h"

namespace stackmesh {
namespace {

using namespace test;

FidelityOptions options(int axis, int threads = 1) {
  FidelityOptions o;
  o.stack_axis = axis;
  o.threads = threads;
  return o;
}

/// Spacing, origin and an oblique frame; mirrored when asked.
void tilt(LabelVolume& v, bool mirrored) {
  v.spacing_mm = {0.8, 1.1, 2.5};
  v.origin_mm = {-100, 37.5, 1200};
  const double a = 0.3, b = 0.7;
  v.axes = {
      Vec3{std::cos(a), std::sin(a), 0}, Vec3{-std::sin(a) * std::cos(b), std::cos(a) * std::cos(b), std::sin(b)}, {}};
  v.axes[2] = (mirrored ? -1.0 : 1.0) * cross(v.axes[0], v.axes[1]);
}

TEST(CheckFidelity, VoxelNoiseMatchesItsOwnFacesInEveryFrame) {
  std::mt19937 random(21);
  for (int round = 0; round < 12; ++round) {
    LabelVolume v = empty_volume(7, 6, 5, 3);
    for (auto& voxel : v.voxels) voxel = static_cast<std::uint16_t>(random() % 4);
    if (round % 4) tilt(v, round % 2);
    for (const LabelFidelity& l : check_fidelity(voxel_surface(v), v, options(round % 3))) {
      EXPECT_EQ(l.dice, 1);
      EXPECT_EQ(l.input_voxels, l.mesh_voxels);
      EXPECT_LT(l.distance_mm.max, 1e-9);
      EXPECT_LT(l.reverse_distance_mm.max, 1e-9);
      EXPECT_EQ(l.components, l.input_components);
      EXPECT_TRUE(l.components_match);
      EXPECT_EQ(l.missing_components, 0u);
    }
  }
}

TEST(CheckFidelity, ShiftByOnePixelCostsTheExpectedDice) {
  LabelVolume v = empty_volume(14, 12, 8, 1);
  fill(v, {2, 2, 2}, {10, 9, 6}, 1);
  tilt(v, true);
  for (int axis = 0; axis < 3; ++axis) {
    InterfaceComplex c = voxel_surface(v);
    for (Vec3& p : c.points) p = p + v.spacing_mm[0] * v.axes[0];
    const LabelFidelity l = check_fidelity(c, v, options(axis))[0];
    EXPECT_DOUBLE_EQ(l.dice, 7 / 8.0);
    EXPECT_EQ(l.input_voxels, l.mesh_voxels);
    EXPECT_TRUE(l.components_match);
    EXPECT_NEAR(l.distance_mm.max, axis == 0 ? 0.4 : 0.8,
                1e-9);  // face centres at section heights: half a pixel beyond
    EXPECT_NEAR(l.reverse_distance_mm.max, 0.8, 1e-6);
  }
}

TEST(CheckFidelity, InflatedBoxHasItsDistance) {
  LabelVolume v = empty_volume(20, 20, 20, 1);
  fill(v, {5, 5, 5}, {15, 15, 15}, 1);
  const LabelFidelity l = check_fidelity(box({4.25, 4.25, 4.25}, {14.75, 14.75, 14.75}, 1), v, options(2))[0];
  EXPECT_EQ(l.dice, 1);
  EXPECT_EQ(l.distance_samples, 400u);
  EXPECT_NEAR(l.distance_mm.mean, 0.25, 1e-12);
  EXPECT_NEAR(l.distance_mm.p95, 0.25, 1e-12);
  EXPECT_NEAR(l.distance_mm.max, 0.25, 1e-12);
  EXPECT_GE(l.reverse_distance_mm.mean, 0.25);
  EXPECT_LT(l.reverse_distance_mm.mean, 0.27);
  EXPECT_LE(l.reverse_distance_mm.max, 0.25 * std::sqrt(3.0) + 1e-9);
}

TEST(CheckFidelity, SphereIsCloseToItsVoxels) {
  LabelVolume v = empty_volume(50, 50, 50, 1);
  for (int k = 0; k < 50; ++k)
    for (int j = 0; j < 50; ++j)
      for (int i = 0; i < 50; ++i) v.voxels[v.index(i, j, k)] = norm(Vec3{i - 24.3, j - 24.6, k - 24.9}) < 20;
  const LabelFidelity l = check_fidelity(icosphere(20, 5, 1, {24.3, 24.6, 24.9}), v, options(2))[0];
  EXPECT_GT(l.dice, 0.998);
  EXPECT_GT(l.distance_mm.mean, 0.1);
  EXPECT_LT(l.distance_mm.max, 0.87);
  EXPECT_GT(l.reverse_distance_mm.mean, 0.1);
  EXPECT_LT(l.reverse_distance_mm.max, 0.87);
  EXPECT_TRUE(l.components_match);
}

TEST(CheckFidelity, DistancesAgreeWithAllPairs) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  std::mt19937 random(9);
  LabelVolume v = empty_volume(8, 8, 8, 1);
  for (auto& voxel : v.voxels) voxel = random() % 3 == 0;
  v.spacing_mm = {1, 1.5, 2};
  InterfaceComplex c;
  const auto coordinate = [&] { return random() * (14.0 / 4294967296.0) - 1; };
  for (int i = 0; i < 40; ++i) c.points.push_back({coordinate(), coordinate(), coordinate()});
  for (int i = 0; i < 60; ++i) {
    const auto p = [&] { return static_cast<std::int32_t>(random() % 40); };
    InterfaceTriangle t{{p(), p(), p()}, 1, 0};
    if (t.v[0] != t.v[1] && t.v[1] != t.v[2] && t.v[0] != t.v[2]) c.triangles.push_back(t);
  }
  std::vector<double> expected;
  for (int k = 0; k < 8; ++k)
    for (int j = 0; j < 8; ++j)
      for (int i = 0; i < 8; ++i)
        for (int s = 0; s < 4; ++s) {
          const int ni = i + (s == 0) - (s == 1), nj = j + (s == 2) - (s == 3);
          const bool inside = ni >= 0 && nj >= 0 && ni < 8 && nj < 8;
          if (v.voxels[v.index(i, j, k)] == 0 || (inside && v.voxels[v.index(ni, nj, k)] == 1)) continue;
          const Vec3 p = v.world(0.5 * (i + ni), 0.5 * (j + nj), k);
          double best = 1e300;
          for (const auto& t : c.triangles) {
            const auto at = [&](int n) {
              return Kernel::Point_3(c.points[t.v[n]].x, c.points[t.v[n]].y, c.points[t.v[n]].z);
            };
            best = std::min(
                best, CGAL::squared_distance(Kernel::Point_3(p.x, p.y, p.z), Kernel::Triangle_3(at(0), at(1), at(2))));
          }
          expected.push_back(std::sqrt(best));
        }
  std::sort(expected.begin(), expected.end());
  double mean = 0;
  for (const double d : expected) mean += d / static_cast<double>(expected.size());
  const LabelFidelity l = check_fidelity(c, v, options(2))[0];
  EXPECT_EQ(l.distance_samples, expected.size());
  EXPECT_NEAR(l.distance_mm.mean, mean, 1e-9);
  EXPECT_NEAR(l.distance_mm.max, expected.back(), 1e-9);
  EXPECT_NEAR(l.distance_mm.p95, expected[static_cast<std::size_t>(std::ceil(0.95 * expected.size())) - 1], 1e-9);
}

TEST(CheckFidelity, SwappedLabelsShareNothing) {
  LabelVolume v = empty_volume(6, 4, 4, 2);
  fill(v, {1, 1, 1}, {3, 3, 3}, 1);
  fill(v, {3, 1, 1}, {5, 3, 3}, 2);
  InterfaceComplex c = voxel_surface(v);
  for (auto& t : c.triangles)
    for (Label* l : {&t.below, &t.above})
      if (*l != 0) *l = 3 - *l;
  for (const LabelFidelity& l : check_fidelity(c, v)) {
    EXPECT_EQ(l.dice, 0);
    EXPECT_EQ(l.components, 1);
    EXPECT_FALSE(l.components_match);
    EXPECT_EQ(l.missing_components, 1u);
  }
}

LabelVolume three_cubes() {
  LabelVolume v = empty_volume(15, 5, 5, 1);
  for (int i = 0; i < 3; ++i) fill(v, {1 + 5 * i, 1, 1}, {4 + 5 * i, 4, 4}, 1);
  return v;
}

TEST(CheckFidelity, LostComponentIsReported) {
  InterfaceComplex c = box({0.5, 0.5, 0.5}, {3.5, 3.5, 3.5}, 1);
  add_box(c, {10.5, 0.5, 0.5}, {13.5, 3.5, 3.5}, 1);
  const LabelFidelity l = check_fidelity(c, three_cubes())[0];
  EXPECT_EQ(l.input_components, 3);
  EXPECT_EQ(l.components, 2);
  EXPECT_EQ(l.missing_components, 1u);
  EXPECT_FALSE(l.components_match);
  EXPECT_DOUBLE_EQ(l.dice, 2 * 54.0 / (81 + 54));
}

TEST(CheckFidelity, AsManyPiecesAreNotAMatchWhenTheyAreOthers) {
  InterfaceComplex c = box({0.5, 0.5, 0.5}, {8.5, 3.5, 3.5}, 1);  // joins the first two cubes
  add_box(c, {10.5, 0.5, 0.5}, {11.4, 3.5, 3.5}, 1);              // and halves the third
  add_box(c, {11.6, 0.5, 0.5}, {13.5, 3.5, 3.5}, 1);
  const LabelFidelity l = check_fidelity(c, three_cubes())[0];
  EXPECT_EQ(l.components, 3);
  EXPECT_EQ(l.input_components, 3);
  EXPECT_EQ(l.missing_components, 0u);
  EXPECT_FALSE(l.components_match);
}

TEST(CheckFidelity, AComponentThatAPieceJoinedIsNotMissingThoughItsCentresAreLeftOut) {
  LabelVolume v = empty_volume(6, 3, 3, 1);
  fill(v, {0, 1, 1}, {2, 2, 2}, 1);
  fill(v, {3, 1, 1}, {4, 2, 2}, 1);  // its voxel reaches from 2.5 to 3.5
  for (const double end : {2.4, 2.7}) {
    const LabelFidelity l = check_fidelity(box({-0.5, 0.5, 0.5}, {end, 1.5, 1.5}, 1), v)[0];
    EXPECT_EQ(l.input_components, 2);
    EXPECT_EQ(l.components, 1);
    EXPECT_FALSE(l.components_match);
    EXPECT_EQ(l.missing_components, end < 2.5 ? 1u : 0u) << end;
    EXPECT_EQ(l.missing.size(), l.missing_components);
  }
}

TEST(CheckFidelity, SpareAndPinchedPiecesAreNotAMatch) {
  LabelVolume v = three_cubes();
  InterfaceComplex c = voxel_surface(v);
  EXPECT_TRUE(check_fidelity(c, v)[0].components_match);
  add_box(c, {-3, 0, 0}, {-2, 1, 1}, 1);  // outside of the grid
  EXPECT_EQ(check_fidelity(c, v)[0].components, 4);
  EXPECT_FALSE(check_fidelity(c, v)[0].components_match);
}

TEST(CheckFidelity, CavitiesBelongToTheSolidAroundThem) {
  LabelVolume v = empty_volume(9, 9, 9, 1);
  fill(v, {0, 0, 0}, {9, 9, 9}, 1);  // to the border of the image
  fill(v, {2, 2, 2}, {7, 7, 7}, 0);
  fill(v, {4, 4, 4}, {5, 5, 5}, 1);
  const LabelFidelity l = check_fidelity(voxel_surface(v), v, options(1))[0];
  EXPECT_EQ(l.dice, 1);
  EXPECT_EQ(l.input_components, 2);
  EXPECT_EQ(l.components, 2);
  EXPECT_TRUE(l.components_match);
}

TEST(CheckFidelity, AbsentLabelHasARowWithoutDistances) {
  LabelVolume v = empty_volume(6, 6, 6, 2);
  fill(v, {1, 1, 1}, {3, 3, 3}, 1);
  InterfaceComplex c = voxel_surface(v);
  fill(v, {4, 4, 4}, {5, 5, 5}, 2);
  const std::vector<LabelFidelity> rows = check_fidelity(c, v);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].dice, 1);
  EXPECT_EQ(rows[1].dice, 0);
  EXPECT_EQ(rows[1].missing_components, 1u);
  EXPECT_FALSE(rows[1].components_match);
  EXPECT_TRUE(std::isnan(rows[1].distance_mm.max));
  EXPECT_TRUE(std::isnan(rows[1].reverse_distance_mm.mean));
}

TEST(CheckFidelity, SamplesAreCappedAndTheThreadsDoNotShow) {
  LabelVolume v = empty_volume(60, 60, 30, 1);
  std::mt19937 random(4);
  for (auto& voxel : v.voxels) voxel = random() % 8 == 0;
  FidelityOptions o = options(2, 1);
  o.face_samples = 5000;
  o.surface_samples = 3000;
  InterfaceComplex c = voxel_surface(v);
  for (Vec3& p : c.points) p = p + Vec3{0.1, 0.2, 0.15};
  const LabelFidelity one = check_fidelity(c, v, o)[0];
  EXPECT_NEAR(static_cast<double>(one.distance_samples), 5000, 300);
  EXPECT_EQ(one.reverse_distance_samples, 3000u);
  o.threads = 2;
  const LabelFidelity many = check_fidelity(c, v, o)[0];
  EXPECT_EQ(one.dice, many.dice);
  EXPECT_EQ(one.distance_mm.mean, many.distance_mm.mean);
  EXPECT_EQ(one.reverse_distance_mm.p95, many.reverse_distance_mm.p95);
  o.face_samples = 1000000;
  EXPECT_NEAR(check_fidelity(c, v, o)[0].distance_mm.mean, one.distance_mm.mean, 0.005);
}

TEST(CheckFidelity, WrongAxisIsRefused) {
  EXPECT_THROW(check_fidelity({}, empty_volume(1, 1, 1, 0), options(3)), Error);
}

}  // namespace
}  // namespace stackmesh
