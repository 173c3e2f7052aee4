#include "sections/virtual_slices.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "base/error.h"
#include "random_stacks.h"
#include "volumes.h"

namespace stackmesh {
namespace {

using namespace testing_support;

TEST(VirtualSlices, RealSlicesKeepEveryPixel) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const LabelVolume in = random_volume(seed);
    const InterpolatedVolume out = interpolated(in, 3);
    ASSERT_EQ(out.per_gap, 3);
    ASSERT_EQ(out.volume.size[2], (in.size[2] - 1) * 4 + 1);
    for (int k = 0; k < in.size[2]; ++k) ASSERT_EQ(slice(out.volume, 4 * k), slice(in, k)) << "seed " << seed;
  }
}

TEST(VirtualSlices, EqualSlicesGiveEqualSlicesBetween) {
  const LabelVolume in = shapes(40, 40, 4, 6, [](double x, double y, int) {
    return std::hypot(x - 15, y - 20) < 9 ? 1 : std::hypot(x - 28, y - 20) < 8 ? 2 : 0;
  });
  const LabelVolume out = interpolated(in, 5).volume;
  for (int k = 0; k < out.size[2]; ++k) EXPECT_EQ(slice(out, k), slice(in, 0)) << k;
}

TEST(VirtualSlices, GeometryAndLabelsAreKept) {
  LabelVolume in = disc_stack({10, 12, 14}, 40);
  in.origin_mm = {5, -7, 11};
  in.axes = {Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{1, 0, 0}};
  in.labels[1].name = "disc";
  in.kind = "nifti";
  in.anatomical = false;
  const LabelVolume out = interpolated(in, 3).volume;
  EXPECT_DOUBLE_EQ(out.spacing_mm[2], in.spacing_mm[2] / 4);
  for (int k : {0, 1, 2}) {
    const Vec3 was = in.world(3, 4, k), is = out.world(3, 4, 4 * k);
    EXPECT_NEAR(norm(was - is), 0, 1e-12);
  }
  EXPECT_EQ(out.labels[1].name, "disc");
  EXPECT_EQ(out.kind, "nifti");
  EXPECT_FALSE(out.anatomical);
}

TEST(VirtualSlices, AutomaticNumberMakesTheGapAPixel) {
  LabelVolume in = disc_stack({10, 12, 14}, 40);
  for (const auto& [gap, expected] : std::map<double, int>{{1, 0}, {1.5, 0}, {1.6, 1}, {3, 2}, {7.4, 6}, {7.6, 7}}) {
    in.spacing_mm = {1, 1.2, gap};  // the smaller in-plane spacing counts
    EXPECT_EQ(add_virtual_slices(in, 2, {}).per_gap, expected) << gap;
  }
}

TEST(VirtualSlices, NoneAskedForIsTheInput) {
  const LabelVolume in = random_volume(3);
  const InterpolatedVolume out = interpolated(in, 0);
  EXPECT_EQ(out.per_gap, 0);
  EXPECT_EQ(out.volume.voxels, in.voxels);
  EXPECT_EQ(out.volume.spacing_mm, in.spacing_mm);
}

TEST(VirtualSlices, GrowingDiscHasRadiiBetween) {
  // Catmull-Rom gives back what is linear; the default leaves each slice less steeply (docs/interpolate.md).
  for (const auto& [tension, tolerance] : std::map<double, double>{{0.5, 0.15}, {0.25, 0.35}}) {
    InterpolateOptions options;
    options.per_gap = 3;
    options.tension = tension;
    const LabelVolume out = add_virtual_slices(disc_stack({6, 10, 14, 18, 22, 26}, 64), 2, options).volume;
    for (int k = 4; k <= 16; ++k) EXPECT_NEAR(radius(out, k), 6 + k, tolerance) << k;
  }
}

TEST(VirtualSlices, GrowingDiscInPixelsThatAreNotSquareHasRadiiBetween) {
  LabelVolume in = shapes(
      64, 32, 5, 8, [](double x, double y, int k) { return std::hypot(x - 32, 2 * y - 32) < 10 + 4 * k ? 1 : 0; });
  in.spacing_mm = {0.5, 1, 8};  // half the pixel: radii in mm are half of those in x pixels
  InterpolateOptions options;
  options.per_gap = 3;
  options.tension = 0.5;
  const LabelVolume out = add_virtual_slices(in, 2, options).volume;
  for (int k = 4; k <= 12; ++k) EXPECT_NEAR(std::sqrt(area(out, k, 1) * 0.5 / M_PI), 0.5 * (10 + k), 0.15) << k;
}

TEST(VirtualSlices, ShiftingDiscMovesWithoutBreaking) {
  const LabelVolume in =
      shapes(80, 48, 4, 6, [](double x, double y, int k) { return std::hypot(x - 20 - 10 * k, y - 24) < 14 ? 1 : 0; });
  const LabelVolume out = interpolated(in, 4).volume;
  for (int k = 0; k < out.size[2]; ++k) {
    EXPECT_NEAR(centre_x(out, k, 1), 20 + 2 * k, 1) << k;
    EXPECT_EQ(parts_in_slice(out, k, 1), 1u) << k;
    EXPECT_GT(area(out, k, 1), 0.85 * area(in, 0, 1)) << k;
  }
}

TEST(VirtualSlices, ClosingHoleShrinksSteadily) {
  const std::vector<double> hole = {12, 8, 4, 0, 0};
  const LabelVolume in = shapes(64, 64, 5, 6, [&](double x, double y, int k) {
    const double r = std::hypot(x - 32, y - 32);
    return r < 24 && r >= hole[k] ? 1 : 0;
  });
  const LabelVolume out = interpolated(in, 3).volume;
  double before = 1e9;
  for (int k = 0; k < out.size[2]; ++k) {
    const double open = area(in, 0, 1) + M_PI * 144 - area(out, k, 1);
    EXPECT_LE(open, before + 2) << k;
    before = open;
  }
  EXPECT_NEAR(std::sqrt((area(in, 4, 1) - area(out, 2, 1)) / M_PI), 10, 0.3);
}

TEST(VirtualSlices, LabelAbsentInTheNextSliceEndsHalfWay) {
  for (bool down : {false, true}) {
    const LabelVolume in = shapes(40, 40, 4, 10, [&](double x, double y, int k) {
      return (down ? k >= 2 : k < 2) && std::hypot(x - 20, y - 20) < 12 ? 1 : 0;
    });
    const LabelVolume out = interpolated(in, 9).volume;
    double before = area(in, down ? 3 : 0, 1);
    for (int j = 1; j < 10; ++j) {
      const double here = area(out, down ? 20 - j : 10 + j, 1);
      EXPECT_LE(here, before) << j;
      EXPECT_EQ(here > 0, j < 5) << j;
      before = here;
    }
  }
}

TEST(VirtualSlices, IslandWithoutCounterpartEndsAloneAtHalfWay) {
  const auto with_far_part = [](bool far) {
    return shapes(80, 40, 3, 10, [=](double x, double y, int k) {
      return (far && std::hypot(x - 60, y - 20) < 12) || (k == 1 && std::hypot(x - 20, y - 20) < 10) ? 1 : 0;
    });
  };
  const LabelVolume both = interpolated(with_far_part(true), 9).volume,
                    alone = interpolated(with_far_part(false), 9).volume;
  for (int k = 0; k < both.size[2]; ++k) {
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) ASSERT_EQ(both.voxels[both.index(x, y, k)], alone.voxels[alone.index(x, y, k)]);
    EXPECT_EQ(area(alone, k, 1) > 0, k > 5 && k < 15) << k;
  }
}

TEST(VirtualSlices, APartThatNarrowsEndsWhereItsAreasSay) {
  // Slices of a ball of radius 20, 10 mm apart: its poles are 20 - 10 - z0 mm beyond the last slice.
  for (double z0 : {-4.5, -3.0, 3.0, 4.5})
    for (double hole : {0.0, 12.0}) {  // a wall round another label ends as what lies in it does
      const LabelVolume in = shapes(50, 50, 7, 10, [&](double x, double y, int k) {
        const double r = std::sqrt(std::pow(x - 25, 2) + std::pow(y - 25, 2) + std::pow((k - 3) * 10 + z0, 2));
        return r < hole ? 2 : r < 20 ? 1 : 0;
      });
      const LabelVolume out = interpolated(in, 9).volume;
      int low = out.size[2], high = 0;
      for (int k = 0; k < out.size[2]; ++k)
        if (area(out, k, 1) > 0) {
          low = std::min(low, k);
          high = std::max(high, k);
        }
      EXPECT_NEAR(low - 30 + z0, -20, 1.5) << z0 << ' ' << hole;
      EXPECT_NEAR(high - 30 + z0, 20, 1.5) << z0 << ' ' << hole;
    }
}

TEST(VirtualSlices, TouchingLabelsLeaveNoGap) {
  // Three sectors of a disc whose borders turn from slice to slice.
  const LabelVolume in = shapes(60, 60, 5, 8, [](double x, double y, int k) {
    if (std::hypot(x - 30, y - 30) >= 25) return 0;
    const double a = std::atan2(y - 30 - k, x - 30 + 2 * k) + 0.5 * k + 10 * M_PI;
    return 1 + static_cast<int>(a / (2 * M_PI / 3)) % 3;
  });
  const LabelVolume out = interpolated(in, 7).volume;
  for (int k = 0; k < out.size[2]; ++k)
    for (int l : {1, 2, 3}) EXPECT_GT(area(out, k, l), 300) << k;
  expect_no_holes_in_tissue(in, out, 7);
}

TEST(VirtualSlices, PixelsOfOneLabelInBothSlicesKeepItBetween) {
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    const LabelVolume in = random_volume(seed);
    const LabelVolume out = interpolated(in, 3).volume;
    for (int k = 0; k + 1 < in.size[2]; ++k) {
      const auto low = slice(in, k), high = slice(in, k + 1);
      for (int j = 1; j <= 3; ++j) {
        const auto here = slice(out, 4 * k + j);
        for (std::size_t p = 0; p < low.size(); ++p)
          ASSERT_TRUE(low[p] == 0 || low[p] != high[p] || here[p] == low[p]) << "seed " << seed;
      }
    }
  }
}

TEST(VirtualSlices, NoLabelAppearsThatNeitherSliceHas) {
  for (std::uint64_t seed = 0; seed < 120; seed += 6) {  // blobs
    const LabelVolume in = random_volume(seed);
    const LabelVolume out = interpolated(in, 3).volume;
    for (int k = 0; k + 1 < in.size[2]; ++k) {
      std::vector<std::uint16_t> known = slice(in, k);
      const auto high = slice(in, k + 1);
      known.insert(known.end(), high.begin(), high.end());
      std::sort(known.begin(), known.end());
      for (int j = 1; j <= 3; ++j)
        for (std::uint16_t l : slice(out, 4 * k + j))
          ASSERT_TRUE(std::binary_search(known.begin(), known.end(), l) || l == 0) << "seed " << seed;
    }
  }
}

/// The components of the output are those of the input, one to one.
void expect_same_components(const LabelVolume& in, const LabelVolume& out, int per_gap, const std::string& what) {
  const std::vector<int> a = components(in), b = components(out);
  std::map<int, int> forth, back;
  for (int k = 0; k < in.size[2]; ++k)
    for (int j = 0; j < in.size[1]; ++j)
      for (int i = 0; i < in.size[0]; ++i) {
        const int ca = a[in.index(i, j, k)], cb = b[out.index(i, j, k * (per_gap + 1))];
        ASSERT_EQ(ca == 0, cb == 0) << what;
        if (ca == 0) continue;
        ASSERT_EQ(forth.emplace(ca, cb).first->second, cb) << what << ": a component was split";
        ASSERT_EQ(back.emplace(cb, ca).first->second, ca) << what << ": components were joined";
      }
  ASSERT_EQ(back.size(), static_cast<std::size_t>(*std::max_element(b.begin(), b.end())))
      << what << ": a component was added";
}

TEST(VirtualSlices, ComponentsAreThoseOfTheInput) {
  for (std::uint64_t seed = 0; seed < 1500; ++seed) {
    const LabelVolume in = random_volume(seed);
    const int per_gap = 1 + static_cast<int>(seed % 5);
    InterpolateOptions options;
    options.per_gap = per_gap;
    options.tension = seed % 3 == 0 ? 1 : seed % 3 == 1 ? 0.25 : 0.5;
    expect_same_components(in, add_virtual_slices(in, 2, options).volume, per_gap, "seed " + std::to_string(seed));
    if (HasFatalFailure()) return;
  }
}

TEST(VirtualSlices, PartsThatGrowTowardsEachOtherStayApart) {
  // Two discs of one label that come within a pixel of each other; the spline would make them meet.
  const LabelVolume in = shapes(70, 40, 6, 8, [](double x, double y, int k) {
    const double gap = k == 2 || k == 3 ? 1 : 16;
    return x < 35 - gap / 2 ? std::hypot(x - 35 + gap / 2 + 11, y - 20) < 12
                            : x >= 35 + gap / 2 && std::hypot(x - 35 - gap / 2 - 11, y - 20) < 12;
  });
  ASSERT_EQ(component_count(in), 2);
  for (double tension : {0.25, 1.0}) {
    InterpolateOptions options;
    options.per_gap = 7;
    options.tension = tension;
    EXPECT_EQ(component_count(add_virtual_slices(in, 2, options).volume), 2) << tension;
  }
}

TEST(VirtualSlices, BarelyOverlappingDiscsStayConnected) {
  const LabelVolume in = shapes(60, 40, 2, 10, [](double x, double y, int k) {
    return std::hypot(x - (k ? 40.5 : 20.5), y - 20) < 10.6 ? 1 : 0;
  });
  ASSERT_EQ(component_count(in), 1);
  const LabelVolume out = interpolated(in, 9).volume;
  EXPECT_EQ(component_count(out), 1);
}

TEST(VirtualSlices, MirroredInputGivesMirroredOutput) {
  for (std::uint64_t seed = 0; seed < 300; seed += 6) {  // blobs
    const LabelVolume in = random_volume(seed);
    LabelVolume mirrored = in;
    for (int k = 0; k < in.size[2]; ++k)
      for (int j = 0; j < in.size[1]; ++j)
        for (int i = 0; i < in.size[0]; ++i)
          mirrored.voxels[in.index(i, j, k)] = in.voxels[in.index(in.size[0] - 1 - i, j, k)];
    const LabelVolume out = interpolated(in, 3).volume, other = interpolated(mirrored, 3).volume;
    std::size_t different = 0;
    for (int k = 0; k < out.size[2]; ++k)
      for (int j = 0; j < out.size[1]; ++j)
        for (int i = 0; i < out.size[0]; ++i)
          different += out.voxels[out.index(i, j, k)] != other.voxels[out.index(out.size[0] - 1 - i, j, k)];
    EXPECT_LE(different, out.voxels.size() / 200) << "seed " << seed;  // exact ties may fall either way
  }
}

TEST(VirtualSlices, NumbersOfLabelsPlayNoPart) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    if (seed % 6 == 1 || seed % 6 == 5) continue;  // noise: nearly every pixel is a tie of three labels
    const LabelVolume in = random_volume(seed);
    const auto renumber = [&](LabelVolume v) {
      const int n = static_cast<int>(v.labels.size());
      for (std::uint16_t& l : v.voxels) l = static_cast<std::uint16_t>(l == 0 ? 0 : n - l);
      return v;
    };
    EXPECT_EQ(renumber(interpolated(in, 2).volume).voxels, interpolated(renumber(in), 2).volume.voxels)
        << "seed " << seed;
  }
}

TEST(VirtualSlices, ThreadsDoNotShow) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const LabelVolume in = random_volume(seed);
    InterpolateOptions one, four;
    one.per_gap = four.per_gap = 4;
    one.threads = 1;
    four.threads = 4;
    EXPECT_EQ(add_virtual_slices(in, 2, one).volume.voxels, add_virtual_slices(in, 2, four).volume.voxels);
  }
}

TEST(VirtualSlices, AnyAxisGivesTheSameSlices) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const LabelVolume in = random_volume(seed);
    const LabelVolume expected = interpolated(in, 3).volume;
    for (int axis : {0, 1}) {
      const LabelVolume out = interpolated(turned(in, axis), 3, axis).volume;
      const LabelVolume wanted = turned(expected, axis);
      EXPECT_EQ(out.size, wanted.size);
      EXPECT_EQ(out.spacing_mm, wanted.spacing_mm);
      EXPECT_EQ(out.voxels, wanted.voxels) << "seed " << seed << " axis " << axis;
    }
  }
}

TEST(VirtualSlices, LabelCutByTheImageBorderStaysCut) {
  const LabelVolume in = shapes(30, 30, 3, 6, [](double x, double, int k) { return x < 10 + 6 * k ? 1 : 0; });
  const LabelVolume out = interpolated(in, 5).volume;
  for (int k = 0; k < out.size[2]; ++k) {
    const double width = area(out, k, 1) / 30;
    EXPECT_EQ(width, std::round(width)) << k;  // a straight edge from border to border
    EXPECT_NEAR(width, 10 + k, 1) << k;
  }
}

TEST(VirtualSlices, FullAndEmptySlicesAreNoTrouble) {
  const LabelVolume full = shapes(12, 12, 3, 4, [](double, double, int) { return 1; });
  for (std::uint16_t v : interpolated(full, 3).volume.voxels) ASSERT_EQ(v, 1);
  const LabelVolume gap = shapes(12, 12, 3, 4, [](double, double, int k) { return k == 1 ? 0 : 1; });
  const LabelVolume out = interpolated(gap, 3).volume;
  EXPECT_EQ(area(out, 4, 1), 0);
  EXPECT_EQ(area(out, 2, 1), 0);
  EXPECT_EQ(component_count(out), 2);
}

TEST(VirtualSlices, WrongOptionsAreUsageErrors) {
  const LabelVolume in = random_volume(0);
  InterpolateOptions options;
  options.per_gap = -1;
  EXPECT_THROW(add_virtual_slices(in, 2, options), Error);
  options.per_gap = 1001;
  EXPECT_THROW(add_virtual_slices(in, 2, options), Error);
  options.per_gap = 1;
  EXPECT_THROW(add_virtual_slices(in, 3, options), Error);
  options.tension = std::nan("");
  EXPECT_THROW(add_virtual_slices(in, 2, options), Error);
}

}  // namespace
}  // namespace stackmesh
