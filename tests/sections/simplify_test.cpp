// Simplified contours: every pixel centre keeps its label, nothing crosses, nothing vanishes, and it does get
// simpler.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "oracle.h"
#include "sections/components.h"

namespace stackmesh::contour_tests {
namespace {

constexpr double kTolerances_px[] = {0.5, 1, 2};

void expect_sound(const Slice& s, bool joined, double tolerance, const std::string& what) {
  const SliceArcs traced = trace(s, joined, true);
  const std::vector<Edge> edges = edges_of(traced, tolerance);
  std::size_t before = 0;
  for (const Arc& arc : traced.arcs) before += arc.chain.size() - 1;
  ASSERT_EQ(count_relabelled_centres(s, edges), 0) << what;
  ASSERT_EQ(count_clashes(edges), 0) << what;
  ASSERT_GE(smallest_boundary(edges), 3U) << what;
  ASSERT_LE(count_vertices(edges), before) << what;
  ASSERT_LE(edges.size(), before) << what;
}

TEST(SimplifyArcs, RandomSlicesKeepCentresAndDoNotCross) {
  for (int seed = 0; seed < 2000; ++seed) {
    const Slice s = random_slice(seed, 16);
    for (double tolerance : kTolerances_px)
      expect_sound(s, seed % 2 != 0, tolerance,
                   "seed " + std::to_string(seed) + " tolerance " + std::to_string(tolerance));
    if (HasFatalFailure()) return;
  }
}

TEST(SimplifyArcs, AwkwardShapesKeepCentresAndDoNotCross) {
  const auto ring = [](int x, int y) { return std::max(std::abs(x - 15), std::abs(y - 15)); };
  const std::vector<std::pair<const char*, Slice>> shapes = {
      {"single pixel", slice_of({"1"})},
      {"pixels in a row", slice_of({"1010101"})},
      {"one label everywhere", slice_of(25, 17, [](int, int) { return 4; })},
      {"two labels that fill the image", slice_of(25, 17, [](int x, int y) { return x + y < 20 ? 1 : 2; })},
      {"diagonal chain", slice_of(30, 30, [](int x, int y) { return x == y ? 1 : 0; })},
      {"diagonal chains of two labels", slice_of(30, 30, [](int x, int y) { return (x + y) % 2 ? 1 : 2; })},
      {"diagonal staircase", slice_of(40, 40, [](int x, int y) { return x > y ? 1 : 0; })},
      {"thin diagonal staircase", slice_of(40, 40, [](int x, int y) { return x == y || x == y + 1 ? 1 : 0; })},
      {"flat staircase", slice_of(60, 20, [](int x, int y) { return x > 7 * y ? 1 : 2; })},
      {"nested rings", slice_of(31, 31, [&](int x, int y) { return ring(x, y) % 2; })},
      {"nested rings of five labels", slice_of(31, 31, [&](int x, int y) { return ring(x, y) % 5 + 1; })},
      {"round rings", slice_of(41, 41, [](int x, int y) { return static_cast<int>(std::hypot(x - 20, y - 20)) % 4; })},
      {"sectors",
       slice_of(41, 41, [](int x, int y) { return static_cast<int>(4 + std::floor(std::atan2(y - 20.3, x - 20.7))); })},
      {"comb", slice_of(40, 20, [](int x, int y) { return y == 0 || x % 2; })},
      {"cross of slits", slice_of(21, 21, [](int x, int y) { return x == 10 || y == 10 ? 0 : 1; })}};
  for (const auto& [name, s] : shapes)
    for (double tolerance : {0.25, 0.5, 1.0, 2.0, 50.0})
      for (bool joined : {false, true}) expect_sound(s, joined, tolerance, name);
}

TEST(SimplifyArcs, NoCrackLeavesItsContourByMuchMoreThanTheTolerance) {
  // approxPolyDP keeps a vertex beyond the tolerance, then may drop vertices once more within 0.71 of it.
  double worst = 0;
  for (int seed = 0; seed < 2000; ++seed) {
    const SliceArcs traced = trace(random_slice(seed, 30), seed % 2 != 0, true);
    for (double tolerance : kTolerances_px) {
      const auto kept = simplify_arcs(traced.arcs, tolerance);
      for (std::size_t a = 0; a < kept.size(); ++a) {
        ASSERT_EQ(kept[a].front(), traced.arcs[a].chain.front().position);
        ASSERT_EQ(kept[a].back(), traced.arcs[a].chain.back().position);
        for (const CrackVertex& v : traced.arcs[a].chain) {
          double nearest = 1e9;
          for (std::size_t i = 0; i + 1 < kept[a].size(); ++i) {
            const double px = kept[a][i].x, py = kept[a][i].y, dx = kept[a][i + 1].x - px, dy = kept[a][i + 1].y - py;
            const double t =
                std::clamp(((v.position.x - px) * dx + (v.position.y - py) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
            nearest = std::min(nearest, std::hypot(px + t * dx - v.position.x, py + t * dy - v.position.y));
          }
          worst = std::max(worst, nearest / kGridPerPixel / tolerance);
        }
      }
    }
  }
  EXPECT_LE(worst, 1.71);
}

/// Crack vertices for each one that is kept.
double shrinks(const Slice& s, double tolerance) {
  const SliceArcs traced = trace(s, false, true);
  std::size_t before = 0;
  for (const Arc& arc : traced.arcs) before += arc.chain.size() - 1;
  return static_cast<double>(before) / static_cast<double>(edges_of(traced, tolerance).size());
}

TEST(SimplifyArcs, SmoothShapesShrink) {
  const Slice disc = slice_of(220, 220, [](int x, int y) { return std::hypot(x - 110.3, y - 109.6) < 100; });
  const Slice ellipse =
      slice_of(300, 120, [](int x, int y) { return std::hypot((x - 150.2) / 140, (y - 60.4) / 50) < 1 ? 2 : 1; });
  const Slice box = slice_of(100, 100, [](int x, int y) { return x > 10 && x < 90 && y > 20 && y < 70; });
  const Slice slope = slice_of(300, 60, [](int x, int y) { return 7 * y > x + 3; });
  EXPECT_EQ(shrinks(box, 0.5), 64);  // 256 cracks, 4 corners
  EXPECT_GE(shrinks(disc, 0.5), 2.1);
  EXPECT_GE(shrinks(ellipse, 0.5), 5.5);
  EXPECT_GE(shrinks(slope, 0.5), 7.5);
}

TEST(SimplifyArcs, AnArcFromAJunctionBackToItIsALoop) {
  // The two boxes of label 1 touch by a corner, and nothing is joined: one junction, two loops.
  const Slice s = slice_of(30, 30, [](int x, int y) {
    return (x >= 3 && x < 12 && y >= 4 && y < 10) || (x >= 12 && x < 20 && y >= 10 && y < 25) ? 1 : 2;
  });
  const SliceArcs traced = trace(s, false, true);
  ASSERT_EQ(traced.arcs.size(), 3U);
  for (double tolerance : kTolerances_px) EXPECT_EQ(edges_of(traced, tolerance).size(), 12U);  // three boxes
}

TEST(SimplifyArcs, ATouchingCornerIsDrawnBackAndKept) {
  const Slice box = slice_of(50, 50, [](int x, int y) { return x > 10 && x < 40 && y > 20 && y < 30; });
  CornerRules rules;
  rules.part = true;
  // by the pixels above it; by the one to its lower left
  rules.keep = {{corner_key(25, 21), 8 | 4}, {corner_key(40, 25), 1}};
  const SliceArcs traced = trace_arcs(box, rules);
  const std::vector<Edge> edges = edges_of(traced, 2);
  EXPECT_EQ(edges.size(), 6U);
  for (GridPoint p : {GridPoint{25 * 1024, 21 * 1024 + 256}, GridPoint{40 * 1024 - 256, 25 * 1024 - 256}})
    EXPECT_EQ(std::count_if(edges.begin(), edges.end(), [&](const Edge& e) { return e.a == p; }), 1);
}

TEST(SimplifyArcs, LongWindingContoursCostFarLessThanTheirSquare) {
  // 262,000 cracks in one contour (a comb), 260,000 of slanted stairs: 0.1 s where this was written.
  const int n = 512;
  const Slice comb = slice_of(n, n, [](int x, int y) { return y == 0 || x % 2; });
  const Slice slanted = slice_of(n, n, [](int x, int y) { return x == 0 || (x + y) / 2 % 2; });
  const Slice checkers = slice_of(n, n, [](int x, int y) { return (x + y) % 2; });
  for (const Slice* s : {&comb, &slanted, &checkers}) {
    const auto start = std::chrono::steady_clock::now();
    const SliceArcs traced = trace(*s, false, true);
    for (double tolerance : kTolerances_px) simplify_arcs(traced.arcs, tolerance);
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 10);
  }
}

}  // namespace
}  // namespace stackmesh::contour_tests
