// Components and the corners where they nearly meet, against a flood fill.
#include "sections/components.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "random_stacks.h"

namespace stackmesh::contour_tests {
namespace {

/// 6-connected components by flooding; 0 is background.
std::vector<int> flood(const LabelVolume& v) {
  std::vector<int> component(v.voxels.size(), 0);
  int count = 0;
  for (std::size_t seed = 0; seed < v.voxels.size(); ++seed) {
    if (v.voxels[seed] == 0 || component[seed] != 0) continue;
    std::vector<std::array<int, 3>> todo = {{static_cast<int>(seed) % v.size[0],
                                             static_cast<int>(seed) / v.size[0] % v.size[1],
                                             static_cast<int>(seed) / v.size[0] / v.size[1]}};
    component[seed] = ++count;
    while (!todo.empty()) {
      const std::array<int, 3> at = todo.back();
      todo.pop_back();
      for (int axis = 0; axis < 3; ++axis)
        for (int step : {-1, 1}) {
          std::array<int, 3> to = at;
          to[axis] += step;
          if (to[axis] < 0 || to[axis] >= v.size[axis]) continue;
          const std::size_t i = v.index(to[0], to[1], to[2]);
          if (v.voxels[i] != v.voxels[seed] || component[i] != 0) continue;
          component[i] = count;
          todo.push_back(to);
        }
    }
  }
  return component;
}

std::array<int, 3> voxel(const StackAxes& axes, int x, int y, int k) {
  std::array<int, 3> ijk;
  ijk[axes.u] = x;
  ijk[axes.v] = y;
  ijk[axes.w] = k;
  return ijk;
}

TEST(VoxelComponents, AreThoseOfAFloodFill) {
  std::size_t components = 0;
  for (int seed = 0; seed < 600; ++seed) {
    const LabelVolume v = testing_support::random_volume(seed);
    const std::vector<int> expected = flood(v);
    const StackAxes axes = axes_for(seed % 3);
    const VoxelComponents found(v, axes);
    std::map<int, int> there, back;  // one to one
    for (int k = 0; k < v.size[axes.w]; ++k)
      for (int y = 0; y < v.size[axes.v]; ++y)
        for (int x = 0; x < v.size[axes.u]; ++x) {
          const auto [i, j, l] = voxel(axes, x, y, k);
          const int e = expected[v.index(i, j, l)];
          if (e == 0) continue;
          const int f = found.of(x, y, k);
          ASSERT_EQ(there.emplace(e, f).first->second, f) << "seed " << seed;
          ASSERT_EQ(back.emplace(f, e).first->second, e) << "seed " << seed;
        }
    components += there.size();
  }
  EXPECT_GT(components, 6000U);
}

TEST(VoxelComponents, TouchingCornersAreThoseSharedByTwoComponentsOfALabel) {
  std::size_t corners = 0;
  for (int seed = 0; seed < 600; ++seed) {
    const LabelVolume v = testing_support::random_volume(seed);
    const std::vector<int> component = flood(v);
    const StackAxes axes = axes_for(seed % 3);
    const VoxelComponents components(v, axes);
    const int width = v.size[axes.u], height = v.size[axes.v], count = v.size[axes.w];
    const std::vector<Slice> slices = read_slices(v, axes, 0, count);
    const auto at = [&](int x, int y, int k) -> std::size_t {
      const auto [i, j, l] = voxel(axes, x, y, k);
      return v.index(i, j, l);
    };
    for (int k = 0; k < count; ++k)
      for (int other : {k - 1, k + 1}) {
        if (other < 0 || other >= count) continue;
        std::set<std::uint64_t> expected;
        for (int cy = 0; cy <= height; ++cy)
          for (int cx = 0; cx <= width; ++cx)  // any two of the voxels about the corner
            for (int a = 0; a < 4; ++a)
              for (int b = 0; b < 4; ++b) {
                const int xa = cx - a % 2, ya = cy - a / 2, xb = cx - b % 2, yb = cy - b / 2;
                if (std::min({xa, ya, xb, yb}) < 0 || std::max(xa, xb) >= width || std::max(ya, yb) >= height) continue;
                const std::size_t i = at(xa, ya, k), j = at(xb, yb, other);
                if (v.voxels[i] != 0 && v.voxels[i] == v.voxels[j] && component[i] != component[j])
                  expected.insert(corner_key(cx, cy));
              }
        std::vector<TouchingCorner> found;
        touching_corners(components, slices[k], k, slices[other], other, found);
        unite(found);
        std::set<std::uint64_t> keys;
        for (const TouchingCorner& c : found) {
          keys.insert(c.key);
          // The pixels that touch are of this slice and of the label that touches.
          ASSERT_NE(c.quadrants, 0);
          const int cx = static_cast<int>(c.key & 0xffffffffu), cy = static_cast<int>(c.key >> 32);
          for (int q = 0; q < 4; ++q)
            if (c.quadrants >> q & 1) ASSERT_NE(slices[k].at(cx - 1 + q % 2, cy - 1 + q / 2), 0);
        }
        ASSERT_EQ(keys, expected) << "seed " << seed << " slice " << k;
        corners += expected.size();
      }
  }
  EXPECT_GT(corners, 1000U);
}

TEST(ReadSlices, HasTheVoxelsOfTheVolumeAlongEveryAxis) {
  LabelVolume v;
  v.size = {37, 70, 41};
  for (std::size_t i = 0; i < 37U * 70 * 41; ++i) v.voxels.push_back(static_cast<std::uint16_t>(i * 40503U));
  for (int axis = 0; axis < 3; ++axis) {
    const StackAxes axes = axes_for(axis);
    const std::vector<Slice> slices = read_slices(v, axes, 2, 37);
    ASSERT_EQ(slices.size(), 35U);
    for (int k = 2; k < 37; ++k)
      for (int y = 0; y < v.size[axes.v]; ++y)
        for (int x = 0; x < v.size[axes.u]; ++x) {
          const auto [i, j, l] = voxel(axes, x, y, k);
          ASSERT_EQ(slices[k - 2].at(x, y), v.voxels[v.index(i, j, l)]);
        }
  }
}

TEST(ReadSlices, RunsEndWhereTheLabelChanges) {
  for (int length = 1; length < 20; ++length)
    for (int start = 0; start < 6; ++start) {
      std::vector<std::uint16_t> row(30, 7);
      std::fill_n(row.begin() + start, length, 300);
      EXPECT_EQ(run_end(row.data(), start, 30), start + length);
      EXPECT_EQ(run_end(row.data(), start, start + length), start + length);
      EXPECT_EQ(run_end(row.data(), start + length, 30), 30);
    }
}

}  // namespace
}  // namespace stackmesh::contour_tests
