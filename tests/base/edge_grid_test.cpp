// The grid of segments finds all that are near, by comparison with every one; and not nearly all.
#include "model/edge_grid.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace stackmesh {
namespace {

using Random = std::mt19937_64;
using Wide = __int128;

std::int32_t between(Random& r, std::int32_t low, std::int32_t high) {
  return static_cast<std::int32_t>(
      low + static_cast<std::int64_t>(r() % static_cast<std::uint64_t>(std::int64_t{high} - low + 1)));
}

Wide cross(GridPoint o, GridPoint a, GridPoint b) {
  return Wide{std::int64_t{a.x} - o.x} * (std::int64_t{b.y} - o.y) -
         Wide{std::int64_t{a.y} - o.y} * (std::int64_t{b.x} - o.x);
}

/// Is p within one unit of s? In integers.
bool within_one(const GridSegment& s, GridPoint p) {
  const Wide dx = std::int64_t{s.b.x} - s.a.x, dy = std::int64_t{s.b.y} - s.a.y, px = std::int64_t{p.x} - s.a.x,
             py = std::int64_t{p.y} - s.a.y;
  const Wide along = px * dx + py * dy, length2 = dx * dx + dy * dy;
  if (along <= 0) return px * px + py * py <= 1;
  const Wide qx = px - dx, qy = py - dy;
  if (along >= length2) return qx * qx + qy * qy <= 1;
  const Wide area = px * dy - py * dx;
  const Wide magnitude = area < 0 ? -area : area;
  return magnitude < (Wide{1} << 62) && magnitude * magnitude <= length2;
}

int sign(Wide v) {
  return v > 0 ? 1 : v < 0 ? -1 : 0;
}

bool meet(const GridSegment& s, const GridSegment& t) {
  if (std::max(s.a.x, s.b.x) < std::min(t.a.x, t.b.x) || std::max(t.a.x, t.b.x) < std::min(s.a.x, s.b.x) ||
      std::max(s.a.y, s.b.y) < std::min(t.a.y, t.b.y) || std::max(t.a.y, t.b.y) < std::min(s.a.y, s.b.y))
    return false;
  return sign(cross(s.a, s.b, t.a)) * sign(cross(s.a, s.b, t.b)) <= 0 &&
         sign(cross(t.a, t.b, s.a)) * sign(cross(t.a, t.b, s.b)) <= 0;
}

struct Cloud {
  std::vector<GridSegment> segments;
  std::int32_t reach;
};

Cloud random_segments(int seed) {
  Random r(seed);
  const std::int32_t reach = std::int32_t{1} << between(r, 1, 29);
  const std::int32_t length = std::max(1, reach >> between(r, 0, 12));
  const int count = between(r, 1, 80), lines = between(r, 0, 3);
  Cloud cloud{{}, reach};
  for (int i = 0; i < count; ++i) {
    const GridPoint a = {between(r, -reach, reach), between(r, -reach, reach)};
    GridPoint b = {std::clamp(a.x + between(r, -length / 2, length / 2), -reach, reach),
                   std::clamp(a.y + between(r, -length / 2, length / 2), -reach, reach)};
    if (lines == 1) b.x = a.x;
    if (lines == 2) b.y = a.y;
    cloud.segments.push_back({a, b});
  }
  return cloud;
}

TEST(EdgeGrid, MissesNothingNearAPoint) {
  std::size_t near = 0;
  for (int seed = 0; seed < 1500; ++seed) {
    const auto [segments, reach] = random_segments(seed);
    const EdgeGrid grid(segments);
    Random r(seed + 7);
    for (int q = 0; q < 60; ++q) {
      const GridSegment& s = segments[r() % segments.size()];
      GridPoint p = {between(r, -reach, reach), between(r, -reach, reach)};
      if (q % 3 != 0) {  // close to a segment
        const double t = static_cast<double>(r() >> 11) * 0x1p-53;
        p.x = static_cast<std::int32_t>(s.a.x + t * (static_cast<double>(s.b.x) - s.a.x)) + between(r, -1, 1);
        p.y = static_cast<std::int32_t>(s.a.y + t * (static_cast<double>(s.b.y) - s.a.y)) + between(r, -1, 1);
      }
      std::set<std::int32_t> found;
      grid.near_point(p, [&](std::int32_t i) { found.insert(i); });
      for (std::size_t i = 0; i < segments.size(); ++i)
        if (within_one(segments[i], p)) {
          ++near;
          ASSERT_EQ(found.count(static_cast<std::int32_t>(i)), 1U) << "seed " << seed << " segment " << i;
        }
    }
  }
  EXPECT_GT(near, 20000U);
}

TEST(EdgeGrid, MissesNothingThatASegmentMeets) {
  std::size_t met = 0;
  for (int seed = 0; seed < 1500; ++seed) {
    const auto [segments, reach] = random_segments(seed);
    const EdgeGrid grid(segments);
    Random r(seed + 7);
    for (int q = 0; q < 40; ++q) {
      // Across, beside, and past the cloud.
      const std::int32_t far =
          q % 2 != 0 ? reach : static_cast<std::int32_t>(std::min<std::int64_t>(std::int64_t{3} * reach, 1 << 29));
      const GridSegment s = q % 4 == 0 ? segments[r() % segments.size()]
                                       : GridSegment{{between(r, -far, far), between(r, -far, far)},
                                                     {between(r, -far, far), between(r, -far, far)}};
      std::set<std::int32_t> found;
      grid.near_segment(s, [&](std::int32_t i) { found.insert(i); });
      for (std::size_t i = 0; i < segments.size(); ++i)
        if (meet(segments[i], s)) {
          ++met;
          ASSERT_EQ(found.count(static_cast<std::int32_t>(i)), 1U) << "seed " << seed << " segment " << i;
        }
    }
  }
  EXPECT_GT(met, 20000U);
}

TEST(EdgeGrid, MissesNothingThatABoxMeets) {
  std::size_t met = 0;
  for (int seed = 0; seed < 1500; ++seed) {
    const auto [segments, reach] = random_segments(seed);
    const EdgeGrid grid(segments);
    Random r(seed + 7);
    for (int q = 0; q < 40; ++q) {
      const GridPoint a = {between(r, -reach, reach), between(r, -reach, reach)},
                      b = {between(r, -reach, reach), between(r, -reach, reach)};
      const GridPoint low = {std::min(a.x, b.x), std::min(a.y, b.y)}, high = {std::max(a.x, b.x), std::max(a.y, b.y)};
      const auto inside = [&](GridPoint p) { return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y; };
      std::set<std::int32_t> found;
      grid.near_box(low, high, [&](std::int32_t i) { found.insert(i); });
      for (std::size_t i = 0; i < segments.size(); ++i) {
        const GridSegment& s = segments[i];
        if (!inside(s.a) && !inside(s.b) && !meet(s, {low, high}) && !meet(s, {{low.x, high.y}, {high.x, low.y}}))
          continue;
        ++met;
        ASSERT_EQ(found.count(static_cast<std::int32_t>(i)), 1U) << "seed " << seed << " segment " << i;
      }
    }
  }
  EXPECT_GT(met, 20000U);
}

TEST(EdgeGrid, VisitsFewOfManyShortSegments) {
  Random r(1);
  std::vector<GridSegment> segments;
  for (int i = 0; i < 20000; ++i) {
    const GridPoint a = {between(r, 0, 1000000), between(r, 0, 1000000)};
    segments.push_back({a, {a.x + between(r, -5000, 5000), a.y + between(r, -5000, 5000)}});
  }
  const EdgeGrid grid(segments);
  std::size_t by_point = 0, by_segment = 0;
  for (const GridSegment& s : segments) {
    grid.near_point(s.a, [&](std::int32_t) { ++by_point; });
    grid.near_segment(s, [&](std::int32_t) { ++by_segment; });
  }
  EXPECT_LT(by_point, 10 * segments.size());
  EXPECT_LT(by_segment, 20 * segments.size());
}

TEST(EdgeGrid, HoldsNoneOrOne) {
  const EdgeGrid none(std::vector<GridSegment>{});
  none.near_point({0, 0}, [](std::int32_t) { ADD_FAILURE(); });
  none.near_segment({{0, 0}, {5, 5}}, [](std::int32_t) { ADD_FAILURE(); });
  none.near_box({0, 0}, {5, 5}, [](std::int32_t) { ADD_FAILURE(); });
  int found = 0;
  const EdgeGrid point(std::vector<GridSegment>{{{3, 3}, {3, 3}}});
  for (int y = 2; y <= 4; ++y)
    for (int x = 2; x <= 4; ++x) point.near_point({x, y}, [&](std::int32_t) { ++found; });
  EXPECT_GE(found, 5);
}

TEST(ProperlyCross, IsTrueForInteriorCrossingsOnly) {
  Random r(3);
  int crossings = 0;
  for (int n = 0; n < 200000; ++n) {
    const std::int32_t reach = n % 2 != 0 ? 4 : 1 << 29;
    const auto point = [&] { return GridPoint{between(r, -reach, reach), between(r, -reach, reach)}; };
    const GridSegment s = {point(), point()}, t = {point(), point()};
    const bool expected = sign(cross(s.a, s.b, t.a)) * sign(cross(s.a, s.b, t.b)) < 0 &&
                          sign(cross(t.a, t.b, s.a)) * sign(cross(t.a, t.b, s.b)) < 0;
    ASSERT_EQ(properly_cross(s, t), expected) << n;
    crossings += expected;
  }
  EXPECT_GT(crossings, 20000);
}

}  // namespace
}  // namespace stackmesh
