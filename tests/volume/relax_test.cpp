#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "shapes.h"
#include "validate/check_surface.h"
#include "volume/fill_volume.h"
#include "volume/label_tets.h"
#include "volume/relax_surface.h"
#include "volume/tet_quality.h"

namespace stackmesh {
namespace {

constexpr double kGoal_deg = 20;

double quality_of(const TetMesh& m, std::size_t t) {
  const auto& v = m.tets[t];
  return volume::tet_quality(m.points[v[0]], m.points[v[1]], m.points[v[2]], m.points[v[3]]);
}

/// Tets that relax_surface() works on.
std::size_t bad_tets(const TetMesh& m) {
  std::size_t n = 0;
  for (std::size_t t = 0; t < m.tets.size(); ++t) n += quality_of(m, t) < std::sin(kGoal_deg * M_PI / 180);
  return n;
}

double worst(const TetMesh& m) {
  double least = 2;
  for (std::size_t t = 0; t < m.tets.size(); ++t) least = std::min(least, quality_of(m, t));
  return least;
}

/// Labels at random, 0 among them, bent enough that kept triangles meet at narrow angles.
TetMesh bent_labels(unsigned seed, std::size_t* kept, double bend_z = 1) {
  constexpr int n = 5;
  std::mt19937 random(seed);
  std::vector<Label> l(n * n * n);
  for (auto& x : l) x = static_cast<Label>(random() % 3U);
  InterfaceComplex complex = shapes::voxels(
      n, n, n, {1, 1, 1}, [&](int i, int j, int k) { return l[static_cast<std::size_t>((k * n + j) * n + i)]; });
  std::uniform_real_distribution<double> shift(-0.18, 0.18);
  for (Vec3& p : complex.points) p = p + Vec3{shift(random), shift(random), bend_z * shift(random)};
  *kept = complex.points.size();
  FillOptions options;
  options.radius_edge = 1.4;
  FillResult result = fill_volume(complex, options);
  EXPECT_EQ(result.status, FillResult::Status::verified) << result.message;
  return std::move(result.mesh);
}

std::size_t crossings(const TetMesh& m) {
  return check_surface({m.points, m.faces}, {}).self_intersections;
}

TEST(RelaxSurface, MendsWhatPointsInsideCannotAndCrossesNothing) {
  std::size_t before = 0, after = 0, moved_points = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::size_t kept = 0;
    TetMesh mesh = bent_labels(seed, &kept);
    ASSERT_EQ(crossings(mesh), 0U) << "seed " << seed;
    const TetMesh old = mesh;
    const std::vector<std::int32_t> moved = volume::relax_surface(mesh, kept, kGoal_deg, true);
    EXPECT_EQ(volume::check_filled(mesh, 1).message, "") << "seed " << seed;
    EXPECT_EQ(crossings(mesh), 0U) << "seed " << seed;
    EXPECT_GE(worst(mesh), worst(old)) << "seed " << seed;
    EXPECT_EQ(mesh.tets, old.tets);
    const std::set<std::int32_t> listed(moved.begin(), moved.end());
    for (std::size_t v = 0; v < kept; ++v) {
      const double way = norm(mesh.points[v] - old.points[v]);
      EXPECT_EQ(way > 0, listed.count(static_cast<std::int32_t>(v)) == 1) << "seed " << seed << " point " << v;
      EXPECT_LT(way, 0.3) << "further than a share of an edge";
    }
    before += bad_tets(old);
    after += bad_tets(mesh);
    moved_points += moved.size();
  }
  EXPECT_GT(before, 1000U) << "the meshes no longer have bad tets";
  EXPECT_LT(after, 3 * before / 4);
  EXPECT_GT(moved_points, 200U);
}

TEST(RelaxSurface, LeavesThePointsOfTheOutsideWhereOtherSurfacesMayLie) {
  std::size_t inside = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::size_t kept = 0;
    TetMesh mesh = bent_labels(seed, &kept);
    std::set<std::int32_t> outer;
    for (const InterfaceTriangle& f : mesh.faces)
      if (f.below == 0 || f.above == 0) outer.insert(f.v.begin(), f.v.end());
    for (const std::int32_t v : volume::relax_surface(mesh, kept, kGoal_deg, false)) {
      EXPECT_EQ(outer.count(v), 0U);
      ++inside;
    }
  }
  EXPECT_GT(inside, 0U) << "nothing was moved at all";
}

TEST(RelaxSurface, FlatEndsStayFlat) {
  std::size_t moved = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::size_t kept = 0;
    TetMesh mesh = bent_labels(seed, &kept, 0);
    std::set<std::int32_t> flat;
    for (const InterfaceTriangle& f : mesh.faces)
      if ((f.below == 0 || f.above == 0) && mesh.points[f.v[0]].z == mesh.points[f.v[1]].z &&
          mesh.points[f.v[0]].z == mesh.points[f.v[2]].z)
        flat.insert(f.v.begin(), f.v.end());
    for (const std::int32_t v : volume::relax_surface(mesh, kept, kGoal_deg, true)) {
      EXPECT_EQ(flat.count(v), 0U) << "seed " << seed;
      ++moved;
    }
  }
  EXPECT_GT(moved, 0U) << "nothing was moved at all";
}

}  // namespace
}  // namespace stackmesh
