// The same stack moved, scaled, mirrored, renumbered, or on more threads.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "checks.h"
#include "random_stacks.h"

namespace stackmesh {
namespace {

using namespace testing_support;

bool same_bytes(const InterfaceComplex& a, const InterfaceComplex& b) {
  return a.points.size() == b.points.size() && a.triangles.size() == b.triangles.size() &&
         std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof(Vec3)) == 0 &&
         std::equal(a.triangles.begin(), a.triangles.end(), b.triangles.begin(),
                    [](const InterfaceTriangle& s, const InterfaceTriangle& t) {
                      return s.v == t.v && s.below == t.below && s.above == t.above;
                    });
}

class StitchMetamorphic : public ::testing::TestWithParam<int> {
 protected:
  LabelVolume volume() const { return random_volume(static_cast<std::uint64_t>(GetParam())); }
  static StitchOptions threads(int n) {
    StitchOptions o;
    o.threads = n;
    return o;
  }
};

TEST_P(StitchMetamorphic, ThreadsAndRunsGiveTheSameBytes) {
  const Stitched one = stitch_volume(volume(), 0.5, threads(1));
  EXPECT_TRUE(same_bytes(one.complex(), stitch_volume(volume(), 0.5, threads(2)).complex()));
  EXPECT_TRUE(same_bytes(one.complex(), stitch_volume(volume(), 0.5, threads(1)).complex()));
}

TEST_P(StitchMetamorphic, ScalingByTwoScalesThePointsExactly) {
  LabelVolume doubled = volume();
  for (double& s : doubled.spacing_mm) s *= 2;
  const Stitched a = stitch_volume(volume(), 0.5, threads(1)), b = stitch_volume(doubled, 0.5, threads(1));
  ASSERT_EQ(a.complex().points.size(), b.complex().points.size());
  for (std::size_t i = 0; i < a.complex().points.size(); ++i) {
    EXPECT_EQ(2 * a.complex().points[i].x, b.complex().points[i].x);
    EXPECT_EQ(2 * a.complex().points[i].y, b.complex().points[i].y);
    EXPECT_EQ(2 * a.complex().points[i].z, b.complex().points[i].z);
  }
}

TEST_P(StitchMetamorphic, TranslationMovesTheFrameOnly) {
  LabelVolume moved = volume();
  moved.origin_mm = {100, -20, 3};
  const Stitched a = stitch_volume(volume(), 0.5, threads(1)), b = stitch_volume(moved, 0.5, threads(1));
  EXPECT_TRUE(same_bytes(a.complex(), b.complex()));
}

TEST_P(StitchMetamorphic, RenumberedLabelsKeepTheirVolumes) {
  LabelVolume other = volume();
  const std::size_t n = other.labels.size();
  // The voxels of label k become label n - k: same numbers, other places.
  for (std::uint16_t& v : other.voxels)
    if (v != 0) v = static_cast<std::uint16_t>(n - v);
  const SurfaceCheck a = check_surface(stitch_volume(volume(), 0.5, threads(1)).complex());
  const Stitched renumbered = stitch_volume(other, 0.5, threads(1));
  const InterfaceComplex& c = renumbered.complex();
  EXPECT_EQ(defects(c), "");
  const SurfaceCheck b = check_surface(c);
  ASSERT_EQ(a.labels.size(), b.labels.size());
  for (const LabelSurface& l : a.labels)
    EXPECT_NEAR(surface_of(b, static_cast<Label>(n) - l.label).volume_mm3, l.volume_mm3, 1e-9 * l.volume_mm3);
}

LabelVolume mirror(const LabelVolume& v, int axis) {
  LabelVolume out = v;
  for (int k = 0; k < v.size[2]; ++k)
    for (int j = 0; j < v.size[1]; ++j)
      for (int i = 0; i < v.size[0]; ++i) {
        std::array<int, 3> m = {i, j, k};
        m[axis] = v.size[axis] - 1 - m[axis];
        out.voxels[out.index(m[0], m[1], m[2])] = v.voxels[v.index(i, j, k)];
      }
  return out;
}

void expect_mirrors_alike(const LabelVolume& v, double tolerance_rel) {
  StitchOptions options;
  options.threads = 1;
  const SurfaceCheck a = check_surface(stitch_volume(v, 0, options).complex());
  for (int axis = 0; axis < 3; ++axis) {
    const Stitched mirrored = stitch_volume(mirror(v, axis), 0, options);
    EXPECT_EQ(defects(mirrored.complex()), "") << "axis " << axis;
    const SurfaceCheck b = check_surface(mirrored.complex());
    ASSERT_EQ(a.labels.size(), b.labels.size());
    for (const LabelSurface& l : a.labels)
      EXPECT_NEAR(surface_of(b, l.label).volume_mm3, l.volume_mm3, tolerance_rel * l.volume_mm3)
          << "axis " << axis << " label " << l.label;
  }
}

// In noise a fifth of a label's volume hangs on how ties of the triangulation fall, and they fall differently in a
// mirror.
TEST_P(StitchMetamorphic, MirroredStackIsClosedWithTheSameVolumes) {
  expect_mirrors_alike(volume(), 0.2);
}

TEST(StitchMetamorphicSmooth, MirroredOrganKeepsItsVolumes) {
  LabelVolume v;
  v.size = {40, 36, 14};
  v.spacing_mm = {1, 1, 2.5};
  v.labels = {{0, ""}, {1, "shell"}, {2, "core"}};
  for (int k = 0; k < v.size[2]; ++k)
    for (int j = 0; j < v.size[1]; ++j)
      for (int i = 0; i < v.size[0]; ++i) {
        const double r = std::hypot(std::hypot(i - 18.3 - 0.4 * k, j - 17.6), 2.5 * (k - 6.7));
        v.voxels.push_back(r < 8 ? 2 : r < 13 ? 1 : 0);
      }
  expect_mirrors_alike(v, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Seeds, StitchMetamorphic, ::testing::Range(0, 24));

}  // namespace
}  // namespace stackmesh
