#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <random>

#include "base/error.h"
#include "shapes.h"
#include "volume/fill_volume.h"

namespace stackmesh {
namespace {

using Status = FillResult::Status;

FillResult expect_verified(const InterfaceComplex& complex, const FillOptions& options = {}) {
  FillResult result = fill_volume(complex, options);
  EXPECT_EQ(result.status, Status::verified) << result.message;
  EXPECT_EQ(result.message.find('\n'), std::string::npos);
  if (result.status == Status::verified) shapes::expect_fills(result.mesh, complex);
  return result;
}

InterfaceComplex cube() {
  return shapes::voxels(1, 1, 1, {1, 1, 1}, [](int, int, int) { return 7; });
}

TEST(FillVolume, CubeIsFilledExactly) {
  const FillResult r = expect_verified(cube());
  const auto v = shapes::volumes(r.mesh);
  ASSERT_EQ(v.size(), 1u);
  EXPECT_NEAR(v.at(7), 1, 1e-15);
  EXPECT_TRUE(r.offending_triangles.empty());
}

TEST(FillVolume, TwoCubesShareTheirFace) {
  const auto complex = shapes::voxels(2, 1, 1, {1, 1, 1}, [](int i, int, int) { return i == 0 ? 3 : 9; });
  const auto v = shapes::volumes(expect_verified(complex).mesh);
  ASSERT_EQ(v.size(), 2u);
  EXPECT_DOUBLE_EQ(v.at(3), 1);
  EXPECT_DOUBLE_EQ(v.at(9), 1);
}

TEST(FillVolume, LabelsMayBeNegativeOrLarge) {
  const auto complex = shapes::voxels(2, 1, 1, {1, 1, 1}, [](int i, int, int) { return i == 0 ? -5 : 2000000000; });
  const auto v = shapes::volumes(expect_verified(complex).mesh);
  EXPECT_DOUBLE_EQ(v.at(-5), 1);
  EXPECT_DOUBLE_EQ(v.at(2000000000), 1);
}

TEST(FillVolume, CavityStaysEmpty) {
  const auto complex =
      shapes::voxels(3, 3, 3, {1, 1, 1}, [](int i, int j, int k) { return i == 1 && j == 1 && k == 1 ? 0 : 4; });
  const auto v = shapes::volumes(expect_verified(complex).mesh);
  ASSERT_EQ(v.size(), 1u);
  EXPECT_NEAR(v.at(4), 26, 1e-12);
}

TEST(FillVolume, NestedShellsKeepTheirLabels) {
  InterfaceComplex complex;
  shapes::add_box(complex, {0, 0, 0}, {10, 10, 10}, 1);
  shapes::add_box(complex, {1, 1, 1}, {9, 9, 9}, 2, 1);
  shapes::add_box(complex, {2, 2, 2}, {8, 8, 8}, 0, 2);
  shapes::add_box(complex, {4, 4, 4}, {6, 6, 6}, 3, 0);
  const auto v = shapes::volumes(expect_verified(complex).mesh);
  ASSERT_EQ(v.size(), 3u);
  EXPECT_NEAR(v.at(1), 1000 - 512, 1e-9);
  EXPECT_NEAR(v.at(2), 512 - 216, 1e-9);
  EXPECT_NEAR(v.at(3), 8, 1e-9);
}

TEST(FillVolume, OrientationOfATriangleDoesNotMatter) {
  auto complex = shapes::voxels(2, 1, 1, {1, 1, 1}, [](int i, int, int) { return i + 1; });
  for (std::size_t i = 0; i < complex.triangles.size(); i += 2) {
    std::swap(complex.triangles[i].v[0], complex.triangles[i].v[1]);
    std::swap(complex.triangles[i].below, complex.triangles[i].above);
  }
  const auto v = shapes::volumes(expect_verified(complex).mesh);
  EXPECT_DOUBLE_EQ(v.at(1), 1);
  EXPECT_DOUBLE_EQ(v.at(2), 1);
}

TEST(FillVolume, LShapeDoesNotFillItsNotch) {
  const auto complex = shapes::voxels(2, 2, 1, {1, 1, 1}, [](int i, int j, int) { return i && j ? 0 : 1; });
  EXPECT_NEAR(shapes::volumes(expect_verified(complex).mesh).at(1), 3, 1e-12);
}

TEST(FillVolume, SurfaceBetweenEqualLabelsIsKept) {
  const auto complex = shapes::voxels(2, 1, 1, {1, 1, 1}, [](int i, int, int) { return i + 1; });
  auto same = complex;
  for (auto& t : same.triangles)
    for (Label* l : {&t.below, &t.above})
      if (*l == 2) *l = 1;
  const auto v = shapes::volumes(expect_verified(same).mesh);
  EXPECT_DOUBLE_EQ(v.at(1), 2);
}

TEST(FillVolume, LabelsThatTouchAlongAnEdgeOnly) {
  const auto complex = shapes::voxels(2, 2, 1, {1, 1, 1}, [](int i, int j, int) { return i == j ? i + 1 : 0; });
  const auto v = shapes::volumes(expect_verified(complex).mesh);
  EXPECT_NEAR(v.at(1), 1, 1e-12);
  EXPECT_NEAR(v.at(2), 1, 1e-12);
}

TEST(FillVolume, LabelsThatTouchAtAVertexOnly) {
  const auto complex =
      shapes::voxels(2, 2, 2, {1, 1, 1}, [](int i, int j, int k) { return i == j && j == k ? i + 1 : 0; });
  const auto v = shapes::volumes(expect_verified(complex).mesh);
  EXPECT_NEAR(v.at(1), 1, 1e-12);
  EXPECT_NEAR(v.at(2), 1, 1e-12);
}

TEST(FillVolume, PointsAtOnePlaceCountAsOne) {
  InterfaceComplex complex;  // two boxes that touch at a corner, each with its own copy of it
  shapes::add_box(complex, {0, 0, 0}, {1, 1, 1}, 1);
  shapes::add_box(complex, {1, 1, 1}, {2, 2, 2}, 2);
  const FillResult r = fill_volume(complex, {});
  ASSERT_EQ(r.status, Status::verified) << r.message;
  EXPECT_EQ(r.mesh.points.size(), complex.points.size());
  EXPECT_NEAR(shapes::volumes(r.mesh).at(2), 1, 1e-12);
  for (const auto& f : r.mesh.faces)
    for (const int v : f.v) EXPECT_NE(v, 8);
}

TEST(FillVolume, UnusedPointsStayWhereTheyAre) {
  auto complex = cube();
  complex.points.insert(complex.points.begin(), Vec3{100, 100, 100});
  for (auto& t : complex.triangles)
    for (auto& v : t.v) ++v;
  complex.points.push_back({0.5, 0.5, 0.5});
  const FillResult r = expect_verified(complex);
  for (const auto& t : r.mesh.tets)
    for (const int v : t) EXPECT_TRUE(v != 0 && v != 9);
}

// A ball of random labels: many junctions, edges and corners that only touch.
InterfaceComplex noisy_ball(int n, int labels, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Label> l(static_cast<std::size_t>(n) * n * n);
  for (auto& x : l) x = static_cast<Label>(random() % static_cast<unsigned>(labels));
  const double c = (n - 1) / 2.0;
  return shapes::voxels(n, n, n, {0.7, 0.7, 1.3}, [&](int i, int j, int k) {
    const double r = (i - c) * (i - c) + (j - c) * (j - c) + (k - c) * (k - c);
    return r > n * n / 4.0 ? 0 : l[(static_cast<std::size_t>(k) * n + j) * n + i];
  });
}

TEST(FillVolume, RandomLabelBallsAreAccepted) {
  for (const int n : {2, 3, 5, 8, 13}) {
    for (unsigned seed = 0; seed < 4; ++seed) {
      const auto complex = noisy_ball(n, 4, seed);
      if (complex.triangles.empty()) continue;
      SCOPED_TRACE("n " + std::to_string(n) + " seed " + std::to_string(seed));
      expect_verified(complex);
    }
  }
}

TEST(FillVolume, IsDeterministic) {
  const auto complex = noisy_ball(9, 5, 42);
  FillOptions options;
  options.radius_edge = 1.4;
  options.dihedral_deg = 12;
  const FillResult a = fill_volume(complex, options), b = fill_volume(complex, options);
  ASSERT_EQ(a.status, Status::verified) << a.message;
  EXPECT_EQ(a.mesh.tets, b.mesh.tets);
  EXPECT_EQ(a.mesh.labels, b.mesh.labels);
  EXPECT_EQ(a.message, b.message);
}

TEST(FillVolume, ManyPiecesAreAllFilled) {
  const auto complex = shapes::voxels(
      15, 15, 15, {1, 1, 1}, [](int i, int j, int k) { return i % 2 || j % 2 || k % 2 ? 0 : 1 + (i + j + k) / 2 % 5; });
  double sum = 0;
  for (const auto& [label, v] : shapes::volumes(expect_verified(complex).mesh)) sum += v;
  EXPECT_NEAR(sum, 512, 1e-9);
}

TEST(FillVolume, ExtremeAspectsAreFilled) {
  for (const double z : {50.0, 0.02, 1000.0, 0.001}) {
    SCOPED_TRACE(z);
    auto complex = noisy_ball(7, 3, 5);
    for (Vec3& p : complex.points) p.z *= z / 1.3;
    const FillResult r = expect_verified(complex);
    EXPECT_NE(r.message.find("z scaled"), std::string::npos) << r.message;
  }
}

TEST(FillVolume, VolumeBoundHoldsInMillimetres) {
  const auto complex = shapes::voxels(8, 8, 8, {1, 1, 1}, [](int, int, int) { return 1; });
  FillOptions options;
  options.max_volume_mm3 = 0.05;
  const FillResult r = expect_verified(complex, options);
  EXPECT_GE(r.mesh.tets.size(), 512 / 0.05);
  const int known = static_cast<int>(complex.points.size());
  std::size_t inner = 0, above = 0;
  for (const auto& t : r.mesh.tets) {
    if (std::any_of(t.begin(), t.end(), [&](int v) { return v < known; })) continue;  // the kept surface asks for more
    const Vec3 a = r.mesh.points[t[0]];
    const double v = dot(r.mesh.points[t[1]] - a, cross(r.mesh.points[t[2]] - a, r.mesh.points[t[3]] - a)) / 6;
    ++inner;
    above += v > 0.05;
    EXPECT_LT(v, 0.1);  // TetGen's last optimisation may pass the bound a little
  }
  EXPECT_GT(inner, 1000u);
  EXPECT_LT(above, inner / 50);
}

TEST(FillVolume, FeaturesFarThinnerThanTetGensToleranceAreFilled) {
  for (const double gap : {1e-3, 1e-6, 1e-9, 1e-11}) {
    SCOPED_TRACE(gap);
    InterfaceComplex complex;  // in a box of 500: a slab, and a slit between two boxes
    shapes::add_box(complex, {0, 0, 0}, {500, 500, 500}, 1);
    shapes::add_box(complex, {1, 100, 100}, {1 + gap, 110, 110}, 2, 1);
    shapes::add_box(complex, {200, 200, 2}, {210, 210, 4}, 3, 1);
    shapes::add_box(complex, {200, 200, 4 + gap}, {210, 210, 6}, 3, 1);
    const FillResult r = expect_verified(complex);
    const double slab = (1 + gap - 1) * 100;
    EXPECT_NEAR(shapes::volumes(r.mesh)[2], slab, 1e-9 * slab);
  }
}

TEST(FillVolume, VolumeBoundCountsInMillimetresWhenZIsScaled) {
  auto complex = shapes::voxels(4, 4, 4, {1, 1, 64}, [](int, int, int) { return 1; });
  FillOptions options;
  options.max_volume_mm3 = 64 * 0.05;
  const FillResult r = expect_verified(complex, options);
  EXPECT_NE(r.message.find("z scaled"), std::string::npos) << r.message;
  EXPECT_GT(r.mesh.tets.size(), 64 / 0.05);
  EXPECT_LT(r.mesh.tets.size(), 64 / 0.05 * 10);
}

TEST(FillVolume, QualityRefinesAndKeepsTheSurface) {
  auto complex = shapes::voxels(6, 6, 6, {1, 1, 1}, [](int i, int, int) { return i < 3 ? 1 : 2; });
  FillOptions options;
  options.radius_edge = 1.4;
  options.dihedral_deg = 12;
  const FillResult plain = expect_verified(complex), fine = expect_verified(complex, options);
  EXPECT_GT(fine.mesh.points.size(), plain.mesh.points.size());
  EXPECT_NE(fine.message.find("q1.4/12"), std::string::npos) << fine.message;
  EXPECT_EQ(fine.fallback, "");
}

/// Enough triangles for two workers: four labels in a row, the sheets between them stepped.
InterfaceComplex row_of_labels() {
  return shapes::voxels(56, 16, 16, {1, 1, 1.25},
                        [](int i, int j, int k) { return 1 + (i + (j / 4 + k / 4) % 2) / 14 % 4; });
}

FillOptions graded(int threads = 0) {
  FillOptions options;
  options.radius_edge = 1.4;
  options.inner_growth = 2;
  options.improve_deg = 24;
  options.threads = threads;
  return options;
}

TEST(FillVolume, LabelsInTwoWorkersFitTogetherAndAreTheSameForAnyThreads) {
  const auto complex = row_of_labels();
  ASSERT_GT(complex.triangles.size(), 10000u);
  const FillResult one = expect_verified(complex, graded(1)), two = expect_verified(complex, graded(2));
  EXPECT_NE(one.message.find("in 2 parts"), std::string::npos) << one.message;
  EXPECT_EQ(one.message, two.message);
  ASSERT_EQ(one.mesh.tets, two.mesh.tets);
  EXPECT_EQ(one.mesh.labels, two.mesh.labels);
  ASSERT_EQ(one.mesh.points.size(), two.mesh.points.size());
  EXPECT_EQ(0, std::memcmp(one.mesh.points.data(), two.mesh.points.data(), one.mesh.points.size() * sizeof(Vec3)));
}

TEST(FillVolume, TwiceAsLargeIsTheSameMeshTwiceAsLarge) {
  auto complex = row_of_labels();
  const FillResult small = expect_verified(complex, graded());
  for (Vec3& p : complex.points) p = 2.0 * p;
  const FillResult large = expect_verified(complex, graded());
  ASSERT_EQ(small.mesh.tets, large.mesh.tets);
  for (std::size_t p = 0; p < small.mesh.points.size(); ++p) {
    EXPECT_EQ(2 * small.mesh.points[p].x, large.mesh.points[p].x);
    EXPECT_EQ(2 * small.mesh.points[p].z, large.mesh.points[p].z);
  }
}

TEST(FillVolume, MovedItIsAboutAsFineAndHoldsTheSameVolumes) {
  auto complex = noisy_ball(13, 4, 7);
  const FillResult here = expect_verified(complex, graded());
  for (Vec3& p : complex.points) p = p + Vec3{-1024, 512, 2048};
  const FillResult there = expect_verified(complex, graded());
  EXPECT_NEAR(static_cast<double>(here.mesh.tets.size()), static_cast<double>(there.mesh.tets.size()),
              0.03 * static_cast<double>(here.mesh.tets.size()));
  const auto a = shapes::volumes(here.mesh), b = shapes::volumes(there.mesh);
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [label, mm3] : a) EXPECT_NEAR(b.at(label), mm3, 1e-9 * mm3);
}

TEST(FillVolume, ALabelsOwnVolumeBoundHoldsForItAlone) {
  const auto complex = shapes::voxels(12, 6, 6, {1, 1, 1}, [](int i, int, int) { return i < 6 ? 3 : 7; });
  FillOptions options = graded();
  options.improve_deg.reset();
  const FillResult plain = expect_verified(complex, options);
  options.label_max_volume_mm3 = {{7, 0.02}};
  const FillResult own = expect_verified(complex, options);
  EXPECT_EQ(own.fallback, "");
  const auto count = [](const TetMesh& mesh, Label label) {
    return std::count(mesh.labels.begin(), mesh.labels.end(), label);
  };
  EXPECT_GT(count(own.mesh, 7), 216 / 0.02);
  EXPECT_LT(count(own.mesh, 3), 1.3 * static_cast<double>(count(plain.mesh, 3)));
  EXPECT_GT(estimate_tets(complex, options), 216 / 0.02);
  options.label_max_volume_mm3[7] = 0;
  EXPECT_THROW(fill_volume(complex, options), Error);
}

TEST(FillVolume, EndsSoonWhenItIsGivenUp) {
  const std::atomic<bool> given_up{true};
  FillOptions options = graded();
  options.given_up = &given_up;
  const FillResult r = fill_volume(row_of_labels(), options);
  EXPECT_EQ(r.status, Status::timed_out) << r.message;
  EXPECT_TRUE(r.mesh.tets.empty());
}

}  // namespace
}  // namespace stackmesh
