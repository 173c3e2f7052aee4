// Handles that no slice has: of our meshes and of those of other programs.
#include <gtest/gtest.h>

#include <cmath>

#include "sections/polygons.h"
#include "stitch/stitch.h"
#include "validate/check_topology.h"

namespace stackmesh {
namespace {

LabelVolume voxels(int nx, int ny, int nz, const std::function<int(int, int, int)>& at) {
  LabelVolume v;
  v.size = {nx, ny, nz};
  v.labels = {{0, ""}, {1, ""}, {2, ""}};
  v.voxels.resize(static_cast<std::size_t>(nx) * ny * nz);
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) v.voxels[v.index(i, j, k)] = static_cast<std::uint16_t>(at(i, j, k));
  return v;
}

/// What check_topology says of label 1 if its surface has so many handles.
LabelTopology judged(const LabelVolume& v, long handles, int axis = 2) {
  SurfaceCheck s;
  LabelSurface l;
  l.label = 1;
  l.closed = true;
  l.genus = handles;
  l.components = 1;
  s.labels = {l};
  TopologyOptions o;
  o.axis = axis;
  const auto out = check_topology(s, v, o);
  return out.empty() ? LabelTopology() : out[0];
}

TEST(Topology, SlicesImplyTheirTunnelsAndLoopsOnly) {
  const auto ring = [](int i, int j) {
    return i > 0 && j > 0 && i < 8 && j < 8 && !(i > 2 && j > 2 && i < 6 && j < 6);
  };
  const LabelVolume tube = voxels(9, 9, 6, [&](int i, int j, int) { return ring(i, j); });
  EXPECT_EQ(judged(tube, 1).implied_handles, 1);
  EXPECT_EQ(judged(tube, 3).surplus(), 2);
  const LabelVolume cup =
      voxels(9, 9, 6, [&](int i, int j, int k) { return k == 0 ? i > 0 && j > 0 && i < 8 && j < 8 : ring(i, j); });
  EXPECT_EQ(judged(cup, 1).implied_handles, 0);
  const LabelVolume shell = voxels(
      9, 9, 6, [&](int i, int j, int k) { return k == 0 || k == 5 ? i > 0 && j > 0 && i < 8 && j < 8 : ring(i, j); });
  EXPECT_EQ(judged(shell, 1).implied_handles, 0);
  // A ring that stands: two legs that join above and below.
  const LabelVolume gate = voxels(9, 3, 9, [&](int i, int j, int k) { return j == 1 && ring(i, k); });
  EXPECT_EQ(judged(gate, 1).implied_handles, 1);
  for (int axis : {0, 1}) EXPECT_EQ(judged(gate, 1, axis).implied_handles, 1) << axis;
  // A tube whose wall is one voxel, pushed by one a slice: diagonal steps are no tunnels in the wall.
  const LabelVolume oblique = voxels(20, 9, 6, [&](int i, int j, int k) {
    return i - 2 * k > 0 && j > 0 && i - 2 * k < 8 && j < 8 && !(i - 2 * k > 1 && j > 1 && i - 2 * k < 7 && j < 7);
  });
  EXPECT_EQ(judged(oblique, 9).implied_handles, 1);
  const LabelVolume opening =
      voxels(9, 9, 6, [&](int i, int j, int k) { return ring(i, j) && (k < 3 || j != 4 || i < 4); });
  EXPECT_EQ(judged(opening, 1).implied_handles, 1);
  const LabelVolume ball_in_hollow =
      voxels(9, 9, 6, [&](int i, int j, int) { return ring(i, j) || (i == 4 && j == 4); });
  EXPECT_EQ(judged(ball_in_hollow, 1).implied_handles, 1);
  EXPECT_EQ(judged(ball_in_hollow, 1).implied_pieces, 2);
}

ContourPolygon disc(double cx, double r) {
  ContourPolygon p;
  for (int i = 0; i < 60; ++i)
    p.points.push_back({cx + r * std::cos(2 * M_PI * i / 60), r * std::sin(2 * M_PI * i / 60)});
  return p;
}

TEST(Topology, HolesOfAStitchedWallAreCountedAndFound) {
  // A thin wall pushed by more than its thickness: stitched as it is, it tears on either side, between every two
  // sections.
  LabelContours outer, inner;
  outer.label = 1;
  inner.label = 2;
  for (int k = 0; k < 3; ++k) {
    outer.sections.push_back({8.0 * k, {disc(4 * k, 20)}});
    inner.sections.push_back({8.0 * k, {disc(4 * k, 18.5)}});
  }
  std::vector<Warning> warnings;
  Stack stack = sections_from_contours({outer, inner}, warnings);
  const Stack drawn = stack;
  Monitor quiet;
  StitchOptions options;
  options.caps = Caps::flat;
  const InterfaceComplex torn = stitch_sections(stack, options, quiet).complex;
  const SurfaceCheck check = check_surface(torn);
  const std::vector<LabelTopology> found = check_topology(check, drawn);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].implied_handles, 1);
  EXPECT_EQ(found[0].surplus(), check.labels[0].genus - 1);
  ASSERT_GE(found[0].surplus(), 2);
  EXPECT_EQ(found[1].surplus(), 0);
  const std::vector<HandlePlace> places = find_handles(torn, 1, static_cast<std::size_t>(found[0].surplus()));
  ASSERT_FALSE(places.empty());
  for (const HandlePlace& p : places) {
    EXPECT_GT(p.where.z, 0);
    EXPECT_LT(p.where.z, 16);
    EXPECT_EQ(p.triangles.size(), 2u);
  }
}

}  // namespace
}  // namespace stackmesh
