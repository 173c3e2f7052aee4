// The judge of wedges must see what is wrong with them.
#include <gtest/gtest.h>

#include <cmath>

#include "validate/check_volume.h"

namespace stackmesh {
namespace {

/// A cube of 1 mm as two wedges; its four outer sides are not shared.
TetMesh two_wedges() {
  TetMesh m;
  m.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  m.wedges = {{0, 1, 2, 4, 5, 6}, {0, 2, 3, 4, 6, 7}};
  m.labels = {1, 1};
  m.faces = {{{0, 2, 1}, 1, 0}, {{4, 5, 6}, 1, 0}, {{0, 3, 2}, 1, 0}, {{4, 6, 7}, 1, 0}};
  return m;
}

TEST(CheckWedges, MeasuresVolumeAndShape) {
  const VolumeCheck c = check_volume(two_wedges());
  EXPECT_EQ(c.wedges, 2u);
  EXPECT_EQ(c.inverted, 0u);
  ASSERT_EQ(c.labels.size(), 1u);
  EXPECT_NEAR(c.labels[0].volume_mm3, 1, 1e-12);
  EXPECT_NEAR(c.wedge_scaled_jacobian_min, 2 / std::sqrt(3.0) / std::sqrt(2.0), 1e-12);  // at 45 degrees
}

TEST(CheckWedges, SidesThatNoSecondWedgeHasDoNotConform) {
  const VolumeCheck c = check_volume(two_wedges());
  EXPECT_EQ(c.nonconforming_faces, 4u);  // of six sides two are one
  EXPECT_FALSE(c.conforms);
}

TEST(CheckWedges, AWedgeTurnedRoundIsInverted) {
  TetMesh m = two_wedges();
  turn_wedge_round(m, 1);
  const VolumeCheck c = check_volume(m);
  EXPECT_EQ(c.inverted, 1u);
  EXPECT_EQ(c.inverted_list, std::vector<std::int32_t>{1});
}

TEST(CheckWedges, ACornerPushedThroughIsInvertedThoughTheVolumeIsPositive) {
  TetMesh m = two_wedges();
  m.points[6] = {1, 1, -0.1};
  EXPECT_EQ(check_volume(m).inverted, 2u);
}

TEST(CheckWedges, NeighboursOfTwoLabelsMayNotShareASide) {
  TetMesh m = two_wedges();
  m.labels[1] = 2;
  EXPECT_EQ(check_volume(m).nonconforming_faces, 5u + 2u);  // and the second wedge's triangles are named for label 1
}

TEST(CheckWedges, APyramidHasOneSideAndFourTriangles) {
  TetMesh m;
  m.points = {{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0.5}, {0, 0, 1}, {1, 0, 1}};
  m.wedges = {{0, 1, 2, 3, 4, 2}};
  m.labels = {1};
  m.faces = {{{0, 2, 1}, 1, 0}, {{3, 4, 2}, 1, 0}, {{1, 2, 4}, 1, 0}, {{2, 0, 3}, 1, 0}};
  const VolumeCheck c = check_volume(m);
  EXPECT_EQ(c.pyramids, 1u);
  EXPECT_EQ(c.inverted, 0u);
  EXPECT_NEAR(c.labels[0].volume_mm3, 1.0 / 3, 1e-12);
  EXPECT_EQ(c.nonconforming_faces, 1u);  // its base alone
}

TEST(CheckWedges, AMidSideNodeFarOffIsInverted) {
  TetMesh m = two_wedges();
  for (const auto& w : m.wedges) {
    auto& mid = m.wedge_mid.emplace_back();
    for (int e = 0; e < 9; ++e) {
      mid[e] = static_cast<std::int32_t>(m.points.size());
      m.points.push_back(0.5 * (m.points[w[kWedgeEdges[e][0]]] + m.points[w[kWedgeEdges[e][1]]]));
    }
  }
  EXPECT_EQ(check_volume(m).inverted, 0u);
  EXPECT_NEAR(check_volume(m).labels[0].volume_mm3, 1, 1e-12);
  m.points[m.wedge_mid[0][0]] = m.points[m.wedge_mid[0][0]] + Vec3{0, 0.4, 0};
  EXPECT_EQ(check_volume(m).inverted, 1u);
}

}  // namespace
}  // namespace stackmesh
