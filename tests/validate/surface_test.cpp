#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <queue>
#include <random>

#include "base/error.h"
#include "shapes.h"
#include "validate/check_surface.h"

namespace stackmesh {
namespace {

using namespace test;

const double kPi = std::acos(-1.0);

TEST(CheckSurface, UnitBoxIsMeasuredExactly) {
  const SurfaceCheck c = check_surface(box({0, 0, 0}, {1, 1, 1}, 7));
  EXPECT_EQ(c.vertices, 8u);
  EXPECT_EQ(c.triangles, 12u);
  EXPECT_EQ(c.open_edges + c.self_intersections + c.nonmanifold_edges + c.degenerate_triangles, 0u);
  EXPECT_NEAR(c.angle_min_deg, 45, 1e-12);
  EXPECT_NEAR(c.angle_median_deg, 45, 1e-12);
  EXPECT_DOUBLE_EQ(c.edge_min_mm, 1);
  EXPECT_DOUBLE_EQ(c.edge_median_mm, 1);  // 12 sides, 6 diagonals
  ASSERT_EQ(c.labels.size(), 1u);
  EXPECT_EQ(c.labels[0].label, 7);
  EXPECT_TRUE(c.labels[0].closed);
  EXPECT_EQ(c.labels[0].components, 1);
  EXPECT_EQ(c.labels[0].euler, 2);
  EXPECT_NEAR(c.labels[0].volume_mm3, 1, 1e-15);
  EXPECT_NEAR(c.labels[0].area_mm2, 6, 1e-14);
}

TEST(CheckSurface, VolumeIsExactFarFromTheOrigin) {
  const SurfaceCheck c = check_surface(box({1e6, -1e6, 1e6}, {1e6 + 1, -1e6 + 2, 1e6 + 3}, 1));
  EXPECT_NEAR(c.labels[0].volume_mm3, 6, 1e-13);
}

TEST(CheckSurface, SphereHasItsVolumeAreaAndAngles) {
  const SurfaceCheck c = check_surface(icosphere(10, 5, 1, {3, -2, 5}));
  EXPECT_NEAR(c.labels[0].volume_mm3, 4 / 3.0 * kPi * 1000, 4 / 3.0 * kPi * 1000 * 1e-3);
  EXPECT_NEAR(c.labels[0].area_mm2, 4 * kPi * 100, 4 * kPi * 100 * 1e-3);
  EXPECT_EQ(c.labels[0].euler, 2);
  EXPECT_EQ(c.self_intersections, 0u);
  EXPECT_GT(c.angle_min_deg, 50);
  EXPECT_LE(c.angle_min_deg, c.angle_p1_deg);
  EXPECT_LT(c.angle_p1_deg, c.angle_median_deg);
  EXPECT_LT(c.angle_median_deg, 60);
}

TEST(CheckSurface, AnglePercentilesAreOfTheSmallestAngles) {
  InterfaceComplex c;  // a fan of right triangles whose smallest angles are 0.4, 0.8 .. 40 degrees
  for (int i = 1; i <= 100; ++i) {
    const std::int32_t n = static_cast<std::int32_t>(c.points.size());
    const double z = 10.0 * i, angle = 0.4 * i * kPi / 180;
    c.points.insert(c.points.end(), {{0, 0, z}, {1, 0, z}, {1, std::tan(angle), z}});
    c.triangles.push_back({{n, n + 1, n + 2}, 1, 0});
  }
  const SurfaceCheck check = check_surface(c);
  EXPECT_NEAR(check.angle_min_deg, 0.4, 1e-9);
  EXPECT_NEAR(check.angle_p1_deg, 0.4, 1e-9);  // nearest rank: the first of a hundred
  EXPECT_NEAR(check.angle_median_deg, 20, 1e-9);
  EXPECT_EQ(check.open_edges, 300u);
}

TEST(CheckSurface, RemovedTriangleOpensItsThreeEdges) {
  InterfaceComplex c = icosphere(1, 2, 1);
  const auto v = c.triangles[17].v;
  c.triangles.erase(c.triangles.begin() + 17);
  const SurfaceCheck check = check_surface(c);
  EXPECT_EQ(check.open_edges, 3u);
  EXPECT_FALSE(check.labels[0].closed);
  ASSERT_EQ(check.open_edge_list.size(), 3u);
  for (const auto& e : check.open_edge_list)
    for (const auto p : e) EXPECT_NE(std::find(v.begin(), v.end(), p), v.end());
}

TEST(CheckSurface, FlippedTriangleUnbalancesItsThreeEdges) {
  InterfaceComplex c = icosphere(1, 2, 1);
  std::swap(c.triangles[17].v[0], c.triangles[17].v[1]);
  const SurfaceCheck check = check_surface(c);
  EXPECT_EQ(check.open_edges, 3u);
  EXPECT_FALSE(check.labels[0].closed);
  EXPECT_EQ(check.nonmanifold_edges, 0u);
}

TEST(CheckSurface, WrongLabelOnOneTriangleOpensBothLabels) {
  InterfaceComplex c = icosphere(1, 2, 1);
  c.triangles[3].below = 2;
  const SurfaceCheck check = check_surface(c);
  EXPECT_EQ(check.open_edges, 3u);  // an edge counts once, however many labels are open at it
  ASSERT_EQ(check.labels.size(), 2u);
  EXPECT_FALSE(check.labels[0].closed);
  EXPECT_FALSE(check.labels[1].closed);
}

TEST(CheckSurface, CrossingCubesAreClosedButIntersect) {
  InterfaceComplex c = box({0, 0, 0}, {1, 1, 1}, 1);
  add_box(c, {0.5, 0.4, 0.3}, {1.5, 1.4, 1.3}, 2);
  const SurfaceCheck check = check_surface(c);
  EXPECT_EQ(check.open_edges, 0u);
  EXPECT_GE(check.self_intersections, 12u);
  EXPECT_EQ(check.self_intersections, check.intersecting_pairs.size());
  for (const auto& p : check.intersecting_pairs) {
    EXPECT_LT(p[0], 12);
    EXPECT_GE(p[1], 12);
  }
}

TEST(CheckSurface, CubeInsideACubeDoesNotIntersect) {
  InterfaceComplex c = box({0, 0, 0}, {3, 3, 3}, 1);
  add_box(c, {1, 1, 1}, {2, 2, 2}, 2, 1);
  const SurfaceCheck check = check_surface(c);
  EXPECT_EQ(check.self_intersections, 0u);
  EXPECT_NEAR(check.labels[0].volume_mm3, 26, 1e-12);
  EXPECT_EQ(check.labels[0].components, 1);
  EXPECT_EQ(check.labels[0].euler, 4);
  EXPECT_NEAR(check.labels[1].volume_mm3, 1, 1e-12);
}

TEST(CheckSurface, CavityBelongsToItsSolidAndNestedSolidIsAnother) {
  InterfaceComplex c = box({0, 0, 0}, {5, 5, 5}, 1);
  add_box(c, {1, 1, 1}, {4, 4, 4}, 0, 1);
  SurfaceCheck check = check_surface(c);
  ASSERT_EQ(check.labels.size(), 1u);
  EXPECT_TRUE(check.labels[0].closed);
  EXPECT_EQ(check.labels[0].components, 1);
  EXPECT_NEAR(check.labels[0].volume_mm3, 125 - 27, 1e-12);
  add_box(c, {2, 2, 2}, {3, 3, 3}, 1, 0);
  check = check_surface(c);
  EXPECT_EQ(check.labels[0].components, 2);
  EXPECT_EQ(check.labels[0].euler, 6);
  EXPECT_NEAR(check.labels[0].volume_mm3, 125 - 27 + 1, 1e-12);
}

/// Two boxes with points of their own, then with common points.
struct Touching {
  SurfaceCheck apart, joined;
};
Touching touching(Vec3 low, Vec3 high) {
  InterfaceComplex c = box({0, 0, 0}, {1, 1, 1}, 1);
  add_box(c, low, high, 1);
  return {check_surface(c), check_surface(weld(c))};
}

TEST(CheckSurface, CubesThatTouchAtACorner) {
  const Touching t = touching({1, 1, 1}, {2, 2, 2});
  EXPECT_GT(t.apart.self_intersections, 0u);
  EXPECT_EQ(t.joined.self_intersections, 0u);
  EXPECT_EQ(t.joined.open_edges + t.joined.nonmanifold_edges, 0u);
  EXPECT_EQ(t.joined.labels[0].components, 2);
  EXPECT_EQ(t.joined.labels[0].euler, 3);
}

TEST(CheckSurface, CubesThatTouchAlongAnEdge) {
  const Touching t = touching({1, 1, 0}, {2, 2, 1});
  EXPECT_GT(t.apart.self_intersections, 0u);
  EXPECT_EQ(t.apart.nonmanifold_edges, 0u);
  EXPECT_EQ(t.joined.self_intersections, 0u);
  EXPECT_EQ(t.joined.open_edges, 0u);
  EXPECT_EQ(t.joined.nonmanifold_edges, 1u);
  EXPECT_TRUE(t.joined.labels[0].closed);
  EXPECT_EQ(t.joined.labels[0].components, 2);
}

TEST(CheckSurface, CubesOnOneAnotherWithPointsOfTheirOwnIntersect) {
  EXPECT_GT(touching({1, 0, 0}, {2, 1, 1}).apart.self_intersections, 0u);
  EXPECT_GT(touching({1, 0.25, 0.25}, {2, 0.75, 0.75}).apart.self_intersections, 0u);
  EXPECT_EQ(touching({1 + 1e-12, 0, 0}, {2, 1, 1}).apart.self_intersections, 0u);
}

TEST(CheckSurface, DuplicatedTriangleIsFound) {
  InterfaceComplex c = icosphere(1, 1, 1);
  c.triangles.push_back(c.triangles[5]);
  const SurfaceCheck check = check_surface(c);
  EXPECT_EQ(check.self_intersections, 1u);
  EXPECT_EQ(check.open_edges, 3u);
  EXPECT_EQ(check.nonmanifold_edges, 3u);
  ASSERT_EQ(check.intersecting_pairs.size(), 1u);
  EXPECT_EQ(check.intersecting_pairs[0], (std::array<std::int32_t, 2>{5, 80}));
}

TEST(CheckSurface, DegenerateTriangleCountsAsAnIntersection) {
  InterfaceComplex c;
  c.points = {{0, 0, 0}, {1, 1, 1}, {3, 3, 3}, {0, 0, 5}};
  c.triangles = {{{0, 1, 3}, 1, 0}, {{0, 1, 2}, 1, 0}, {{0, 0, 3}, 1, 0}};
  const SurfaceCheck check = check_surface(c);
  EXPECT_EQ(check.degenerate_triangles, 2u);
  EXPECT_EQ(check.self_intersections, 2u);
  EXPECT_EQ(check.intersecting_pairs[0], (std::array<std::int32_t, 2>{1, 1}));
  EXPECT_EQ(check.angle_min_deg, 0);
}

TEST(CheckSurface, ThreeLabelJunctionIsManifoldPerLabel) {
  LabelVolume v = empty_volume(2, 2, 1, 3);
  v.voxels = {1, 2, 3, 3};
  const SurfaceCheck check = check_surface(voxel_surface(v));
  EXPECT_EQ(check.open_edges + check.self_intersections + check.nonmanifold_edges, 0u);
  ASSERT_EQ(check.labels.size(), 3u);
  for (const LabelSurface& l : check.labels) {
    EXPECT_TRUE(l.closed);
    EXPECT_EQ(l.euler, 2);
    EXPECT_EQ(l.components, 1);
    EXPECT_NEAR(l.volume_mm3, l.label == 3 ? 2 : 1, 1e-14);
  }
}

TEST(CheckSurface, TriangleBetweenALabelAndItselfBoundsNothing) {
  InterfaceComplex c = box({0, 0, 0}, {1, 1, 1}, 1);
  c.triangles.push_back({{0, 3, 7}, 1, 1});
  const SurfaceCheck check = check_surface(c);
  EXPECT_EQ(check.open_edges + check.nonmanifold_edges, 0u);
  EXPECT_TRUE(check.labels[0].closed);
}

/// 6-connected components of each label, by flood.
std::vector<int> count_components(const LabelVolume& v) {
  std::vector<int> count(v.labels.size(), 0);
  std::vector<char> seen(v.voxels.size(), 0);
  for (int k = 0; k < v.size[2]; ++k)
    for (int j = 0; j < v.size[1]; ++j)
      for (int i = 0; i < v.size[0]; ++i) {
        if (seen[v.index(i, j, k)]) continue;
        const std::uint16_t label = v.voxels[v.index(i, j, k)];
        ++count[label];
        std::queue<std::array<int, 3>> queue({{i, j, k}});
        seen[v.index(i, j, k)] = 1;
        for (; !queue.empty(); queue.pop())
          for (int s = 0; s < 6; ++s) {
            std::array<int, 3> n = queue.front();
            n[s / 2] += s % 2 ? 1 : -1;
            if (n[s / 2] < 0 || n[s / 2] >= v.size[s / 2]) continue;
            const std::size_t at = v.index(n[0], n[1], n[2]);
            if (seen[at] || v.voxels[at] != label) continue;
            seen[at] = 1;
            queue.push(n);
          }
      }
  return count;
}

TEST(CheckSurface, VoxelNoiseHasTheVolumesAndComponentsOfItsVoxels) {
  // Every kind of pinch: edges and corners where parts of a label, and cavities, touch.
  std::mt19937 random(11);
  for (int round = 0; round < 60 && !HasFailure(); ++round) {
    LabelVolume v = empty_volume(5, 6, 5, 3);
    v.spacing_mm = {0.7, 1.3, 2.1};
    v.origin_mm = {-11.3, 5.7, 100.1};
    for (auto& voxel : v.voxels) voxel = static_cast<std::uint16_t>(round % 2 ? random() % 4 : random() % 5 / 4);
    const SurfaceCheck check = check_surface(voxel_surface(v));
    EXPECT_EQ(check.open_edges, 0u);
    EXPECT_EQ(check.self_intersections, 0u);
    EXPECT_GT(check.nonmanifold_edges, 0u);
    const std::vector<std::size_t> voxels = count_voxels(v);
    const std::vector<int> components = count_components(v);
    for (const LabelSurface& l : check.labels) {
      EXPECT_TRUE(l.closed);
      EXPECT_NEAR(l.volume_mm3, static_cast<double>(voxels[l.label]) * v.voxel_volume_mm3(), 1e-10);
      EXPECT_EQ(l.components, components[l.label]) << "label " << l.label << ", round " << round;
    }
  }
}

TEST(CheckSurface, ResultDoesNotDependOnTheThreads) {
  InterfaceComplex c = icosphere(10, 5, 1);
  std::mt19937 random(3);
  for (Vec3& p : c.points) p = p + Vec3{random() * 4e-10, random() * 4e-10, random() * 4e-10};
  const SurfaceCheck one = check_surface(c, {1, 1000}), many = check_surface(c, {2, 1000});
  EXPECT_GT(one.self_intersections, 1000u);
  EXPECT_EQ(one.intersecting_pairs.size(), 1000u);
  EXPECT_EQ(one.self_intersections, many.self_intersections);
  EXPECT_EQ(one.intersecting_pairs, many.intersecting_pairs);
  EXPECT_EQ(one.angle_p1_deg, many.angle_p1_deg);
}

TEST(CheckSurface, MissingPointsAndNotANumberAreRefused) {
  InterfaceComplex c = box({0, 0, 0}, {1, 1, 1}, 1);
  c.triangles[3].v[1] = 8;
  EXPECT_THROW(check_surface(c), Error);
  c = box({0, 0, 0}, {1, 1, 1}, 1);
  c.points[2].y = std::nan("");
  EXPECT_THROW(check_surface(c), Error);
}

TEST(CheckSurface, EmptyComplexIsNothing) {
  const SurfaceCheck check = check_surface({});
  EXPECT_EQ(check.triangles + check.open_edges + check.self_intersections, 0u);
  EXPECT_TRUE(check.labels.empty());
}

TEST(CheckSurface, MillionTrianglesTakeSeconds) {
  const InterfaceComplex c = icosphere(100, 8, 1);
  const auto begin = std::chrono::steady_clock::now();
  const SurfaceCheck check = check_surface(c, {1, 1000});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_EQ(check.self_intersections + check.open_edges, 0u);
  EXPECT_EQ(check.triangles, 1310720u);
  RecordProperty("seconds_one_thread", std::to_string(seconds));
  std::printf("[          ] %zu triangles checked in %.2f s on one thread\n", check.triangles, seconds);
  EXPECT_LT(seconds, 120);  // a guard against a quadratic slip, not a benchmark
}

}  // namespace
}  // namespace stackmesh
