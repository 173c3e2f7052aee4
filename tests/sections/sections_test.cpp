// Virtual sections between contours, against shapes whose areas are known at every height.
#include <cmath>
#include <map>
#include <mutex>
#include <random>

#include "base/error.h"
#include "checks.h"
#include "random_stacks.h"
#include "sections/layer_sections.h"
#include "sections/polygons.h"
#include "sections/virtual_layers.h"
#include "sections/virtual_sections.h"

namespace stackmesh {
namespace {

using namespace testing_support;

std::vector<Warning> unheard;  // warnings that no test asks for

ContourPolygon circle(double x, double y, double radius, int points = 120) {
  ContourPolygon p;
  for (int i = 0; i < points; ++i) {
    const double a = 2 * M_PI * (i + 0.3) / points;
    p.points.push_back({x + radius * std::cos(a), y + radius * std::sin(a)});
  }
  return p;
}

/// Area of a regular polygon over that of its circle.
double share_of_circle(int points = 120) {
  return std::sin(2 * M_PI / points) * points / (2 * M_PI);
}

Stack stack_of(const std::vector<LabelContours>& files) {
  std::vector<Warning> warnings;
  return sections_from_contours(files, warnings);
}

LabelContours file_of(Label label, const std::vector<double>& heights,
                      const std::function<ContourPolygon(double)>& at) {
  LabelContours f;
  f.path = "made";
  f.label = label;
  for (double z : heights) f.sections.push_back({z, {at(z)}});
  return f;
}

std::vector<std::vector<Section>> virtual_sections(const Stack& stack, int per_gap, double pixel_mm, double tension,
                                                   double tolerance_px) {
  VirtualLayerOptions options;
  options.per_gap.assign(stack.sections.size() - 1, per_gap);
  options.unit = {static_cast<std::int32_t>(pixel_mm / stack.grid_x_mm) | 1,
                  static_cast<std::int32_t>(pixel_mm / stack.grid_y_mm) | 1};
  options.tension = tension;
  std::vector<std::vector<Section>> out(stack.sections.size() - 1);
  interpolate_sections(stack, options, [&](std::size_t gap, const LabelLayer& layer) {
    out[gap - 1].push_back(layer_section(layer, tolerance_px));
  });
  return out;
}

TEST(VirtualSections, FollowAConeThroughUnevenGaps) {
  const auto radius = [](double z) { return 14 + 0.4 * z; };
  const Stack stack = stack_of({file_of(1, {0, 4, 10, 13, 20}, [&](double z) { return circle(30, 30, radius(z)); })});
  for (const auto& gap : virtual_sections(stack, 3, 0.5, 0.5, 0))
    for (const Section& s : gap) {
      const double expected = M_PI * radius(s.z_mm) * radius(s.z_mm) * share_of_circle();
      EXPECT_NEAR(label_area_mm2(stack, s, 1), expected, 0.004 * expected) << s.z_mm;
      EXPECT_TRUE(s.interpolated);
    }
}

TEST(VirtualSections, FollowAParabolaThroughUnevenGaps) {  // Catmull-Rom on true heights is exact for it
  const auto radius = [](double z) { return 24 - 0.05 * (z - 11) * (z - 11); };
  const Stack stack = stack_of({file_of(1, {0, 3, 10, 13, 22}, [&](double z) { return circle(30, 30, radius(z)); })});
  const auto sections = virtual_sections(stack, 4, 0.5, 0.5, 0);
  for (std::size_t gap : {1, 2})
    for (const Section& s : sections[gap]) {
      const double expected = M_PI * radius(s.z_mm) * radius(s.z_mm) * share_of_circle();
      EXPECT_NEAR(label_area_mm2(stack, s, 1), expected, 0.004 * expected) << s.z_mm;
    }
}

TEST(VirtualSections, SharedAndNestedContoursKeepTheirAreas) {
  // A disc of radius 20, halved by a line that moves with z; a core inside the left half.
  const auto half = [](bool left, double z) {
    ContourPolygon p;
    const double x = 0.5 * (z - 10), end = std::acos(x / 20);
    for (int i = 0; i <= 90; ++i) {
      const double a = left ? end + (2 * M_PI - 2 * end) * i / 90 : -end + 2 * end * i / 90;
      p.points.push_back({20 * std::cos(a), 20 * std::sin(a)});
    }
    return p;
  };
  const std::vector<double> heights = {4, 8, 16};
  const Stack stack = stack_of({file_of(3, heights, [&](double z) { return half(true, z); }),
                                file_of(5, heights, [&](double z) { return half(false, z); }),
                                file_of(9, heights, [&](double) { return circle(-11, 0, 4); })});
  for (const auto& gap : virtual_sections(stack, 3, 0.5, 0.5, 0.1))
    for (const Section& s : gap) {
      const double x = 0.5 * (s.z_mm - 10), right = 400 * std::acos(x / 20) - x * std::sqrt(400 - x * x);
      EXPECT_NEAR(label_area_mm2(stack, s, 5), right, 6) << s.z_mm;
      EXPECT_NEAR(label_area_mm2(stack, s, 3) + label_area_mm2(stack, s, 9), 400 * M_PI - right, 6) << s.z_mm;
      EXPECT_NEAR(label_area_mm2(stack, s, 9), 16 * M_PI * share_of_circle(), 0.5);
    }
}

bool same(const Section& a, const Section& b) {
  if (a.z_mm != b.z_mm || a.points != b.points || a.edges.size() != b.edges.size()) return false;
  for (std::size_t i = 0; i < a.edges.size(); ++i)
    if (a.edges[i].a != b.edges[i].a || a.edges[i].b != b.edges[i].b || a.edges[i].left != b.edges[i].left ||
        a.edges[i].right != b.edges[i].right)
      return false;
  return true;
}

TEST(VirtualSections, RealSectionsStayToTheLastDigit) {
  const Stack before =
      stack_of({file_of(1, {0, 6, 9}, [](double z) { return circle(20, 21 + z, 11.37 - 0.1 * z, 61); })});
  Stack after = before;
  EXPECT_EQ(add_virtual_sections(after, 4, 1, unheard), 8u);
  ASSERT_EQ(after.sections.size(), 11u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_FALSE(after.sections[5 * k].interpolated);
    EXPECT_TRUE(same(after.sections[5 * k], before.sections[k])) << k;
  }
  for (std::size_t k = 1; k < after.sections.size(); ++k) EXPECT_GT(after.sections[k].z_mm, after.sections[k - 1].z_mm);
}

TEST(VirtualSections, AreTheSameForAnyThreadCount) {
  const Stack stack = stack_of({file_of(1, {0, 6, 9, 20}, [](double z) { return circle(20 + z, 21, 11 + 0.1 * z); }),
                                file_of(2, {0, 6, 9, 20}, [](double z) { return circle(20 + z, 21, 5 + 0.1 * z); })});
  Stack one = stack, four = stack;
  add_virtual_sections(one, std::nullopt, 1, unheard);
  add_virtual_sections(four, std::nullopt, 4, unheard);
  ASSERT_EQ(one.sections.size(), four.sections.size());
  EXPECT_GT(one.sections.size(), stack.sections.size());
  for (std::size_t k = 0; k < one.sections.size(); ++k) EXPECT_TRUE(same(one.sections[k], four.sections[k])) << k;
}

TEST(VirtualSections, AutomaticNumberFollowsEachGap) {
  Stack stack =
      stack_of({file_of(1, {0, 1, 11, 16}, [](double z) { return circle(32 + 2 * std::floor(z / 5), 32, 32); })});
  EXPECT_NEAR(contour_feature_mm(stack), 2 * 32 * std::sin(M_PI / 120), 1e-3);  // the edge: longer than 64 / 64
  add_virtual_sections(stack, std::nullopt, 1, unheard);
  std::vector<int> between;
  for (const Section& s : stack.sections) {
    if (!s.interpolated) between.push_back(0);
    else ++between.back();
  }
  EXPECT_EQ(between, (std::vector<int>{0, 5, 2, 0}));
}

TEST(VirtualSections, AWallThatCannotBeKeptIsAWarningWithItsSections) {
  // A disc jumps aside by more than its width; the one within it lies at its left end, then at its right one.
  const auto discs = [](double jump, double inner) {
    return stack_of({file_of(1, {0, 5, 15}, [&](double z) { return circle(z > 5 ? jump : 0, 0, 10); }),
                     file_of(2, {0, 5, 15}, [&](double z) { return circle(z > 5 ? jump + inner : -inner, 0, 2); })});
  };
  Stack stack = discs(60, 7), still = discs(0, 3);
  std::vector<Warning> open, none;
  add_virtual_sections(stack, std::nullopt, 1, open);
  add_virtual_sections(still, std::nullopt, 1, none);
  ASSERT_EQ(open.size(), 1u);
  EXPECT_EQ(open[0].code, WarningCode::open_wall);
  EXPECT_EQ(open[0].where, "sections at z = 5 and 15 mm");
  EXPECT_NE(open[0].text.find("between the sections at z = 5 and 15 mm contours that lie within others"),
            std::string::npos)
      << open[0].text;
  EXPECT_TRUE(none.empty());
}

TEST(VirtualSections, ZeroAddsNoneAndNonsenseIsRefused) {
  Stack stack = stack_of({file_of(1, {0, 6}, [](double) { return circle(20, 20, 10); })});
  EXPECT_EQ(add_virtual_sections(stack, 0, 1, unheard), 0u);
  VirtualLayerOptions options;
  options.unit = {200, 200};
  const auto take = [](std::size_t, const LabelLayer&) {};
  EXPECT_THROW(interpolate_sections(stack, options, take), Error);  // no number for the gap
  options.per_gap = {-1};
  EXPECT_THROW(interpolate_sections(stack, options, take), Error);
  options.per_gap = {1};
  options.unit = {3, 3};
  EXPECT_THROW(interpolate_sections(stack, options, take), Error);
}

/// Layers of noise: every kind of corner of up to four labels.
LabelLayer noise_layer(std::mt19937& random, double z) {
  LabelLayer layer;
  layer.z_mm = z;
  layer.x0 = layer.y0 = 0.5;
  layer.unit = {65, 91};
  layer.width = 12;
  layer.height = 10;
  layer.label = {0, 1, 2, 7};
  for (int y = 0; y < layer.height; ++y)
    for (int x = 0; x < layer.width; ++x) {
      const bool rim = x == 0 || y == 0 || x + 1 == layer.width || y + 1 == layer.height;
      layer.part.push_back(rim ? 0 : static_cast<std::int32_t>(random() % 4));
      layer.right.push_back(0.1f + 0.8f * static_cast<float>(random() % 1000) / 999);
      layer.up.push_back(0.1f + 0.8f * static_cast<float>(random() % 1000) / 999);
    }
  return layer;
}

TEST(LayerSection, NoiseGivesSectionsThatStitchClosed) {
  Monitor quiet;
  for (unsigned seed = 0; seed < 150; ++seed) {
    std::mt19937 random(seed);
    Stack stack;
    stack.grid_x_mm = stack.grid_y_mm = 0.01;
    stack.labels = {{0, ""}, {1, ""}, {2, ""}, {7, ""}};
    for (int k = 0; k < 4; ++k)
      stack.sections.push_back(layer_section(noise_layer(random, 0.7 * k), seed % 3 == 0   ? 0
                                                                           : seed % 3 == 1 ? 0.1
                                                                                           : 0.6));
    StitchOptions options;
    options.threads = 1;
    ASSERT_EQ(defects(stitch_sections(stack, options, quiet).complex), "") << "seed " << seed;
  }
}

TEST(LayerSection, ContoursRunWhereTheLayerSays) {
  LabelLayer layer;
  layer.x0 = layer.y0 = 50.5;
  layer.unit = {101, 101};
  layer.width = layer.height = 4;
  layer.label = {0, 4};
  layer.part = {0, 0, 0, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 0};
  layer.right.assign(16, 0.25f);
  layer.up.assign(16, 0.75f);
  Stack grid;
  const Section s = layer_section(layer, 0);
  // x from 0.25 to 2.25 pixels, y from 0.75 to 2.75, its corners cut off.
  const double cut = 0.5 * (0.75 * 0.25 + 0.25 * 0.25 + 0.25 * 0.75 + 0.75 * 0.75);
  EXPECT_NEAR(label_area_mm2(grid, s, 4), (4 - cut) * 101 * 101, 250);
  EXPECT_EQ(s.edges.size(), 8u);
}

TEST(LayerSection, APinchOfTheBackgroundPartsALabel) {
  LabelLayer layer;
  layer.x0 = layer.y0 = 50.5;
  layer.unit = {101, 101};
  layer.width = layer.height = 4;
  layer.label = {0, 4, 4};
  layer.part = {0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0};
  layer.right.assign(16, 0.5f);
  layer.up.assign(16, 0.5f);
  const Section s = layer_section(layer, 0);
  EXPECT_EQ(s.points.size(), 8u);  // two squares that do not touch
  EXPECT_EQ(s.edges.size(), 8u);
}

TEST(VirtualSections, RandomContoursStitchClosed) {
  Monitor quiet;
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    Stack stack;
    try {
      stack = stack_of(random_contours(seed));
    } catch (const Error&) {
      continue;  // jitter made a contour cross itself
    }
    add_virtual_sections(stack, 1 + static_cast<int>(seed % 4), 1, unheard);
    StitchOptions options;
    options.threads = 1;
    ASSERT_EQ(defects(stitch_sections(stack, options, quiet).complex), "") << "seed " << seed;
  }
}

}  // namespace
}  // namespace stackmesh
