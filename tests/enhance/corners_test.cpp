// Corners: what touches in a point, is hollow, or is one voxel thin; meshes large enough to be cut into blocks.
#include <cmath>

#include "checks.h"
#include "enhance/enhance.h"
#include "enhance_shapes.h"
#include "random_stacks.h"

using namespace stackmesh;
using namespace stackmesh::testing_support;

namespace {

EnhanceResult enhance(const InterfaceComplex& c, const EnhanceOptions& o) {
  Monitor quiet;
  return enhance_complex(c, o, quiet);
}

/// Closed, free of intersections, and with the pieces and genus of before; "" if so.
std::string changed(const InterfaceComplex& before, const InterfaceComplex& after) {
  const SurfaceCheck a = check_surface(before), b = check_surface(after);
  std::string out = defects(after);
  if (a.labels.size() != b.labels.size()) return out + "labels were lost";
  for (std::size_t i = 0; i < a.labels.size(); ++i)
    if (a.labels[i].components != b.labels[i].components || a.labels[i].euler != b.labels[i].euler)
      out += "label " + std::to_string(a.labels[i].label) + " changed its pieces or its genus; ";
  return out;
}

void stays_sound(const std::vector<std::vector<const char*>>& slices) {
  const Stitched s = stitch_volume(volume_of(slices), 0.5);
  for (double edge : {0.6, 1.0, 3.0}) {
    EnhanceOptions o;
    o.edge_length_mm = edge;
    const EnhanceResult r = enhance(s.complex(), o);
    EXPECT_EQ(changed(s.complex(), r.complex), "") << edge;
    EXPECT_EQ(r.level, SurfaceLevel::enhanced) << edge;
  }
  const EnhanceResult r = enhance(s.complex(), EnhanceOptions());
  EXPECT_EQ(changed(s.complex(), r.complex), "") << "by curvature";
  EXPECT_EQ(r.level, SurfaceLevel::enhanced) << "by curvature";
}

}  // namespace

TEST(EnhanceCorners, LabelsThatTouchInAVertexStayTwo) {
  const std::vector<const char*> none = {"0000", "0000", "0000", "0000"};
  stays_sound({none, {"0000", "0100", "0000", "0000"}, {"0000", "0000", "0020", "0000"}, none});
}

TEST(EnhanceCorners, LabelsThatTouchInAnEdgeStayTwo) {
  const std::vector<const char*> none = {"0000", "0000", "0000", "0000"}, both = {"0000", "0100", "0020", "0000"};
  stays_sound({none, both, both, none});
}

TEST(EnhanceCorners, AOneVoxelCavityStays) {
  const std::vector<const char*> none = {"00000", "00000", "00000", "00000", "00000"},
                                 full = {"00000", "01110", "01110", "01110", "00000"},
                                 ring = {"00000", "01110", "01010", "01110", "00000"};
  stays_sound({none, full, ring, full, none});
}

TEST(EnhanceCorners, AOneVoxelTunnelStays) {
  const std::vector<const char*> none = {"00000", "00000", "00000", "00000", "00000"},
                                 ring = {"00000", "01110", "01010", "01110", "00000"};
  stays_sound({none, ring, ring, ring, none});
}

TEST(EnhanceCorners, AOneVoxelShellRoundACoreStays) {
  const std::vector<const char*> none = {"0000000", "0000000", "0000000", "0000000", "0000000", "0000000", "0000000"},
                                 lid = {"0000000", "0222220", "0222220", "0222220", "0222220", "0222220", "0000000"},
                                 core = {"0000000", "0222220", "0211120", "0211120", "0211120", "0222220", "0000000"};
  stays_sound({none, lid, core, core, core, lid, none});
}

TEST(EnhanceCorners, ADeviationFarBelowThePixelWarns) {
  EnhanceOptions o;
  o.deviation_mm = 0.1;
  EXPECT_FALSE(enhance(ball(5, 3), o).warnings.empty());
  o.deviation_mm = 0.5;
  EXPECT_TRUE(enhance(ball(5, 3), o).warnings.empty());
}

TEST(EnhanceCorners, BlocksOfALargeMeshLeaveNoSeamAndNoTraceOfTheThreadCount) {
  const InterfaceComplex c = ball(10, 5);  // 10,242 vertices: four blocks and more
  EnhanceOptions o;
  o.edge_length_mm = 0.4;
  o.pixel_mm = o.gap_mm = 0.4;
  o.threads = 1;
  const InterfaceComplex one = enhance(c, o).complex;
  o.threads = 2;
  EXPECT_TRUE(same_bytes(one, enhance(c, o).complex));
  EXPECT_EQ(changed(c, one), "");
  const SurfaceCheck check = check_surface(one);
  EXPECT_GT(check.triangles, 15000u);
  EXPECT_GT(check.angle_min_deg, 25);
  EXPECT_GT(check.edge_min_mm, 0.15);
  EXPECT_NEAR(check.edge_median_mm, 0.4, 0.04);
  for (const Vec3& p : one.points) ASSERT_NEAR(norm(p), 10, 0.05);
}
