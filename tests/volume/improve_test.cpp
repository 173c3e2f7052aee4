#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <set>

#include "shapes.h"
#include "volume/fill_volume.h"
#include "volume/improve_tets.h"

namespace stackmesh {
namespace {

/// All dihedral angles of all tets, smallest and largest, from the faces' normals.
std::pair<double, double> dihedrals(const TetMesh& mesh) {
  double low = 180, high = 0;
  constexpr int faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  for (const auto& t : mesh.tets) {
    Vec3 n[4];
    for (int i = 0; i < 4; ++i) {
      const Vec3 a = mesh.points[t[faces[i][0]]];
      n[i] = cross(mesh.points[t[faces[i][1]]] - a, mesh.points[t[faces[i][2]]] - a);
    }
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) {
        const double angle = 180 - std::atan2(norm(cross(n[i], n[j])), dot(n[i], n[j])) * 180 / std::acos(-1.0);
        low = std::min(low, angle), high = std::max(high, angle);
      }
  }
  return {low, high};
}

TetMesh fill(const InterfaceComplex& complex, FillOptions options = {}) {
  if (!options.radius_edge) options.radius_edge = 1.4;
  FillResult result = fill_volume(complex, options);
  EXPECT_EQ(result.status, FillResult::Status::verified) << result.message;
  return std::move(result.mesh);
}

TetMesh improved(TetMesh mesh, std::size_t kept, volume::ImproveCounts* counts = nullptr) {
  volume::ImproveCounts own;
  volume::improve_tets(mesh, kept, {}, counts ? *counts : own);
  return mesh;
}

/// Labels at random: many junctions, edges and corners that only touch, bent a little so that nothing is coplanar.
InterfaceComplex random_labels(int n, int labels, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Label> l(static_cast<std::size_t>(n) * n * n);
  for (auto& x : l) x = static_cast<Label>(random() % static_cast<unsigned>(labels));
  InterfaceComplex complex = shapes::voxels(
      n, n, n, {0.7, 0.7, 1.1}, [&](int i, int j, int k) { return l[(static_cast<std::size_t>(k) * n + j) * n + i]; });
  std::uniform_real_distribution<double> shift(-0.05, 0.05);
  for (Vec3& p : complex.points) p = p + Vec3{shift(random), shift(random), shift(random)};
  return complex;
}

TEST(ImproveTets, TheAxisOfATallBipyramidIsRemoved) {
  // Three tets around its long axis have dihedrals of 160 degrees at the base; two on the base have half of that.
  TetMesh mesh;
  mesh.points = {{0, 0, -3}, {0, 0, 3}, {1, 0, 0}, {-0.5, 0.9, 0}, {-0.5, -0.9, 0}};
  mesh.tets = {{0, 1, 2, 3}, {0, 1, 3, 4}, {0, 1, 4, 2}};
  mesh.labels = {5, 5, 5};
  for (const int apex : {0, 1})
    for (int i = 0; i < 3; ++i) mesh.faces.push_back({{apex, 2 + i, 2 + (i + 1) % 3}, apex ? 0 : 5, apex ? 5 : 0});
  volume::ImproveCounts counts;
  ASSERT_GT(dihedrals(mesh).second, 150);
  const TetMesh after = improved(mesh, 5, &counts);
  EXPECT_EQ(after.tets.size(), 2u);
  EXPECT_EQ(counts.edges, 1u);
  EXPECT_LT(dihedrals(after).second, 90);
  EXPECT_NEAR(shapes::volumes(after).at(5), shapes::volumes(mesh).at(5), 1e-15);
}

TEST(ImproveTets, SliversOfAFilledSphereGo) {
  const InterfaceComplex sphere = shapes::sphere(3, 10);
  FillOptions options;
  options.inner_growth = 1.2;
  const TetMesh before = fill(sphere, options);
  ASSERT_LT(dihedrals(before).first, 12);
  const TetMesh after = improved(before, sphere.points.size());
  shapes::expect_fills(after, sphere);
  EXPECT_GT(dihedrals(after).first, 18);
  EXPECT_LT(dihedrals(after).second, 155);
  EXPECT_LT(after.tets.size(), before.tets.size() * 11 / 10);
}

TEST(ImproveTets, RandomComplexesKeepEveryTriangleAndVolume) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE(seed);
    const InterfaceComplex complex = random_labels(5, 4, seed);
    const TetMesh before = fill(complex);
    const TetMesh after = improved(before, complex.points.size());
    shapes::expect_fills(after, complex);
    ASSERT_EQ(before.faces.size(), after.faces.size());
    EXPECT_EQ(0, std::memcmp(before.faces.data(), after.faces.data(), before.faces.size() * sizeof(InterfaceTriangle)));
    const auto v = shapes::volumes(before), w = shapes::volumes(after);
    ASSERT_EQ(v.size(), w.size());
    for (const auto& [label, mm3] : v) EXPECT_NEAR(w.at(label), mm3, 1e-12 * 100);
    EXPECT_GE(dihedrals(after).first, dihedrals(before).first);
  }
}

/// A box of n * n * n cells with a wavy middle sheet: two labels, many tets.
TetMesh many_tets(InterfaceComplex* complex) {
  const int n = 16;
  *complex =
      shapes::voxels(n, n, n, {1, 1, 1}, [](int i, int j, int k) { return k + (i / 4 + j / 4) % 2 < 8 ? 1 : 2; });
  std::mt19937 random(5);
  std::uniform_real_distribution<double> shift(-0.2, 0.2);
  for (Vec3& p : complex->points) p = p + Vec3{shift(random), shift(random), shift(random)};
  FillOptions options;
  options.max_volume_mm3 = 0.12;
  return fill(*complex, options);
}

TEST(ImproveTets, PiecesSideBySideAreAsGoodAsOneAndTheSameForAnyThreads) {
  InterfaceComplex complex;
  const TetMesh before = many_tets(&complex);
  ASSERT_GT(before.tets.size(), 40000u);  // two pieces
  TetMesh one = before, two = before;
  volume::ImproveOptions options;
  volume::ImproveCounts counts;
  options.threads = 1;
  volume::improve_tets(one, complex.points.size(), options, counts);
  options.threads = 2;
  volume::improve_tets(two, complex.points.size(), options, counts);
  shapes::expect_fills(one, complex);
  EXPECT_GT(dihedrals(one).first, dihedrals(before).first);
  EXPECT_GT(dihedrals(one).first, 14);  // along the cuts, too
  ASSERT_EQ(one.tets, two.tets);
  ASSERT_EQ(one.points.size(), two.points.size());
  EXPECT_EQ(0, std::memcmp(one.points.data(), two.points.data(), one.points.size() * sizeof(Vec3)));
}

TEST(ImproveTets, OutOfTimeTheMeshIsWholeAllTheSame) {
  InterfaceComplex complex;
  const TetMesh before = many_tets(&complex);
  TetMesh after = before;
  volume::ImproveOptions options;
  options.deadline = std::chrono::steady_clock::now();
  volume::ImproveCounts counts;
  volume::improve_tets(after, complex.points.size(), options, counts);
  EXPECT_EQ(counts.moved + counts.edges + counts.faces + counts.collapsed + counts.inserted, 0u);
  EXPECT_EQ(after.tets.size(), before.tets.size());
  shapes::expect_fills(after, complex);
}

TEST(ImproveTets, AFlatTetThatNoSingleChangeMendsGoes) {
  // Random labels, not remeshed: TetGen leaves slivers; what is left below 14 degrees after the single changes is
  // searched.
  std::size_t searched = 0;
  for (unsigned seed = 20; seed < 26; ++seed) {
    const InterfaceComplex complex = random_labels(5, 3, seed);
    volume::ImproveCounts counts;
    const TetMesh after = improved(fill(complex), complex.points.size(), &counts);
    shapes::expect_fills(after, complex);
    searched += counts.searched;
  }
  EXPECT_GT(searched, 0u);
}

TEST(ImproveTets, PlatesThatAreFlatEverywhereAreNotSearchedForEver) {
  // Three plates a hundredth as thick as their triangles: hundreds of tets are flat, and nothing helps. The search
  // looks at what it has changed, not at all of them again and again, which took 130 times the tets and minutes for a
  // drawing of a few lines.
  InterfaceComplex plates;
  for (int plate = 0; plate < 3; ++plate) {
    InterfaceComplex one = shapes::voxels(14, 14, 1, {1, 1, 0.01}, [](int, int, int) { return 1; });
    std::mt19937 random(static_cast<unsigned>(plate));
    std::uniform_real_distribution<double> shift(-0.3, 0.3);
    for (Vec3& p : one.points) p = p + Vec3{shift(random), shift(random), 5.0 * plate};
    const int offset = static_cast<int>(plates.points.size());
    plates.points.insert(plates.points.end(), one.points.begin(), one.points.end());
    for (InterfaceTriangle t : one.triangles) {
      for (auto& v : t.v) v += offset;
      plates.triangles.push_back(t);
    }
  }
  const TetMesh mesh = fill(plates);
  volume::ImproveCounts counts;
  const TetMesh after = improved(mesh, plates.points.size(), &counts);
  shapes::expect_fills(after, plates);
  EXPECT_GT(counts.steps, mesh.tets.size() / 2);
  EXPECT_LT(counts.steps, 30 * after.tets.size());
  std::printf("[          ] %zu steps for %zu tets, then %zu\n", counts.steps, mesh.tets.size(), after.tets.size());
}

TEST(ImproveTets, NoSliverIsLeftWhereTheSurfaceAllowsBetter) {
  // Shells between two shaken spheres, from thick ones to ones thinner than an edge: many tets have all corners on the
  // surface.
  for (const double gap : {5.0, 2.0, 1.2, 0.8})
    for (unsigned seed = 0; seed < 3; ++seed) {
      SCOPED_TRACE(std::to_string(gap) + " " + std::to_string(seed));
      InterfaceComplex shell = shapes::sphere(3, 10);
      const InterfaceComplex inner = shapes::sphere(3, 10 - gap);
      const int offset = static_cast<int>(shell.points.size());
      shell.points.insert(shell.points.end(), inner.points.begin(), inner.points.end());
      for (InterfaceTriangle t : inner.triangles) {
        for (auto& v : t.v) v += offset;
        shell.triangles.push_back({t.v, 0, 1});
      }
      std::mt19937 random(seed);
      std::uniform_real_distribution<double> shift(-0.15, 0.15);
      for (Vec3& p : shell.points) p = p + Vec3{shift(random), shift(random), shift(random)};
      FillOptions options;
      options.inner_growth = 2;
      options.improve_deg = 24;
      const TetMesh mesh = fill(shell, options);
      const auto [low, high] = dihedrals(mesh);
      EXPECT_GT(low, 15);
      EXPECT_LT(high, 155);
    }
}

TEST(ImproveTets, NothingIsDoneWhereAllIsWell) {
  const InterfaceComplex box = shapes::voxels(1, 1, 1, {1, 1, 1}, [](int, int, int) { return 3; });
  const TetMesh mesh = fill(box);
  ASSERT_GT(dihedrals(mesh).first, 24);
  ASSERT_LT(dihedrals(mesh).second, 130);
  volume::ImproveCounts counts;
  const TetMesh after = improved(mesh, box.points.size(), &counts);
  EXPECT_EQ(after.tets, mesh.tets);
  EXPECT_EQ(counts.moved + counts.edges + counts.faces + counts.collapsed + counts.inserted, 0u);
}

TEST(ImproveTets, ScalesWithTheMesh) {
  const InterfaceComplex complex = random_labels(5, 3, 9);
  TetMesh mesh = fill(complex);
  const TetMesh a = improved(mesh, complex.points.size());
  for (Vec3& p : mesh.points) p = 2.0 * p;
  const TetMesh b = improved(mesh, complex.points.size());
  ASSERT_EQ(a.tets, b.tets);
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    const Vec3 twice = 2.0 * a.points[i];
    EXPECT_EQ(0, std::memcmp(&twice, &b.points[i], sizeof twice));
  }
}

TEST(ImproveTets, FillVolumeVerifiesWhatItImproved) {
  const InterfaceComplex complex = random_labels(6, 4, 1);
  FillOptions options;
  options.improve_deg = 24;
  const TetMesh mesh = fill(complex, options);
  shapes::expect_fills(mesh, complex);
  const TetMesh again = fill(complex, options);
  EXPECT_EQ(mesh.tets, again.tets);
  ASSERT_EQ(mesh.points.size(), again.points.size());
  EXPECT_EQ(0, std::memcmp(mesh.points.data(), again.points.data(), mesh.points.size() * sizeof(Vec3)));
}

TEST(FillVolume, InnerEdgesGrowToAboutTwiceTheSurfaces) {
  const InterfaceComplex sphere = shapes::sphere(4, 10);  // edges of 0.7
  FillOptions options;
  options.inner_growth = 2;
  const TetMesh mesh = fill(sphere, options);
  std::vector<double> inner, outer;
  for (const auto& t : mesh.tets)
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) {
        const bool deep = norm(mesh.points[t[i]]) < 7 && norm(mesh.points[t[j]]) < 7;
        if (deep) inner.push_back(norm(mesh.points[t[i]] - mesh.points[t[j]]));
      }
  for (const auto& f : sphere.triangles) outer.push_back(norm(sphere.points[f.v[0]] - sphere.points[f.v[1]]));
  std::sort(inner.begin(), inner.end()), std::sort(outer.begin(), outer.end());
  const double ratio = inner[inner.size() / 2] / outer[outer.size() / 2];
  EXPECT_GT(ratio, 1.6);
  EXPECT_LT(ratio, 2.4);
  EXPECT_LT(inner.back(), 5 * outer.back());
}

TEST(EstimateTets, IsNearWhatIsMade) {
  for (const int level : {3, 4}) {
    const InterfaceComplex sphere = shapes::sphere(level, 10);
    for (const double growth : {1.0, 2.0}) {
      FillOptions options;
      options.inner_growth = growth;
      const double made = static_cast<double>(fill(sphere, options).tets.size()),
                   estimate = estimate_tets(sphere, options);
      EXPECT_GT(estimate, 0.6 * made) << made;
      EXPECT_LT(estimate, 1.7 * made) << made;
    }
    FillOptions options;
    options.max_volume_mm3 = 0.5;
    const double made = static_cast<double>(fill(sphere, options).tets.size()),
                 estimate = estimate_tets(sphere, options);
    EXPECT_GT(estimate, 0.6 * made) << made;
    EXPECT_LT(estimate, 1.7 * made) << made;
  }
}

/// A plate whose squares have sides of 1 mm, so that triangles' mean edge is (2 + sqrt 2) / 3 mm.
InterfaceComplex plate(int wide, double thick_mm) {
  return shapes::voxels(wide, wide, 1, {1, 1, thick_mm}, [](int, int, int) { return 5; });
}

TEST(ThicknessInEdges, IsThatOfAPlateAndOfABall) {
  const double edge = (2 + std::sqrt(2.0)) / 3;
  EXPECT_NEAR(thickness_in_edges(plate(200, 0.25)), 0.25 / edge, 0.002);
  EXPECT_NEAR(thickness_in_edges(plate(1, 1)), 1.0 / 3 / edge, 1e-12);  // 2 * 1 mm3 / 6 mm2
  const InterfaceComplex ball = shapes::sphere(3, 10);                  // 2/3 of the radius, edges of about 1.4 mm
  EXPECT_NEAR(thickness_in_edges(ball), 20.0 / 3 / 1.4, 0.4);
  EXPECT_EQ(thickness_in_edges({}), 0);
}

TEST(ImproveTets, LabelsFilledWithoutRefinementAreFilledInHalvesToo) {
  const InterfaceComplex complex =  // above 10,000 triangles
      shapes::voxels(60, 60, 1, {1, 1, 0.5}, [](int i, int, int) { return i < 30 ? 5 : 6; });
  FillOptions options;
  options.improve_deg = 24;
  const FillResult r = fill_volume(complex, options);
  ASSERT_EQ(r.status, FillResult::Status::verified) << r.message;
  EXPECT_NE(r.message.find("TetGen -pYM in 2 parts"), std::string::npos) << r.message;
  for (const Label label : {5, 6}) EXPECT_NEAR(shapes::volumes(r.mesh).at(label), 30 * 60 * 0.5, 1e-6);
}

}  // namespace
}  // namespace stackmesh
