// Drawn contours: what was drawn is what comes out.
#include <cmath>
#include <map>
#include <random>

#include "checks.h"
#include "sections/polygons.h"
#include "sections/virtual_sections.h"
#include "validate/boundaries.h"

namespace stackmesh {
namespace {

using namespace testing_support;

ContourPolygon box(double x0, double y0, double x1, double y1) {
  return {{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}};
}

ContourPolygon disc(double cx, double cy, double r, int n = 64) {
  ContourPolygon p;
  for (int i = 0; i < n; ++i)
    p.points.push_back({cx + r * std::cos(2 * M_PI * i / n), cy + r * std::sin(2 * M_PI * i / n)});
  return p;
}

double disc_area(double r, int n = 64) {
  return 0.5 * n * std::sin(2 * M_PI / n) * r * r;
}

LabelContours file_of(Label label, const std::vector<double>& heights,
                      const std::function<std::vector<ContourPolygon>(double)>& at) {
  LabelContours f;
  f.path = "drawn";
  f.label = label;
  for (double z : heights) f.sections.push_back({z, at(z)});
  return f;
}

std::vector<double> every(double gap, int n, double first = 0) {
  std::vector<double> z;
  for (int k = 0; k < n; ++k) z.push_back(first + gap * k);
  return z;
}

struct Made {
  Stack stack;
  StitchResult result;
  SurfaceCheck check;
  std::vector<Warning> warnings;
  std::array<double, 2> heights(Label label) const {
    std::array<double, 2> z = {1e300, -1e300};
    for (const InterfaceTriangle& t : result.complex.triangles)
      if (t.below == label || t.above == label)
        for (std::int32_t v : t.v) {
          z[0] = std::min(z[0], result.complex.points[v].z);
          z[1] = std::max(z[1], result.complex.points[v].z);
        }
    return z;
  }
  double volume(Label label) const { return surface_of(check, label).volume_mm3; }
};

ContourStackOptions slices() {
  ContourStackOptions o;
  o.slices = true;
  o.fill_missing = o.repair = true;
  return o;
}

Made make(const std::vector<LabelContours>& files, ContourStackOptions options = {},
          std::optional<int> per_gap = std::nullopt, Caps caps = Caps::automatic) {
  Made m;
  options.caps = caps;
  m.stack = sections_from_contours(files, m.warnings, options);
  add_virtual_sections(m.stack, per_gap, 1, m.warnings);
  StitchOptions o;
  o.caps = caps;
  o.threads = 1;
  Monitor quiet;
  m.result = stitch_sections(m.stack, o, quiet);
  m.check = check_surface(m.result.complex, {1});
  EXPECT_EQ(defects(m.result.complex), "");
  return m;
}

TEST(DrawnDetail, APixelComesFromWhatWasDrawnNotFromLongEdges) {
  const auto pixel = [](const std::function<std::vector<ContourPolygon>(double)>& at) {
    std::vector<Warning> w;
    return sections_from_contours({file_of(1, {0, 3, 6}, at)}, w).pixel_mm;
  };
  EXPECT_NEAR(pixel([](double) { return std::vector{box(-50, -50, 50, 50)}; }), 100.0 / 24, 0.01);
  // A wall of 4 mm in that box asks for finer ones; a dense outline keeps its own edges.
  EXPECT_NEAR(pixel([](double) { return std::vector{box(-50, -50, 50, 50), box(-46, -46, 46, 46)}; }), 2, 0.01);
  EXPECT_NEAR(pixel([](double) { return std::vector{disc(0, 0, 30, 150)}; }), 60 * std::sin(M_PI / 150), 0.01);
}

TEST(DrawnCopies, CountOnceHoweverTheyAreWritten) {
  const auto rotated = [](ContourPolygon p) {
    std::rotate(p.points.begin(), p.points.begin() + 17, p.points.end());
    return p;
  };
  const auto reversed = [](ContourPolygon p) {
    std::reverse(p.points.begin(), p.points.end());
    return p;
  };
  const auto twice_round = [](ContourPolygon p) {
    const auto once = p.points;
    p.points.insert(p.points.end(), once.begin(), once.end());
    return p;
  };
  const ContourPolygon a = disc(0, 0, 20);
  const double volume = disc_area(20) * 24;
  const std::vector<std::vector<ContourPolygon>> drawn = {
      {a, a},           {a, rotated(a)},       {a, reversed(a)},
      {twice_round(a)}, {a, disc(0.1, 0, 20)}, {a, disc(0.02, 0.03, 20.03, 61)}};
  for (std::size_t which = 0; which < drawn.size(); ++which)
    for (int where : {3, 7, -1}) {  // one section, the last one, all
      LabelContours f = file_of(1, every(3, 8), [&](double) { return std::vector{a}; });
      for (int k = 0; k < 8; ++k)
        if (k == where || where < 0) f.sections[k].polygons = drawn[which];
      const Made m = make({f}, slices());
      EXPECT_NEAR(m.volume(1), volume, 0.005 * volume) << which << " " << where;
      EXPECT_EQ(surface_of(m.check, 1).components, 1);
      ASSERT_EQ(m.warnings.size(), 1u) << which;
      EXPECT_NE(m.warnings[0].text.find("repeats"), std::string::npos) << m.warnings[0].text;
      EXPECT_TRUE(where != 3 || m.warnings[0].text.find("z = 9 mm") != std::string::npos) << m.warnings[0].text;
    }
}

TEST(DrawnCopies, WallsBridgesAndNeighboursStay) {
  // A thin wall, a keyhole contour and two boxes with a common side are no copies.
  const Made wall = make({file_of(1, every(2, 4),
                                  [](double) {
                                    return std::vector{disc(0, 0, 20), disc(0, 0, 19)};
                                  })},
                         slices());
  EXPECT_NEAR(wall.volume(1), (disc_area(20) - disc_area(19)) * 8, 2);
  ContourPolygon keyhole = box(0, 0, 20, 20);
  keyhole.points.insert(keyhole.points.begin() + 1, {{5, 5}, {5, 15}, {15, 15}, {15, 5}, {5, 5}, {0, 0}});
  const Made hole = make({file_of(1, every(2, 4), [&](double) { return std::vector{keyhole}; })}, slices());
  EXPECT_NEAR(hole.volume(1), (400 - 100) * 8, 2);
  const Made pair = make({file_of(1, every(2, 4),
                                  [](double) {
                                    return std::vector{box(0, 0, 10, 10), box(10, 0, 20, 10)};
                                  })},
                         slices());
  EXPECT_NEAR(pair.volume(1), 200 * 8, 1);
  EXPECT_EQ(surface_of(pair.check, 1).components, 1);
  for (const Made* m : {&wall, &hole, &pair}) EXPECT_TRUE(m->warnings.empty());
}

TEST(DrawnCopies, SectionsOfALabelAtOneHeightJoin) {
  LabelContours f = file_of(1, every(2, 4), [](double) { return std::vector{disc(0, 0, 5)}; });
  LabelContours g = f;
  for (ContourSection& s : g.sections) {
    s.z_mm += 5e-4;
    s.polygons = {disc(20, 0, 5)};
  }
  f.sections.insert(f.sections.end(), g.sections.begin(), g.sections.end());
  std::stable_sort(f.sections.begin(), f.sections.end(), [](const auto& a, const auto& b) { return a.z_mm < b.z_mm; });
  const Made m = make({f}, slices());
  EXPECT_NEAR(m.volume(1), 2 * disc_area(5) * 8, 0.1);
  EXPECT_EQ(surface_of(m.check, 1).components, 2);
}

TEST(DrawnEnds, DoNotDependOnOtherLabels) {
  const auto a = [](double) { return std::vector{disc(0, 0, 20)}; };
  const auto taper = [](double z) { return std::vector{disc(0, 0, z == 0 || z == 40 ? 12 : 20)}; };
  const auto b = [](double) { return std::vector{disc(60, 0, 8)}; };
  struct Case {
    std::vector<double> own, other;
  };
  const std::vector<Case> cases = {{every(3, 8), every(3, 15)},        // ends inside the other's stack
                                   {every(5, 9), every(1, 41)},        // its gap is wider
                                   {every(5, 9), every(2, 60, -30)},   // its ends lie between heights of the other
                                   {every(3, 8), every(7, 9, -20)},    // finer than the other's
                                   {every(3, 8), every(3, 8, 0.03)}};  // jitter
  for (const Case& c : cases)
    for (bool round : {false, true}) {
      const auto drawn = [&](double z) { return round && c.own.back() == 40 ? taper(z) : a(z); };
      const Caps caps = round ? Caps::round : Caps::flat;
      const Made alone = make({file_of(1, c.own, drawn)}, slices(), std::nullopt, caps);
      const Made joint = make({file_of(1, c.own, drawn), file_of(2, c.other, b)}, slices(), std::nullopt, caps);
      const double gap = c.own[1] - c.own[0];
      if (!round) {
        EXPECT_NEAR(joint.heights(1)[0], -0.5 * gap, 0.05);
        EXPECT_NEAR(joint.heights(1)[1], c.own.back() + 0.5 * gap, 0.05);
        EXPECT_NEAR(joint.volume(1), alone.volume(1), 0.005 * alone.volume(1)) << c.other[1];
      } else {
        EXPECT_NEAR(joint.volume(1), alone.volume(1), 0.015 * alone.volume(1)) << c.other[1];
      }
    }
}

TEST(DrawnEnds, PlaneCutsEndFlatOnThemselvesInAnyCompany) {
  const auto a = [](double) { return std::vector{box(0, 0, 20, 20)}; };
  const auto b = [](double) { return std::vector{box(30, 0, 40, 20)}; };
  const Made m = make({file_of(1, every(3, 8), a), file_of(2, every(3, 16, -6), b)});
  EXPECT_EQ(m.heights(1), (std::array<double, 2>{0, 21}));
  EXPECT_NEAR(m.volume(1), 400 * 21, 1e-3);
}

TEST(DrawnEnds, EitherEndHasItsOwnCap) {
  const auto a = [](double) { return std::vector{disc(0, 0, 10)}; };
  std::vector<Warning> warnings;
  Stack stack = sections_from_contours({file_of(1, every(4, 5), a)}, warnings);
  StitchOptions o;
  o.label_caps[1] = {Caps::round, Caps::flat};
  Monitor quiet;
  const StitchResult r = stitch_sections(stack, o, quiet);
  EXPECT_EQ(r.caps.at(1).low, "round");
  EXPECT_EQ(r.caps.at(1).high, "flat");
}

/// Discs within discs, of changing radius, pushed about by up to the walls' thickness from section to section.
std::vector<LabelContours> nested_discs(unsigned seed, double& thinnest) {
  std::mt19937 random(seed);
  const auto real = [&](double low, double high) { return low + (high - low) * (random() / 4294967296.0); };
  const int levels = 2 + static_cast<int>(random() % 3), sections = 3 + static_cast<int>(random() % 5);
  const double gap = real(3, 10);
  std::vector<double> wall;
  for (int d = 0; d + 1 < levels; ++d) wall.push_back(real(1.5, 6));
  thinnest = *std::min_element(wall.begin(), wall.end());
  std::vector<LabelContours> files(levels);
  double x = 0, y = 0;
  for (int k = 0; k < sections; ++k) {
    double radius = real(14, 18);
    for (double w : wall) radius += w;
    const double angle = real(0, 2 * M_PI), way = real(0.3, 1) * thinnest;
    x += way * std::cos(angle);
    y += way * std::sin(angle);
    double cx = x, cy = y;
    const int points = 40 + static_cast<int>(random() % 80);
    const double lobes = real(0, 0.04), turn = real(0, 6);
    for (int d = 0; d < levels; ++d) {
      ContourPolygon p;
      for (int i = 0; i < points; ++i) {
        const double a = 2 * M_PI * i / points, r = radius * (1 + lobes * std::cos(3 * a + turn));
        p.points.push_back({cx + r * std::cos(a), cy + r * std::sin(a)});
      }
      files[d].path = "nested";
      files[d].label = d + 1;
      files[d].sections.push_back({gap * k, {p}});
      if (d + 1 == levels) break;
      radius -= wall[d];
      const double off = real(0, 0.3) * wall[d], to = real(0, 2 * M_PI);
      cx += off * std::cos(to);
      cy += off * std::sin(to);
    }
  }
  return files;
}

TEST(NestedStacks, WhatLiesInsideStaysInside) {
  const char* asked = std::getenv("STACKMESH_NESTED_STACKS");
  const unsigned count = asked ? static_cast<unsigned>(std::atoi(asked)) : 80;
  const char* from = std::getenv("STACKMESH_NESTED_FROM");
  std::vector<unsigned> seeds;
  for (unsigned seed = from ? static_cast<unsigned>(std::atoi(from)) : 0; seed < count; ++seed) seeds.push_back(seed);
  if (asked == nullptr) seeds.push_back(1889);  // a ring that outgrows its wall
  for (const unsigned seed : seeds) {
    double thinnest = 0;
    std::vector<LabelContours> files = nested_discs(seed, thinnest);
    const int levels = static_cast<int>(files.size());
    const bool one_file = seed % 5 == 4;  // the same walls and holes, drawn as one label
    if (one_file) {
      for (std::size_t d = 1; d < files.size(); ++d)
        for (std::size_t k = 0; k < files[d].sections.size(); ++k)
          files[0].sections[k].polygons.push_back(files[d].sections[k].polygons[0]);
      files.resize(1);
    }
    const Caps caps = seed % 2 ? Caps::round : Caps::flat;
    const std::optional<int> per_gap =
        seed % 3 == 0 ? std::optional<int>() : std::optional<int>(static_cast<int>(seed % 3) - 1);
    const Made m = make(files, {}, per_gap, caps);
    ASSERT_TRUE(m.warnings.empty()) << "seed " << seed << ": " << m.warnings[0].text;
    const double low = files[0].sections.front().z_mm, high = files[0].sections.back().z_mm;
    if (!one_file)
      for (const InterfaceTriangle& t : m.result.complex.triangles) {
        if (std::abs(t.below - t.above) == 1) continue;
        for (std::int32_t v : t.v) {
          const double z = m.result.complex.points[v].z;
          ASSERT_TRUE(caps == Caps::flat && (z == low || z == high))
              << "seed " << seed << ": " << t.below << " meets " << t.above << " at z = " << z;
        }
      }
    for (const LabelSurface& l : m.check.labels) {
      const bool tube = caps == Caps::flat && (one_file || l.label < levels);
      EXPECT_EQ(l.genus, !tube      ? 0
                         : one_file ? levels / 2
                                    : 1)
          << "seed " << seed << " label " << l.label << " of " << levels << (one_file ? " in one file" : "")
          << (caps == Caps::flat ? " flat" : " round") << " per gap " << per_gap.value_or(-1);
      EXPECT_EQ(l.components, one_file ? (levels + 1) / 2 : 1)
          << "seed " << seed << " label " << l.label << " of " << levels << (one_file ? " in one file" : "")
          << (caps == Caps::flat ? " flat" : " round") << " per gap " << per_gap.value_or(-1);
    }
  }
}

TEST(NestedStacks, ANestThatGrowsByMoreThanItsWallsStaysOne) {
  // A ring and a disc in it, drawn as one label; the next ring lies wholly outside of this one, the next disc beneath
  // it.
  const auto nest = [](double r) { return std::vector{disc(0, 0, r), disc(0, 0, r - 2), disc(0, 0, r - 4)}; };
  for (const bool grows : {true, false})
    for (const int per_gap : {0, 1}) {
      const Made m = make({file_of(1, every(6, 4), [&](double z) { return nest((z < 9) == grows ? 18 : 24); })}, {},
                          per_gap, Caps::flat);
      EXPECT_TRUE(m.warnings.empty());
      EXPECT_EQ(surface_of(m.check, 1).genus, 1) << grows << per_gap;
      EXPECT_EQ(surface_of(m.check, 1).components, 2) << grows << per_gap;
      const Boundaries pieces = find_boundaries(m.result.complex, 1);
      std::map<std::int32_t, std::array<double, 2>> heights;  // of a piece
      for (std::size_t t = 0; t < pieces.piece.size(); ++t)
        for (const std::int32_t piece : pieces.piece[t])
          if (piece >= 0)
            for (const std::int32_t v : m.result.complex.triangles[t].v) {
              auto& z = heights.insert({piece, {1e300, -1e300}}).first->second;
              z = {std::min(z[0], m.result.complex.points[v].z), std::max(z[1], m.result.complex.points[v].z)};
            }
      for (const auto& [piece, z] : heights)
        EXPECT_EQ(z, (std::array<double, 2>{0, 18}))
            << "the ring goes on as a ring, the disc as a disc; " << grows << per_gap;
    }
  // Where the levels are not the same, what overlaps goes on: a ring and the disc in it, both beneath one solid.
  const Made joined =
      make({file_of(1, every(6, 4), [&](double z) { return z < 9 ? nest(18) : std::vector{disc(0, 0, 17)}; })}, {}, 1,
           Caps::round);
  EXPECT_EQ(surface_of(joined.check, 1).components, 1);
}

TEST(DrawnShapes, HaveTheirVolumeGenusAndEnds) {
  // Along the sections a torus is a ring in each; across, two discs that join at either end.
  const double R = 20, r = 6;
  const auto lying = [&](double z) {
    const double w = std::sqrt(std::max(0.0, r * r - z * z));
    return std::vector{disc(0, 0, R + w, 96), disc(0, 0, R - w, 72)};
  };
  const Made ring = make({file_of(1, every(1, 11, -5), lying)});
  EXPECT_EQ(surface_of(ring.check, 1).genus, 1);
  EXPECT_EQ(surface_of(ring.check, 1).components, 1);
  // of its cross-section: plane cuts end on the last one
  const double beyond = 2 * (r * r * std::acos(5 / r) - 5 * std::sqrt(r * r - 25));
  EXPECT_NEAR(ring.volume(1), 2 * M_PI * R * (M_PI * r * r - beyond), 0.01 * ring.volume(1));
  const auto standing = [&](double z) {  // axis along y: sections of a torus about it
    std::vector<ContourPolygon> out;
    ContourPolygon upper;
    std::vector<std::array<double, 2>> left;
    const int n = 60;
    const bool split = std::abs(z) < R - r;
    const double t0 = std::abs(z) > R ? std::sqrt(std::max(0.0, r * r - (std::abs(z) - R) * (std::abs(z) - R))) : r;
    const auto outer = [&](double y) {
      return std::sqrt(std::max(0.0, std::pow(R + std::sqrt(std::max(0.0, r * r - y * y)), 2) - z * z));
    };
    const auto inner = [&](double y) {
      return std::sqrt(std::max(0.0, std::pow(R - std::sqrt(std::max(0.0, r * r - y * y)), 2) - z * z));
    };
    if (!split) {
      for (int i = 0; i < n; ++i)
        upper.points.push_back({outer(-t0 * std::cos(M_PI * i / n)), -t0 * std::cos(M_PI * i / n)});
      for (int i = 0; i < n; ++i)
        upper.points.push_back({-outer(t0 * std::cos(M_PI * i / n)), t0 * std::cos(M_PI * i / n)});
      return std::vector{upper};
    }
    for (double side : {1.0, -1.0}) {
      ContourPolygon p;
      for (int i = 0; i < n; ++i)
        p.points.push_back({side * outer(-r * std::cos(M_PI * i / n)), -r * std::cos(M_PI * i / n)});
      for (int i = 0; i < n; ++i)
        p.points.push_back({side * inner(r * std::cos(M_PI * i / n)), r * std::cos(M_PI * i / n)});
      out.push_back(p);
    }
    return out;
  };
  const Made wheel = make({file_of(1, every(2, 26, -25), standing)});
  EXPECT_EQ(surface_of(wheel.check, 1).genus, 1);
  EXPECT_EQ(surface_of(wheel.check, 1).components, 1);
  // A trunk that branches, a cone that ends between sections, a ring that opens.
  const Made fork = make({file_of(1, every(3, 9), [](double z) {
    return z < 9 ? std::vector{disc(0, 0, 12)} : std::vector{disc(-5 - 0.5 * z, 0, 6), disc(5 + 0.5 * z, 0, 6)};
  })});
  EXPECT_EQ(surface_of(fork.check, 1).genus, 0);
  EXPECT_EQ(surface_of(fork.check, 1).components, 1);
  const Made cone = make({file_of(1, every(4, 5), [](double z) { return std::vector{disc(0, 0, 17 - z)}; }),
                          file_of(2, every(4, 9), [](double) { return std::vector{disc(60, 0, 8)}; })});
  EXPECT_NEAR(cone.heights(1)[1], 18, 0.7);  // half a gap beyond its last section
  EXPECT_NEAR(cone.volume(1), M_PI / 3 * (17 * 17 * 17 - 1), 0.02 * cone.volume(1));
  const auto opening = [](double z) {
    if (z < 9) return std::vector{disc(0, 0, 20), disc(0, 0, 12)};
    ContourPolygon c;
    for (int i = 0; i <= 80; ++i)
      c.points.push_back(
          {20 * std::cos(0.4 + (2 * M_PI - 0.8) * i / 80), 20 * std::sin(0.4 + (2 * M_PI - 0.8) * i / 80)});
    for (int i = 80; i >= 0; --i)
      c.points.push_back(
          {12 * std::cos(0.4 + (2 * M_PI - 0.8) * i / 80), 12 * std::sin(0.4 + (2 * M_PI - 0.8) * i / 80)});
    return std::vector{c};
  };
  const Made open = make({file_of(1, every(3, 7), opening)});
  EXPECT_EQ(surface_of(open.check, 1).genus, 1);
  EXPECT_EQ(surface_of(open.check, 1).components, 1);
}

TEST(DrawnShapes, PrismsAreExact) {
  const std::vector<std::pair<std::vector<ContourPolygon>, double>> prisms = {
      {{box(-10, -10, 10, 10)}, 400},
      {{{{{0, 0}, {30, 0}, {30, 8}, {8, 8}, {8, 30}, {0, 30}}}}, 30 * 8 + 22 * 8},
      {{box(0, 0, 40, 40), box(5, 5, 35, 35)}, 1600 - 900},
      {{disc(0, 0, 15, 8)}, disc_area(15, 8)},
      {{disc(0, 0, 15, 16)}, disc_area(15, 16)},
      {{disc(0, 0, 15, 64)}, disc_area(15, 64)}};
  for (const auto& [polygons, area] : prisms) {
    const Made m = make({file_of(1, every(3, 6), [&, p = &polygons](double) { return *p; })}, slices());
    EXPECT_NEAR(m.volume(1), area * 18, 1e-3 * area);
    EXPECT_EQ(surface_of(m.check, 1).genus, static_cast<long>(polygons.size()) - 1);
    EXPECT_NEAR(m.heights(1)[0], -1.5, 1e-9);
    EXPECT_NEAR(m.heights(1)[1], 16.5, 1e-9);
    for (const Section& s : m.stack.sections) EXPECT_FALSE(s.interpolated);
  }
}

}  // namespace
}  // namespace stackmesh
