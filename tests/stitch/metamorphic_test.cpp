// The same stack moved, scaled, mirrored, renumbered, or on more threads.
#include <algorithm>
#include <cstring>

#include "checks.h"
#include "random_stacks.h"

namespace stackmesh {
namespace {

using namespace testing_support;

bool same_bytes(const InterfaceComplex& a, const InterfaceComplex& b) {
  return a.points.size() == b.points.size() && a.triangles.size() == b.triangles.size() &&
         std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof(Vec3)) == 0 &&
         std::equal(a.triangles.begin(), a.triangles.end(), b.triangles.begin(), [](const InterfaceTriangle& s, const InterfaceTriangle& t) {
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
  if (n < 3) GTEST_SKIP() << "one label only";
  // The voxels of label k become label n - k: same numbers, other places.
  for (std::uint16_t& v : other.voxels)
    if (v != 0) v = static_cast<std::uint16_t>(n - v);
  const SurfaceCheck a = check_surface(stitch_volume(volume(), 0.5, threads(1)).complex());
  const InterfaceComplex& c = stitch_volume(other, 0.5, threads(1)).complex();
  EXPECT_EQ(defects(c), "");
  const SurfaceCheck b = check_surface(c);
  ASSERT_EQ(a.labels.size(), b.labels.size());
  for (const LabelSurface& l : a.labels)
    EXPECT_NEAR(surface_of(b, static_cast<Label>(n) - l.label).volume_mm3, l.volume_mm3, 1e-9 * l.volume_mm3);
}

TEST_P(StitchMetamorphic, MirroredStackIsClosedWithTheSameVolumes) {
  for (int axis = 0; axis < 3; ++axis) {
    const LabelVolume v = volume();
    LabelVolume mirrored = v;
    for (int k = 0; k < v.size[2]; ++k)
      for (int j = 0; j < v.size[1]; ++j)
        for (int i = 0; i < v.size[0]; ++i) {
          const int m[3] = {axis == 0 ? v.size[0] - 1 - i : i, axis == 1 ? v.size[1] - 1 - j : j, axis == 2 ? v.size[2] - 1 - k : k};
          mirrored.voxels[v.index(m[0], m[1], m[2])] = v.voxels[v.index(i, j, k)];
        }
    const SurfaceCheck a = check_surface(stitch_volume(v, 0, threads(1)).complex());
    const Stitched s = stitch_volume(mirrored, 0, threads(1));
    EXPECT_EQ(defects(s.complex()), "") << "axis " << axis;
    const SurfaceCheck b = check_surface(s.complex());
    ASSERT_EQ(a.labels.size(), b.labels.size());
    for (const LabelSurface& l : a.labels)  // ties of the triangulation fall differently
      EXPECT_NEAR(surface_of(b, l.label).volume_mm3, l.volume_mm3, 0.1 * l.volume_mm3) << "axis " << axis << " label " << l.label;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, StitchMetamorphic, ::testing::Range(0, 24));

}  // namespace
}  // namespace stackmesh
