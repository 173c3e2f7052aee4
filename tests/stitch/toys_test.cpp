// Small stacks whose surface is known.
#include <cmath>
#include <set>

#include "base/error.h"
#include "checks.h"
#include "planar/snap_rounding.h"
#include "random_stacks.h"
#include "sections/polygons.h"

namespace stackmesh {
namespace {

using namespace testing_support;

StitchOptions with_caps(Caps caps) {
  StitchOptions o;
  o.caps = caps;
  return o;
}

ContourPolygon box(double x0, double y0, double x1, double y1) {
  return {{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}};
}

ContourPolygon disc(double cx, double cy, double r, int n = 48) {
  ContourPolygon p;
  for (int i = 0; i < n; ++i)
    p.points.push_back({cx + r * std::cos(2 * M_PI * i / n), cy + r * std::sin(2 * M_PI * i / n)});
  return p;
}

LabelContours label_of(Label label, const std::vector<std::vector<ContourPolygon>>& sections, double gap) {
  LabelContours f;
  f.path = "toy";
  f.label = label;
  for (std::size_t k = 0; k < sections.size(); ++k) f.sections.push_back({gap * static_cast<double>(k), sections[k]});
  return f;
}

StitchResult stitch_contours(const std::vector<LabelContours>& files, const StitchOptions& options = {}) {
  std::vector<Warning> warnings;
  Monitor quiet;
  Stack stack = sections_from_contours(files, warnings);
  return stitch_sections(stack, options, quiet);
}

TEST(StitchToys, BoxOfTwoEqualSectionsHasItsVolumeExactly) {
  const StitchResult r = stitch_contours({label_of(1, {{box(0, 0, 64, 32)}, {box(0, 0, 64, 32)}}, 8)});
  EXPECT_EQ(defects(r.complex), "");
  const SurfaceCheck check = check_surface(r.complex);
  EXPECT_NEAR(surface_of(check, 1).volume_mm3, 64 * 32 * 8, 1e-9 * 64 * 32 * 8);
  EXPECT_EQ(surface_of(check, 1).euler, 2);
  EXPECT_EQ(r.complex.triangles.size(), 12u);  // no point was added
}

TEST(StitchToys, FrustumFollowsItsWalls) {
  const StitchResult r =
      stitch_contours({label_of(1, {{box(0, 0, 64, 64)}, {box(16, 16, 48, 48)}}, 8)}, with_caps(Caps::flat));
  EXPECT_EQ(defects(r.complex), "");
  // Prismatoid: (A0 + 4 Am + A1) h / 6, less what the four corners' linear ruling loses (nothing: it is ruled by
  // planes).
  EXPECT_NEAR(surface_of(check_surface(r.complex), 1).volume_mm3, (64 * 64 + 4 * 48 * 48 + 32 * 32) * 8 / 6.0, 1e-6);
}

TEST(StitchToys, LabelsThatContradictEachOtherAreReportedWhereTheyDo) {
  Stack stack;
  stack.labels = {{0, ""}, {1, ""}, {2, ""}};
  for (const double z : {0.0, 2.0}) {
    Section s;
    s.z_mm = z;
    const auto add_box = [&](std::int32_t x, Label inside, Label outside) {
      const std::int32_t first = static_cast<std::int32_t>(s.points.size());
      for (const GridPoint p : {GridPoint{x, 0}, GridPoint{x + 10, 0}, GridPoint{x + 10, 10}, GridPoint{x, 10}})
        s.points.push_back(p);
      for (std::int32_t i = 0; i < 4; ++i) s.edges.push_back({first + i, first + (i + 1) % 4, inside, outside});
    };
    add_box(0, 1, 0);
    add_box(500, 1, z > 0 ? 2 : 0);  // outside of the second one lies label 2, and nothing bounds it
    stack.sections.push_back(s);
  }
  Monitor quiet;
  try {
    stitch_sections(stack, {}, quiet);
    FAIL() << "it was stitched";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::input);
    EXPECT_NE(e.where().find("z = 2.0"), std::string::npos) << e.what();
    EXPECT_TRUE(e.where().find("(500") != std::string::npos || e.where().find("(510") != std::string::npos ||
                e.where().find("(10.0") != std::string::npos)
        << e.what();
    EXPECT_EQ(e.where().find("(0.0"), std::string::npos) << "the section's first point says nothing: " << e.what();
  }
}

TEST(StitchToys, NoGrooveUnderALabelThatCoversTwo) {
  // a|b (1, 2) beneath, c (3) above over both.
  const LabelVolume v = volume_of(
      {{"000000", "011220", "011220", "011220", "000000"}, {"000000", "033330", "033330", "033330", "000000"}}, 4);
  const Stitched s = stitch_volume(v, 0, with_caps(Caps::flat));
  EXPECT_EQ(defects(s.complex()), "");
  // c's underside must not touch the lower section anywhere over the inner part of the a|b contour (x = 3).
  std::size_t underside = 0;
  for (const InterfaceTriangle& t : s.complex().triangles) {
    if (t.above != 3 || (t.below != 1 && t.below != 2)) continue;
    for (std::int32_t i : t.v) {
      const Vec3 p = s.complex().points[i];
      if (p.x == 3 && p.y > 1 && p.y < 4) {
        EXPECT_GT(p.z, 0.5) << "groove at y = " << p.y;
        ++underside;
      }
    }
  }
  EXPECT_GT(underside, 0u);
  // a and b keep their common wall up to that sheet, so nothing is lost to the groove: 2 x 3 pixels of 4 mm each,
  // half a slice beneath and about half a gap above.
  for (Label l : {1, 2}) EXPECT_NEAR(surface_of(check_surface(s.complex()), l).volume_mm3, 2 * 3 * 4.0, 0.15 * 24);
}

TEST(StitchToys, ShiftedShellStaysAClosedShell) {
  std::vector<std::vector<ContourPolygon>> outer, inner;
  for (int k = 0; k < 5; ++k) {
    outer.push_back({disc(2.0 * k, 0, 20)});
    inner.push_back({disc(2.0 * k, 0, 17)});
  }
  const StitchResult r = stitch_contours({label_of(1, outer, 3), label_of(2, inner, 3)});
  EXPECT_EQ(defects(r.complex), "");
  const SurfaceCheck check = check_surface(r.complex);
  EXPECT_EQ(surface_of(check, 1).euler, 0);  // a tube: its ends are open rings
  EXPECT_EQ(surface_of(check, 2).euler, 2);
  const double area = 24 * std::sin(2 * M_PI / 48);  // of the 48-gon with radius 1
  EXPECT_NEAR(surface_of(check, 2).volume_mm3, area * 17 * 17 * 12, 0.02 * area * 17 * 17 * 12);
  EXPECT_NEAR(surface_of(check, 1).volume_mm3, area * (20 * 20 - 17 * 17) * 12, 0.05 * area * 111 * 12);
}

TEST(StitchToys, OnePixelInOneSectionIsKept) {
  const LabelVolume v = volume_of({{"000", "000", "000"}, {"000", "010", "000"}, {"000", "000", "000"}}, 2);
  for (Caps caps : {Caps::automatic, Caps::flat, Caps::round}) {
    const Stitched s = stitch_volume(v, 0, with_caps(caps));
    EXPECT_EQ(defects(s.complex()), "");
    const SurfaceCheck check = check_surface(s.complex());
    EXPECT_EQ(surface_of(check, 1).components, 1);
    EXPECT_EQ(surface_of(check, 1).euler, 2);
    if (caps == Caps::flat) {
      EXPECT_NEAR(surface_of(check, 1).volume_mm3, 2.0, 1e-12);
    } else {
      EXPECT_NEAR(surface_of(check, 1).volume_mm3, 2.0, 1e-12);  // two roofs of half a voxel each
    }
    for (const Vec3& p : s.complex().points)
      EXPECT_LE(std::abs(p.z - 2), (caps == Caps::flat ? 1.0 : 1.5) + 1e-12)
          << "a flat end rises half a gap, a round one three quarters";
  }
}

TEST(StitchToys, RoundEndsHoldTheirHalfGap) {
  // A disc, a box, a ring and a single pixel, each in one slice: whatever the roof looks like, it holds what the voxels
  // do.
  const auto with = [](int kind) {
    LabelVolume v;
    v.size = {24, 24, 3};
    v.spacing_mm = {1, 1, 4};
    v.labels = {{0, ""}, {1, ""}};
    v.voxels.assign(24 * 24 * 3, 0);
    for (int j = 0; j < 24; ++j)
      for (int i = 0; i < 24; ++i) {
        const double r = std::hypot(i - 11.5, j - 11.5);
        const bool in = kind == 0   ? r < 9
                        : kind == 1 ? i > 3 && i < 17 && j > 7 && j < 13
                        : kind == 2 ? r < 10 && r > 6
                                    : i == 9 && j == 9;
        v.voxels[v.index(i, j, 1)] = in;
      }
    return v;
  };
  for (int kind = 0; kind < 4; ++kind) {
    const LabelVolume v = with(kind);
    const Stitched s = stitch_volume(v, 0, with_caps(Caps::round));
    EXPECT_EQ(defects(s.complex()), "");
    const double voxels = 4.0 * static_cast<double>(count_voxels(v)[1]);
    EXPECT_NEAR(surface_of(check_surface(s.complex()), 1).volume_mm3, voxels, 1e-6 * voxels) << kind;
  }
}

TEST(StitchToys, IslandOverNothingEndsByItself) {
  const StitchResult r = stitch_contours(
      {label_of(1, {{box(0, 0, 20, 20)}, {box(0, 0, 20, 20), disc(40, 10, 5)}, {box(0, 0, 20, 20)}}, 4)});
  EXPECT_EQ(defects(r.complex), "");
  const SurfaceCheck check = check_surface(r.complex);
  EXPECT_EQ(surface_of(check, 1).components, 2);
  EXPECT_EQ(surface_of(check, 1).euler, 4);
  // The island must not lean on the far box: it rises half a gap on either side.
  for (const Vec3& p : r.complex.points) {
    if (p.x > 25) {
      EXPECT_LE(std::abs(p.z - 4), 2.0);
    }
  }
}

TEST(StitchToys, FigureEightOverTwoDiscsIsOnePieceWithoutHandles) {
  ContourPolygon eight = {{{0, 0}, {10, 0}, {12, 4}, {14, 0}, {24, 0}, {24, 10}, {14, 10}, {12, 6}, {10, 10}, {0, 10}}};
  const StitchResult r = stitch_contours({label_of(1, {{disc(5, 5, 4), disc(19, 5, 4)}, {eight}}, 5)});
  EXPECT_EQ(defects(r.complex), "");
  const SurfaceCheck check = check_surface(r.complex);
  EXPECT_EQ(surface_of(check, 1).components, 1);
  EXPECT_EQ(surface_of(check, 1).euler, 2);
}

TEST(StitchToys, HoleThatClosesLeavesACup) {
  const StitchResult r = stitch_contours(
      {label_of(1, {{disc(0, 0, 10), disc(0, 0, 5)}, {disc(0, 0, 10), disc(0, 0, 3)}, {disc(0, 0, 10)}}, 4)});
  EXPECT_EQ(defects(r.complex), "");
  EXPECT_EQ(surface_of(check_surface(r.complex), 1).euler, 2);
}

TEST(StitchToys, FlatAndRoundLabelsEndSideBySide) {
  const LabelVolume v = volume_of({{"0000000", "0111220", "0111220", "0111220", "0000000"},
                                   {"0000000", "0111220", "0111220", "0111220", "0000000"}},
                                  2);
  StitchOptions o = with_caps(Caps::round);
  o.label_caps[1] = {Caps::flat, Caps::flat};
  const Stitched s = stitch_volume(v, 0, o);
  EXPECT_EQ(defects(s.complex()), "");
  const SurfaceCheck check = check_surface(s.complex());
  EXPECT_NEAR(surface_of(check, 1).volume_mm3, 9 * 4.0, 1e-9);
  EXPECT_LT(surface_of(check, 2).volume_mm3, 6 * 4.0 - 1);
  EXPECT_GT(surface_of(check, 2).volume_mm3, 6 * 2.0 + 1);
  EXPECT_EQ(s.result.caps.at(1).high, "flat");
  EXPECT_EQ(s.result.caps.at(2).high, "round");
}

TEST(StitchToys, TouchingCornersAcrossSlicesStayApart) {
  const LabelVolume v = volume_of({{"0000", "0100", "0100", "0000"}, {"0000", "0010", "0010", "0000"}}, 1);
  const Stitched s = stitch_volume(v, 0, with_caps(Caps::flat));
  EXPECT_EQ(defects(s.complex()), "");
  const SurfaceCheck check = check_surface(s.complex());
  EXPECT_EQ(surface_of(check, 1).components, 2);  // 6-connected, as in the image
  EXPECT_EQ(check.nonmanifold_edges, 0u);
}

TEST(StitchToys, AutomaticCapsAreFlatWhereALabelIsCutAndRoundWhereItTapers) {
  std::vector<std::vector<ContourPolygon>> sections;
  for (double r : {3.0, 8.0, 10.0, 10.0, 9.5}) sections.push_back({disc(0, 0, r)});
  const StitchResult r = stitch_contours({label_of(1, sections, 3)});
  EXPECT_EQ(r.caps.at(1).low, "round");
  EXPECT_EQ(r.caps.at(1).high, "flat");
  double top = 0, bottom = 0;
  for (const Vec3& p : r.complex.points) {
    top = std::max(top, p.z);
    bottom = std::min(bottom, p.z);
  }
  EXPECT_EQ(top, 12.0);  // plane cuts: a flat end lies on the section itself
  EXPECT_LT(bottom, -0.5);
  EXPECT_GE(bottom, -1.5);
}

TEST(SnapRounding, EightHundredNearCopiesKeepABoundedNumberOfVertices) {
  constexpr int kSections = 800, kPoints = 40;
  std::vector<std::vector<ContourPolygon>> sections;
  for (int k = 0; k < kSections; ++k) {
    ContourPolygon p = disc(0, 0, 30, kPoints);
    for (int i = 0; i < kPoints; ++i) p.points[i][0] += 1e-4 * std::sin(12.9898 * (k * kPoints + i));
    sections.push_back({p});
  }
  std::vector<Warning> warnings;
  Stack stack = sections_from_contours({label_of(1, sections, 1)}, warnings);
  snap_round(stack, 0);
  for (const Section& s : stack.sections) EXPECT_LE(s.points.size(), 6u * kPoints);
  Monitor quiet;
  EXPECT_EQ(defects(stitch_sections(stack, {}, quiet).complex), "");
}

/// Edges of neighbouring sections that are almost parallel, an offset of about the rounding grid apart.
TEST(SnapRounding, TenThousandStacksOfNearParallelEdgesCloseAndDoNotCross) {
  std::uint64_t state = 88172645463325252ull;
  const auto next = [&] {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return state;
  };
  Monitor quiet;
  for (int trial = 0; trial < 10000; ++trial) {
    Stack stack;
    stack.slices = false;
    stack.labels = {{0, ""}, {1, ""}};
    for (int k = 0; k < 2 + trial % 3; ++k) {
      Section s;
      s.z_mm = k;
      const auto wiggle = [&] { return static_cast<std::int32_t>(next() % 5) - 2; };
      const std::array<GridPoint, 4> corners = {{{0, 0}, {1000 + trial % 977, 7 + trial % 13}, {990, 400}, {3, 380}}};
      for (GridPoint c : corners) s.points.push_back({c.x + wiggle(), c.y + wiggle()});
      // A point near the middle of the long edge, so that edges nearly coincide over their whole length.
      s.points.push_back({500 + wiggle(), 3 + wiggle()});
      const std::array<int, 5> order = {0, 4, 1, 2, 3};
      for (int i = 0; i < 5; ++i) s.edges.push_back({order[i], order[(i + 1) % 5], 1, 0});
      stack.sections.push_back(s);
    }
    StitchOptions options;
    options.threads = 1;
    const StitchResult r = stitch_sections(stack, options, quiet);
    ASSERT_EQ(defects(r.complex), "") << "trial " << trial;
  }
}

}  // namespace
}  // namespace stackmesh
