// The crack contours, unsimplified: exact areas, exact counts, and the corner rule.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

#include "oracle.h"
#include "sections/extract.h"

namespace stackmesh::contour_tests {
namespace {

constexpr int kSlices = 2000;

using Crack = std::array<int, 4>;  // x0, y0, x1, y1, directed

std::vector<std::pair<Crack, std::pair<int, int>>> cracks_of(const SliceArcs& traced) {
  std::vector<std::pair<Crack, std::pair<int, int>>> cracks;
  for (const Arc& arc : traced.arcs)
    for (std::size_t i = 0; i + 1 < arc.chain.size(); ++i)
      cracks.push_back(
          {{arc.chain[i].x, arc.chain[i].y, arc.chain[i + 1].x, arc.chain[i + 1].y}, {arc.left, arc.right}});
  return cracks;
}

/// The labels to the left and right of a crack, by the image.
std::pair<int, int> sides(const Slice& s, const Crack& c) {
  const int x = std::min(c[0], c[2]), y = std::min(c[1], c[3]);
  if (c[1] == c[3]) {  // along x
    const int above = s.at(x, y), under = s.at(x, y - 1);
    return c[2] > c[0] ? std::pair(above, under) : std::pair(under, above);
  }
  const int west = s.at(x - 1, y), east = s.at(x, y);
  return c[3] > c[1] ? std::pair(west, east) : std::pair(east, west);
}

std::array<int, 4> around(const Slice& s, int x, int y) {  // SW, SE, NE, NW
  return {s.at(x - 1, y - 1), s.at(x, y - 1), s.at(x, y), s.at(x - 1, y)};
}

int degree(const Slice& s, int x, int y) {
  const auto p = around(s, x, y);
  return (p[0] != p[1]) + (p[1] != p[2]) + (p[2] != p[3]) + (p[3] != p[0]);
}

/// docs/contours.md, the table of cases, said once more: 0 stays a junction, 1 SW and NE joined, 2 NW and SE
/// joined.
int expected_join(const Slice& s, int x, int y, bool joined) {
  const auto p = around(s, x, y);
  if (p[0] == p[2] && p[0] == 0) return 1;
  if (p[3] == p[1] && p[3] == 0) return 2;
  if (p[0] == p[2] && joined) return 1;
  if (p[3] == p[1] && joined) return 2;
  return 0;
}

TEST(TraceArcs, EveryCrackIsInOneArcWithTheLabelsOfTheImage) {
  for (int seed = 0; seed < kSlices; ++seed) {
    const Slice s = random_slice(seed);
    const SliceArcs traced = trace(s, seed % 2 != 0, false);
    const auto cracks = cracks_of(traced);
    ASSERT_EQ(static_cast<std::int64_t>(cracks.size()), count_cracks(s)) << "seed " << seed;
    std::set<Crack> undirected;
    for (const auto& [c, labels] : cracks) {
      ASSERT_EQ(std::abs(c[0] - c[2]) + std::abs(c[1] - c[3]), 1) << "seed " << seed;
      ASSERT_EQ(labels, sides(s, c)) << "seed " << seed << " at " << c[0] << " " << c[1];
      ASSERT_NE(labels.first, labels.second);
      undirected.insert({std::min(c[0], c[2]), std::min(c[1], c[3]), std::max(c[0], c[2]), std::max(c[1], c[3])});
    }
    ASSERT_EQ(undirected.size(), cracks.size()) << "seed " << seed;
  }
}

TEST(TraceArcs, ArcsRunFromJunctionToJunctionAndFollowTheCornerRule) {
  for (int seed = 0; seed < kSlices; ++seed) {
    const Slice s = random_slice(seed);
    const bool joined = seed % 2 != 0;
    const auto is_junction = [&](const CrackVertex& v) {
      const int d = degree(s, v.x, v.y);
      return d == 3 || (d == 4 && expected_join(s, v.x, v.y, joined) == 0);
    };
    for (const Arc& arc : trace(s, joined, false).arcs) {
      const std::size_t n = arc.chain.size() - 1;
      ASSERT_EQ(is_junction(arc.chain[0]), !arc.closed) << "seed " << seed;
      ASSERT_EQ(is_junction(arc.chain[n]), !arc.closed) << "seed " << seed;
      ASSERT_EQ(arc.closed, arc.closed && arc.chain[0].position == arc.chain[n].position);
      for (std::size_t i = 1; i < n; ++i) {
        const CrackVertex &p = arc.chain[i - 1], &v = arc.chain[i], &q = arc.chain[i + 1];
        ASSERT_FALSE(is_junction(v)) << "seed " << seed << " at " << v.x << " " << v.y;
        ASSERT_FALSE(p.x == q.x && p.y == q.y) << "turns back, seed " << seed;
        if (degree(s, v.x, v.y) != 4) continue;
        // Joined pixels are passed by: the contour turns about one of the other two.
        const int dx = p.x + q.x - 2 * v.x, dy = p.y + q.y - 2 * v.y;  // towards the pixel in the turn
        ASSERT_NE(dx * dy, 0) << "goes straight through a corner, seed " << seed;
        ASSERT_EQ(dx * dy > 0 ? 2 : 1, expected_join(s, v.x, v.y, joined))
            << "seed " << seed << " at " << v.x << " " << v.y;
      }
    }
  }
}

TEST(TraceArcs, EachLabelIsBoundedBySimpleLoopsExceptWhereBothDiagonalsTouch) {
  std::int64_t unjoined = 0, parted = 0, parted_junctions = 0;
  for (int seed = 0; seed < kSlices; ++seed) {
    const Slice s = random_slice(seed);
    const SliceArcs traced = trace(s, seed % 2 != 0, true);
    std::set<GridPoint> may_touch;  // corners where two labels touch themselves, and none joins
    for (int y = 0; y <= s.height; ++y)
      for (int x = 0; x <= s.width; ++x)
        if (degree(s, x, y) == 4 && expected_join(s, x, y, seed % 2 != 0) == 0) {
          const bool rising = s.at(x - 1, y - 1) == s.at(x, y), falling = s.at(x - 1, y) == s.at(x, y - 1);
          if (rising && falling) may_touch.insert({x * kGridPerPixel, y * kGridPerPixel});
          parted_junctions += rising != falling;
        }
    std::map<std::pair<int, GridPoint>, int> out, in;
    for (const Edge& e : edges_of(traced, 0)) {
      ++out[{e.left, e.a}];
      ++in[{e.left, e.b}];
      ++out[{e.right, e.b}];
      ++in[{e.right, e.a}];
      parted += e.a.x % kGridPerPixel != 0;
    }
    for (const auto& [key, count] : out) {
      if (key.first == 0) continue;
      ASSERT_EQ(in[key], count) << "seed " << seed;
      ASSERT_LE(count, may_touch.count(key.second) != 0 ? 2 : 1) << "seed " << seed;
      unjoined += count == 2;
    }
  }
  EXPECT_GT(unjoined, 100) << "the slices no longer have such corners";
  EXPECT_GT(parted_junctions, 1000);
  EXPECT_GT(parted, 1000);
}

TEST(TraceArcs, PartedContoursMeetAtCommonEndsOnlyAndKeepEveryCentre) {
  for (int seed = 0; seed < 600; ++seed) {
    const Slice s = random_slice(seed, 16);
    const std::vector<Edge> edges = edges_of(trace(s, seed % 2 != 0, true), 0);
    ASSERT_EQ(count_clashes(edges), 0) << "seed " << seed;
    ASSERT_EQ(count_relabelled_centres(s, edges), 0) << "seed " << seed;
  }
}

TEST(TraceArcs, NumbersOfLabelsDoNotMatter) {
  for (int seed = 0; seed < kSlices; ++seed) {
    const Slice s = random_slice(seed);
    std::array<std::uint16_t, 9> number;
    std::iota(number.begin(), number.end(), 0);
    std::mt19937 r(seed);
    std::shuffle(number.begin() + 1, number.end(), r);
    Slice renumbered = s;
    for (std::uint16_t& p : renumbered.pixels) p = number[p];
    const SliceArcs a = trace(s, seed % 2 != 0, true), b = trace(renumbered, seed % 2 != 0, true);
    ASSERT_EQ(a.loops, b.loops);
    ASSERT_EQ(a.arcs.size(), b.arcs.size()) << "seed " << seed;
    for (std::size_t i = 0; i < a.arcs.size(); ++i) {
      ASSERT_EQ(number[a.arcs[i].left], b.arcs[i].left);
      ASSERT_EQ(number[a.arcs[i].right], b.arcs[i].right);
      ASSERT_EQ(a.arcs[i].chain.size(), b.arcs[i].chain.size());
      for (std::size_t k = 0; k < a.arcs[i].chain.size(); ++k)
        ASSERT_EQ(a.arcs[i].chain[k].position, b.arcs[i].chain[k].position) << "seed " << seed;
    }
  }
}

TEST(ExtractSections, AreasArePixelCountsExactly) {
  for (int seed = 0; seed < kSlices; ++seed) {
    const Slice s = random_slice(seed);
    LabelVolume volume = volume_of({s, s});
    volume.spacing_mm = {0.7, 1.3, 2};
    Monitor silent;
    ContourOptions options;
    options.axis = StackAxis::z;
    options.simplify_px = 0;
    options.threads = 1;
    const ContourResult result = extract_sections(volume, options, silent);
    const auto pixels = count_pixels(s);
    for (const Section& section : result.stack.sections) {
      ASSERT_EQ(static_cast<std::int64_t>(section.edges.size()), count_cracks(s)) << "seed " << seed;
      for (std::size_t l = 1; l < pixels.size(); ++l)  // the same two products, so not a bit may differ
        ASSERT_EQ(label_area_mm2(result.stack, section, volume.labels[l].number),
                  static_cast<double>(pixels[l]) * 0.7 * 1.3)
            << "seed " << seed << " label " << l;
    }
  }
}

TEST(TraceArcs, CornersOfEveryKindAreTreatedByTheTable) {
  // Background joins, whatever the two labels: two loops, or one about both.
  EXPECT_EQ(trace(slice_of({"10", "01"}), false, false).arcs.size(), 2U);
  EXPECT_EQ(trace(slice_of({"10", "02"}), true, false).arcs.size(), 2U);
  // A label joins only where its pixels hang together elsewhere: 2 and 3 then have one arc less each.
  const Slice touching = slice_of({"12", "31"});
  const SliceArcs apart = trace(touching, false, false), joined = trace(touching, true, false);
  EXPECT_EQ(apart.arcs.size(), 8U);  // four junctions on the rim and the one in the middle: 4 + 4
  EXPECT_EQ(joined.arcs.size(), 6U);
  // Four labels, three labels about a T: junctions always.
  EXPECT_EQ(trace(slice_of({"12", "34"}), true, false).arcs.size(), 8U);
  EXPECT_EQ(trace(slice_of({"11", "23"}), true, false).arcs.size(), 6U);
  // Two labels in a checkerboard: the rising diagonal wins when both could.
  const SliceArcs both = trace(slice_of({"12", "21"}), true, true);
  for (const Arc& arc : both.arcs)
    for (const CrackVertex& v : arc.chain)
      if (v.x == 1 && v.y == 1) {
        EXPECT_GT((v.position.x - 1024) * (1024 - v.position.y), 0);  // drawn towards NW or SE
      }
}

TEST(TraceArcs, ChainsOfCornersSinglePixelsAndFullSlices) {
  const Slice chain = slice_of(40, 40, [](int x, int y) { return x == y ? 1 : 0; });
  EXPECT_EQ(trace(chain, false, true).arcs.size(), 40U);  // the background passes between the pixels
  for (const Arc& arc : trace(chain, false, true).arcs) EXPECT_EQ(arc.chain.size(), 5U);
  // The same chain as background between two labels: it stays connected.
  const Slice gap = slice_of(40, 40, [](int x, int y) { return x == y ? 0 : x > y ? 1 : 2; });
  EXPECT_EQ(trace(gap, false, true).arcs.size(), 2U);
  const SliceArcs pixel = trace(slice_of({"5"}), false, true);
  ASSERT_EQ(pixel.arcs.size(), 1U);
  EXPECT_EQ(pixel.arcs[0].chain.size(), 5U);
  EXPECT_EQ(pixel.arcs[0].left, 5);  // counter-clockwise in x right, y up
  const SliceArcs full = trace(slice_of(30, 20, [](int, int) { return 3; }), false, true);
  ASSERT_EQ(full.arcs.size(), 1U);
  EXPECT_EQ(full.arcs[0].chain.size(), 101U);
  EXPECT_EQ(trace(slice_of({"000", "000"}), false, true).arcs.size(), 0U);
}

}  // namespace
}  // namespace stackmesh::contour_tests
