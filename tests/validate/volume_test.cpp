#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>

#include "base/error.h"
#include "shapes.h"
#include "validate/check_volume.h"

namespace stackmesh {
namespace {

using namespace test;

TetMesh one_tet(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  TetMesh m;
  m.points = {a, b, c, d};
  m.tets = {{0, 1, 2, 3}};
  m.labels = {4};
  m.faces = {{{1, 2, 3}, 4, 0}, {{0, 3, 2}, 4, 0}, {{0, 1, 3}, 4, 0}, {{2, 1, 0}, 4, 0}};
  return m;
}

TEST(CheckVolume, RegularTetIsPerfect) {
  const VolumeCheck c = check_volume(one_tet({1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}));
  EXPECT_EQ(c.nodes, 4u);
  EXPECT_EQ(c.tets, 1u);
  EXPECT_EQ(c.inverted, 0u);
  EXPECT_NEAR(c.dihedral_min_deg, 70.528779365509308, 1e-9);
  EXPECT_NEAR(c.dihedral_max_deg, 70.528779365509308, 1e-9);
  EXPECT_NEAR(c.radius_edge_max, std::sqrt(6.0) / 4, 1e-12);
  EXPECT_NEAR(c.scaled_jacobian_min, 1, 1e-12);
  EXPECT_TRUE(c.conforms);
  ASSERT_EQ(c.labels.size(), 1u);
  EXPECT_EQ(c.labels[0].label, 4);
  EXPECT_NEAR(c.labels[0].volume_mm3, 8 / 3.0, 1e-12);
}

TEST(CheckVolume, CornerTetHasKnownDihedrals) {
  const VolumeCheck c = check_volume(one_tet({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}));
  EXPECT_NEAR(c.dihedral_min_deg, 54.735610317245346, 1e-9);
  EXPECT_NEAR(c.dihedral_max_deg, 90, 1e-9);
  EXPECT_NEAR(c.radius_edge_max, std::sqrt(3.0) / 2, 1e-12);
  EXPECT_NEAR(c.scaled_jacobian_min, std::sqrt(0.5), 1e-12);
  EXPECT_EQ(c.dihedral_below_10, 0u);
}

TEST(CheckVolume, NearlyFlatTetHasItsSmallDihedral) {
  const double h = std::tan(5 * std::acos(-1.0) / 180) / 3;  // 5 degrees above the sides of a triangle of inradius 1/3
  const double s = 2 / std::sqrt(3.0);
  const VolumeCheck c = check_volume(one_tet({0, 0, 0}, {s, 0, 0}, {s / 2, 1, 0}, {s / 2, 1 / 3.0, h}));
  EXPECT_NEAR(c.dihedral_min_deg, 5, 1e-9);
  EXPECT_EQ(c.dihedral_below_10, 1u);
  EXPECT_GT(c.dihedral_max_deg, 160);
}

TEST(CheckVolume, HistogramCountsEveryDihedral) {
  const VolumeCheck corner = check_volume(one_tet({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}));
  EXPECT_EQ(corner.dihedral_histogram[54 / 5], 3u);                              // 54.7
  EXPECT_EQ(corner.dihedral_histogram[17] + corner.dihedral_histogram[18], 3u);  // 90
  std::size_t sum = 0;
  for (const std::size_t n : check_volume(two_tets()).dihedral_histogram) sum += n;
  EXPECT_EQ(sum, 12u);
}

TEST(CheckVolume, NarrowWedgesOfTheSurfaceAreListedApart) {
  // Two tets side by side in a wedge of 8 degrees along z, split into 4 and 4; then the lower sheet is no surface.
  const double a = 4 * std::acos(-1.0) / 180;
  TetMesh m;
  m.points = {
      {0, 0, 0}, {0, 0, 1}, {1, 0, 0.5}, {std::cos(a), std::sin(a), 0.5}, {std::cos(2 * a), std::sin(2 * a), 0.5}};
  m.tets = {{0, 2, 3, 1}, {0, 3, 4, 1}};
  m.labels = {1, 1};
  m.faces = {{{0, 1, 2}, 1, 0}, {{0, 4, 1}, 1, 0}, {{0, 2, 3}, 0, 1},
             {{0, 3, 4}, 0, 1}, {{1, 2, 3}, 1, 0}, {{1, 3, 4}, 1, 0}};
  VolumeCheck c = check_volume(m);
  EXPECT_EQ(c.dihedral_below_10, 2u);
  EXPECT_EQ(c.in_narrow_wedges, 2u);
  m.points[4] = {std::cos(5 * a), std::sin(5 * a), 0.5};  // 20 degrees in all: 4 and 16 could be 10 and 10
  c = check_volume(m);
  EXPECT_EQ(c.dihedral_below_10, 1u);
  EXPECT_EQ(c.in_narrow_wedges, 0u);
}

TEST(CheckVolume, TetsWhereTwoSheetsPinchAreListedApart) {
  // A lone flat tet has no inner edge. With its point above the triangle taken into a larger body, it still stands
  // above it.
  EXPECT_EQ(check_volume(one_tet({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0.5, 0.5, 0.05})).pinched, 1u);
  EXPECT_EQ(check_volume(one_tet({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0.5, 0.5, 0.9})).pinched, 0u);
  TetMesh m = one_tet({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0.5, 0.5, 0.05});
  m.faces = {{{2, 1, 0}, 4, 0}};  // its other faces are inside, and its point is not on the surface
  EXPECT_EQ(check_volume(m).pinched, 0u);
  m.points.insert(m.points.end(), {{5, 5, 5}, {6, 5, 5}});
  m.faces.push_back({{3, 4, 5}, 4, 0});  // now it is
  EXPECT_EQ(check_volume(m).pinched, 1u);
}

TEST(CheckVolume, FirstPercentileIsOfTheSmallestDihedralPerTet) {
  TetMesh m;
  for (int i = 0; i < 200; ++i) {
    const TetMesh t = i < 3 ? one_tet({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2})
                            : one_tet({1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1});
    const std::int32_t n = static_cast<std::int32_t>(m.points.size());
    m.points.insert(m.points.end(), t.points.begin(), t.points.end());
    m.tets.push_back({n, n + 1, n + 2, n + 3});
    m.labels.push_back(1);
  }
  EXPECT_NEAR(check_volume(m).dihedral_p1_deg, 54.7356, 1e-4);  // the second of two hundred
}

TEST(CheckVolume, InvertedAndFlatTetsAreCounted) {
  TetMesh m = two_tets();
  EXPECT_EQ(check_volume(m).inverted, 0u);
  m.points[3].z = -0.5;
  EXPECT_EQ(check_volume(m).inverted, 1u);
  EXPECT_LT(check_volume(m).scaled_jacobian_min, 0);
  EXPECT_NEAR(check_volume(m).labels[0].volume_mm3, -0.5 / 6, 1e-15);
  m.points[3] = {0.25, 0.25, 0};
  const VolumeCheck flat = check_volume(m);
  EXPECT_EQ(flat.inverted, 1u);
  EXPECT_EQ(flat.radius_edge_max, std::numeric_limits<double>::infinity());
  EXPECT_NEAR(flat.dihedral_max_deg, 180, 1e-6);
}

TEST(CheckVolume, InversionIsExactBelowTheRoundingOfDoubles) {
  // All have x = y, which is flat; one ulp to either side is not.
  TetMesh m = one_tet({0.1, 0.1, 0.1}, {0.2, 0.2, 0.3}, {0.4, 0.4, 0.5}, {1.7, 1.7, 0.9});
  EXPECT_EQ(check_volume(m).inverted, 1u);
  m.points[3].x += 0x1p-52;
  const std::size_t one_side = check_volume(m).inverted;
  m.points[3].x -= 0x1p-51;
  EXPECT_EQ(one_side + check_volume(m).inverted, 1u);
}

TEST(CheckVolume, TwoTetsWithTheirFacesConform) {
  const VolumeCheck c = check_volume(two_tets());
  EXPECT_TRUE(c.conforms);
  EXPECT_EQ(c.nonconforming_faces, 0u);
  ASSERT_EQ(c.labels.size(), 2u);
  EXPECT_NEAR(c.labels[1].volume_mm3, 1 / 6.0, 1e-15);
}

std::size_t nonconforming(const TetMesh& m) {
  const VolumeCheck c = check_volume(m);
  EXPECT_EQ(c.conforms, c.nonconforming_faces == 0);
  EXPECT_EQ(c.nonconforming_list.size(), c.nonconforming_faces);
  return c.nonconforming_faces;
}

TEST(CheckVolume, EachWrongFaceIsCounted) {
  TetMesh m = two_tets();
  std::swap(m.labels[0], m.labels[1]);
  EXPECT_EQ(nonconforming(m), 7u);

  m = two_tets();
  std::swap(m.faces[3].below, m.faces[3].above);
  EXPECT_EQ(nonconforming(m), 1u);

  m = two_tets();
  std::swap(m.faces[0].v[0], m.faces[0].v[1]);
  EXPECT_EQ(nonconforming(m), 1u);

  m = two_tets();
  m.faces.erase(m.faces.begin() + 3);
  EXPECT_EQ(nonconforming(m), 1u);

  m = two_tets();
  m.faces.push_back(m.faces[2]);
  EXPECT_EQ(nonconforming(m), 1u);

  m = two_tets();
  m.faces.push_back({{1, 3, 4}, 1, 2});  // no tet has it
  EXPECT_EQ(nonconforming(m), 1u);

  m = two_tets();
  m.labels = {1, 1};  // the shared face is inside one label now; the others name a wrong one
  EXPECT_EQ(nonconforming(m), 4u);
  for (auto& f : m.faces) f.below = 1;
  m.faces.erase(m.faces.begin() + 3);
  EXPECT_EQ(nonconforming(m), 0u);
}

TEST(CheckVolume, SameFaceInWritingOfAnyRotationConforms) {
  TetMesh m = two_tets();
  for (auto& f : m.faces) f.v = {f.v[1], f.v[2], f.v[0]};
  EXPECT_EQ(nonconforming(m), 0u);
  for (auto& f : m.faces) std::swap(f.v[0], f.v[1]), std::swap(f.below, f.above);
  EXPECT_EQ(nonconforming(m), 0u);
}

TEST(CheckVolume, ThreeTetsOnAFaceAndDuplicatesDoNotConform) {
  TetMesh m = two_tets();
  m.points.push_back({0, 0, 2});
  m.tets.push_back({0, 1, 2, 5});
  m.labels.push_back(1);
  EXPECT_EQ(nonconforming(m), 4u);  // the crowded face, and the three new ones without an interface face

  m = two_tets();
  m.tets.push_back(m.tets[0]);
  m.labels.push_back(1);
  EXPECT_EQ(nonconforming(m), 4u);
}

/// two_tets() with a node in the middle of each edge.
TetMesh two_curved_tets() {
  TetMesh m = two_tets();
  std::map<std::pair<int, int>, int> nodes;
  m.mid.resize(m.tets.size());
  constexpr int edges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  for (std::size_t t = 0; t < m.tets.size(); ++t)
    for (int k = 0; k < 6; ++k) {
      const int a = m.tets[t][edges[k][0]], b = m.tets[t][edges[k][1]];
      const auto [at, fresh] = nodes.insert({std::minmax(a, b), static_cast<int>(m.points.size())});
      if (fresh) m.points.push_back(0.5 * (m.points[a] + m.points[b]));
      m.mid[t][k] = at->second;
    }
  return m;
}

TEST(CheckVolume, StraightSecondOrderTetsAreAsTheirCorners) {
  const VolumeCheck linear = check_volume(two_tets()), curved = check_volume(two_curved_tets());
  EXPECT_EQ(curved.order, 2);
  EXPECT_EQ(curved.inverted, 0u);
  EXPECT_TRUE(curved.conforms);
  EXPECT_EQ(curved.scaled_jacobian_min, linear.scaled_jacobian_min);
  EXPECT_EQ(curved.labels[0].volume_mm3, linear.labels[0].volume_mm3);
}

TEST(CheckVolume, ABulgeAddsItsVolume) {
  // The edge along x is bent by h = 0.1 towards -y: y = l2 - 4 h l0 l1, so that the determinant is 1 + 4 h l1, and l1
  // has the integral 1/24 over the tet.
  TetMesh m = one_tet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  m.points.insert(m.points.end(),
                  {{0.5, -0.1, 0}, {0.5, 0.5, 0}, {0, 0.5, 0}, {0, 0, 0.5}, {0.5, 0, 0.5}, {0, 0.5, 0.5}});
  m.mid = {{4, 5, 6, 7, 8, 9}};
  const VolumeCheck c = check_volume(m);
  EXPECT_EQ(c.inverted, 0u);
  EXPECT_NEAR(c.labels[0].volume_mm3, 1 / 6.0 + 0.1 * 4 / 24, 1e-15);
}

TEST(CheckVolume, ANodePastTheOppositeFaceInvertsTheElement) {
  TetMesh m = two_curved_tets();
  const auto& tet = m.tets[0];
  const Vec3 opposite = 0.5 * (m.points[tet[2]] + m.points[tet[3]]);
  Vec3& node = m.points[m.mid[0][0]];
  const Vec3 middle = node;
  node = middle + 0.2 * (opposite - middle);
  EXPECT_EQ(check_volume(m).inverted, 0u);
  node = middle + 0.9 * (opposite - middle);
  EXPECT_GE(check_volume(m).inverted, 1u);
  EXPECT_LT(check_volume(m).scaled_jacobian_min, 0);
}

TEST(CheckVolume, NeighboursMustShareTheNodesOfTheirEdges) {
  TetMesh m = two_curved_tets();
  m.points.push_back(m.points[m.mid[1][0]]);
  m.mid[1][0] = static_cast<int>(m.points.size()) - 1;  // an own copy of the node
  const bool shared = std::count(m.tets[0].begin(), m.tets[0].end(), m.tets[1][0]) &&
                      std::count(m.tets[0].begin(), m.tets[0].end(), m.tets[1][1]);
  EXPECT_EQ(check_volume(m).nonconforming_edges, shared ? 1u : 0u);
  EXPECT_EQ(check_volume(m).conforms, !shared);
  TetMesh twice = two_curved_tets();
  twice.mid[0][3] = twice.mid[0][2];
  EXPECT_FALSE(check_volume(twice).conforms);
}

TEST(CheckVolume, BrokenArraysAreRefused) {
  TetMesh m = two_tets();
  m.labels.pop_back();
  EXPECT_THROW(check_volume(m), Error);
  m = two_tets();
  m.tets[1][2] = -1;
  EXPECT_THROW(check_volume(m), Error);
  m = two_tets();
  m.faces[1].v[2] = 5;
  EXPECT_THROW(check_volume(m), Error);
  m = two_tets();
  m.points[1].x = std::numeric_limits<double>::infinity();
  EXPECT_THROW(check_volume(m), Error);
}

}  // namespace
}  // namespace stackmesh
