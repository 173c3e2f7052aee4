// Labels that are stored finer than they were made.
#include "fair/true_grid.h"

#include <gtest/gtest.h>

#include <cmath>

namespace stackmesh {
namespace {

/// A ball on a grid of cubes of 2 mm, off its centre.
LabelVolume ball() {
  LabelVolume v;
  v.size = {24, 24, 24};
  v.spacing_mm = {2, 2, 2};
  v.origin_mm = {-23, -23, -23};
  v.labels = {{0, ""}, {1, ""}};
  for (int k = 0; k < 24; ++k)
    for (int j = 0; j < 24; ++j)
      for (int i = 0; i < 24; ++i) v.voxels.push_back(norm(v.world(i, j, k) - Vec3{0.3, 0.6, -0.4}) < 17);
  return v;
}

/// The nearest label of `v` at the centres of a grid of that spacing, which starts `skip` of it within the volume.
LabelVolume resampled(const LabelVolume& v, std::array<double, 3> spacing, double skip = 0) {
  LabelVolume out = v;
  out.spacing_mm = spacing;
  std::array<double, 3> low;
  for (int a = 0; a < 3; ++a) {
    const double extent = v.size[a] * v.spacing_mm[a];
    // of the first centre, from the centre of v's first voxel
    low[a] = -0.5 * v.spacing_mm[a] + (skip + 0.5) * spacing[a];
    out.size[a] = static_cast<int>(std::floor((extent - skip * spacing[a]) / spacing[a]));
  }
  out.origin_mm = v.origin_mm + Vec3{low[0], low[1], low[2]};
  out.voxels.clear();
  const auto nearest = [&](int axis, int i) {
    return std::min(v.size[axis] - 1,
                    static_cast<int>(std::floor((low[axis] + i * spacing[axis]) / v.spacing_mm[axis] + 0.5)));
  };
  for (int k = 0; k < out.size[2]; ++k)
    for (int j = 0; j < out.size[1]; ++j)
      for (int i = 0; i < out.size[0]; ++i)
        out.voxels.push_back(v.voxels[v.index(nearest(0, i), nearest(1, j), nearest(2, k))]);
  return out;
}

void expect_ball(const TrueGrid& grid, double tolerance_mm) {
  const LabelVolume v = ball();
  const LabelVolume& g = grid.volume;
  // Every true voxel that lies within the stored grid has its label again, at its place.
  std::size_t different = 0;
  for (int k = 0; k < g.size[2]; ++k)
    for (int j = 0; j < g.size[1]; ++j)
      for (int i = 0; i < g.size[0]; ++i) {
        const Vec3 p = g.world(i, j, k), q = (1 / 2.0) * (p - v.origin_mm);
        const int a = static_cast<int>(std::lround(q.x)), b = static_cast<int>(std::lround(q.y)),
                  c = static_cast<int>(std::lround(q.z));
        if (a < 0 || b < 0 || c < 0 || a > 23 || b > 23 || c > 23) continue;
        different += g.voxels[g.index(i, j, k)] != v.voxels[v.index(a, b, c)];
        ASSERT_LT(norm(v.world(a, b, c) - p), tolerance_mm);
      }
  EXPECT_EQ(different, 0u);
}

TEST(TrueGrid, BlocksAreRecognisedAtAnyPhase) {
  for (double skip : {0.0, 1.0}) {
    const auto grid = find_true_grid(resampled(ball(), {1, 1, 1}, skip), 1);
    ASSERT_TRUE(grid) << skip;
    EXPECT_EQ(grid->stored_per_voxel, (std::array<double, 3>{2, 2, 2}));
    EXPECT_EQ(grid->volume.spacing_mm, (std::array<double, 3>{2, 2, 2}));
    expect_ball(*grid, 1e-9);
  }
}

TEST(TrueGrid, EveryAxisStandsForItself) {
  const auto grid = find_true_grid(resampled(ball(), {2, 2.0 / 3, 0.5}), 2);
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->stored_per_voxel, (std::array<double, 3>{1, 3, 4}));
  expect_ball(*grid, 1e-9);
}

TEST(TrueGrid, ARatioThatIsNotWholeIsRecognised) {
  for (double spacing : {1.25, 0.8, 1.4}) {
    const auto grid = find_true_grid(resampled(ball(), {spacing, spacing, spacing}), 1);
    ASSERT_TRUE(grid) << spacing;
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(grid->volume.spacing_mm[a], 2, 0.04) << spacing;
    expect_ball(*grid, 0.6 * spacing);
  }
}

TEST(TrueGrid, NothingIsFoundWhereNothingIsToBeFound) {
  EXPECT_FALSE(find_true_grid(ball(), 1));
  LabelVolume box = ball();  // flat sides are no evidence
  for (int k = 0; k < 24; ++k)
    for (int j = 0; j < 24; ++j)
      for (int i = 0; i < 24; ++i)
        box.voxels[box.index(i, j, k)] = i >= 4 && i < 16 && j >= 6 && j < 18 && k >= 2 && k < 20;
  EXPECT_FALSE(find_true_grid(box, 1));
  LabelVolume empty = ball();
  std::fill(empty.voxels.begin(), empty.voxels.end(), std::uint16_t{0});
  EXPECT_FALSE(find_true_grid(empty, 1));
}

TEST(TrueGrid, OneVoxelThatBreaksABlockCounts) {
  LabelVolume v = resampled(ball(), {1, 1, 1});
  const auto at = std::find(v.voxels.begin(), v.voxels.end(), std::uint16_t{1});
  *at = 0;  // half of a block
  EXPECT_FALSE(find_true_grid(v, 1));
}

}  // namespace
}  // namespace stackmesh
