// Layers of wedges: exact counts and volumes where they are known, ends at junctions, places without room.
#include <gtest/gtest.h>

#include <cmath>

#include "model/wedge_shape.h"
#include "shapes.h"
#include "validate/check_volume.h"
#include "volume/fill_volume.h"
#include "volume/grow_layers.h"
#include "volume/raise_order.h"

namespace stackmesh {
namespace {

struct Layered {
  TetMesh mesh;
  std::vector<LayerFigures> figures;
};

Layered layered(const InterfaceComplex& complex, const std::map<Label, LayerSize>& sizes, int threads = 0) {
  LayerPlan plan = plan_layers(complex, sizes, threads);
  FillOptions options;
  options.radius_edge = 1.4;
  options.outside_is_empty = false;
  FillResult result = fill_volume(plan.core, options);
  EXPECT_EQ(result.status, FillResult::Status::verified) << result.message;
  Layered out;
  out.mesh = std::move(result.mesh);
  add_layers(out.mesh, plan);
  out.figures = plan.figures;
  return out;
}

double wedge_volume_of(const TetMesh& mesh) {
  double sum = 0;
  for (std::size_t w = 0; w < mesh.wedges.size(); ++w) sum += wedge_volume(wedge_nodes(mesh, w));
  return sum;
}

void expect_sound(const TetMesh& mesh, const std::map<Label, double>& volumes, double within = 1e-9) {
  const VolumeCheck check = check_volume(mesh);
  EXPECT_EQ(check.inverted, 0u);
  EXPECT_TRUE(check.conforms) << check.nonconforming_faces << " faces, " << check.nonconforming_edges << " edges";
  ASSERT_EQ(check.labels.size(), volumes.size());
  for (const LabelTets& l : check.labels)
    EXPECT_NEAR(l.volume_mm3, volumes.at(l.label), within * volumes.at(l.label)) << l.label;
}

InterfaceComplex box(Vec3 low, Vec3 high) {
  InterfaceComplex complex;
  shapes::add_box(complex, low, high, 1);
  return complex;
}

TEST(Layers, ACubeHasThreeWedgesOnEachTriangleAndTheExactCore) {
  const InterfaceComplex cube = box({0, 0, 0}, {10, 10, 10});
  const Layered a = layered(cube, {{1, {1.5, 3}}});
  EXPECT_EQ(a.mesh.wedges.size(), 3 * cube.triangles.size());
  EXPECT_NEAR(wedge_volume_of(a.mesh), 1000 - 343, 1e-9);
  expect_sound(a.mesh, {{1, 1000}});
  ASSERT_EQ(a.figures.size(), 1u);
  EXPECT_EQ(a.figures[0].wedges, 36u);
  EXPECT_EQ(a.figures[0].pyramids + a.figures[0].tets, 0u);
  EXPECT_DOUBLE_EQ(a.figures[0].full_rel, 1);
  EXPECT_NEAR(a.figures[0].area_mm2, 600, 1e-9);
  EXPECT_TRUE(a.figures[0].places.empty());
  for (std::size_t v = 0; v < cube.points.size(); ++v) EXPECT_EQ(norm(a.mesh.points[v] - cube.points[v]), 0);
}

TEST(Layers, ASpheresLayerIsAsThickAsAskedFor) {
  const InterfaceComplex ball = shapes::sphere(3, 10);
  const Layered a = layered(ball, {{1, {2, 2}}});
  EXPECT_EQ(a.mesh.wedges.size(), 2 * ball.triangles.size());
  double volume = 0;
  for (const InterfaceTriangle& t : ball.triangles)
    volume += std::abs(dot(ball.points[t.v[0]], cross(ball.points[t.v[1]], ball.points[t.v[2]]))) / 6;
  expect_sound(a.mesh, {{1, volume}});
  for (const auto& w : a.mesh.wedges)
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(norm(a.mesh.points[w[k]] - a.mesh.points[w[k + 3]]), 1, 0.03);
  EXPECT_GT(check_volume(a.mesh).wedge_scaled_jacobian_min, 0.6);
}

TEST(Layers, EndAtAnotherLabelInPyramidsAndTets) {
  // Two cubes side by side, each of 4 x 4 x 4 cells of 1 mm.
  const InterfaceComplex two = shapes::voxels(8, 4, 4, {1, 1, 1}, [](int i, int, int) { return i < 4 ? 1 : 2; });
  const Layered a = layered(two, {{1, {0.3, 2}}});
  expect_sound(a.mesh, {{1, 64}, {2, 64}});
  EXPECT_GT(a.figures[0].pyramids, 0u);
  EXPECT_EQ(a.figures[0].pyramids % 2, 0u);
  for (const auto& w : a.mesh.wedges)
    for (int k = 0; k < 3; ++k)
      if (w[k] != w[k + 3]) EXPECT_LT(a.mesh.points[w[k]].x, 3.5) << "a column stands on the junction";
  for (std::size_t w = 0; w < a.mesh.wedges.size(); ++w) EXPECT_EQ(a.mesh.labels[a.mesh.tets.size() + w], 1);
  ASSERT_FALSE(a.figures[0].places.empty());
  EXPECT_EQ(a.figures[0].places[0].why, LayerLimit::junction);
  EXPECT_NEAR(a.figures[0].full_rel + a.figures[0].thinned_rel + a.figures[0].missing_rel, 1, 1e-12);
}

TEST(Layers, BothSidesOfAThinPlateShareItsRoom) {
  const InterfaceComplex plate = shapes::voxels(10, 10, 1, {1, 1, 1}, [](int, int, int) { return 1; });
  const Layered a = layered(plate, {{1, {2, 2}}});
  expect_sound(a.mesh, {{1, 100}});
  EXPECT_EQ(a.figures[0].full_rel, 0);
  EXPECT_GT(a.figures[0].wedges, 0u);
  ASSERT_FALSE(a.figures[0].places.empty());
  EXPECT_LT(a.figures[0].places[0].thickness_mm, 0.41);
  EXPECT_NEAR(a.figures[0].places[0].area_mm2, 240, 1e-9);
}

TEST(Layers, WhereALabelTouchesItselfThereIsNone) {
  // Two cubes of one label along a common edge.
  const InterfaceComplex complex =
      shapes::voxels(4, 4, 2, {1, 1, 1}, [](int i, int j, int) { return (i < 2) == (j < 2) ? 1 : 0; });
  const Layered a = layered(complex, {{1, {0.2, 1}}});
  expect_sound(a.mesh, {{1, 16}});
  EXPECT_GT(a.figures[0].pyramids + a.figures[0].tets, 0u);
}

TEST(Layers, InnerInterfacesGetNone) {
  InterfaceComplex nested = box({0, 0, 0}, {10, 10, 10});
  shapes::add_box(nested, {3, 3, 3}, {7, 7, 7}, 2, 1);
  const Layered a = layered(nested, {{1, {1, 2}}});
  EXPECT_EQ(a.mesh.wedges.size(), 24u);
  EXPECT_NEAR(wedge_volume_of(a.mesh), 1000 - 512, 1e-9);
  expect_sound(a.mesh, {{1, 936}, {2, 64}});
}

TEST(Layers, OfSecondOrderStayPositiveAndHoldTheVolume) {
  const InterfaceComplex ball = shapes::sphere(2, 10);
  Layered a = layered(ball, {{1, {2, 3}}});
  double flat = 0;
  for (const LabelTets& l : check_volume(a.mesh).labels) flat = l.volume_mm3;
  for (const bool restored : {false, true}) {
    OrderOptions options;
    options.volumes_restored = restored;
    const OrderResult raised = raise_order(a.mesh, options);
    EXPECT_EQ(raised.mesh.wedge_mid.size(), raised.mesh.wedges.size());
    EXPECT_GE(raised.jacobian_min_rel, options.jacobian_rel);
    if (restored) {
      expect_sound(raised.mesh, {{1, flat}}, 1e-4);
    } else {  // bent outwards, to the sphere's own volume but for a twentieth of what was missing
      const double ball_mm3 = 4.0 / 3 * M_PI * 1000;
      expect_sound(raised.mesh, {{1, ball_mm3}}, 0.05 * (1 - flat / ball_mm3));
    }
  }
}

TEST(Layers, AreTheSameForAnyNumberOfThreads) {
  const InterfaceComplex two = shapes::voxels(8, 6, 5, {1, 1, 1}, [](int i, int j, int) { return i + j < 6 ? 1 : 2; });
  const TetMesh a = layered(two, {{1, {0.4, 2}}, {2, {0.3, 1}}}, 1).mesh,
                b = layered(two, {{1, {0.4, 2}}, {2, {0.3, 1}}}, 4).mesh;
  EXPECT_EQ(a.tets, b.tets);
  EXPECT_EQ(a.wedges, b.wedges);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t p = 0; p < a.points.size(); ++p) EXPECT_EQ(norm(a.points[p] - b.points[p]), 0);
}

TEST(Layers, DividedIntoTetsTheyFillTheSame) {
  const InterfaceComplex two = shapes::voxels(6, 3, 3, {1, 1, 1}, [](int i, int, int) { return i < 3 ? 1 : 2; });
  const Layered a = layered(two, {{1, {0.3, 2}}});
  const TetMesh tets = with_tets_only(a.mesh);
  EXPECT_TRUE(tets.wedges.empty());
  expect_sound(tets, {{1, 27}, {2, 27}});
}

}  // namespace
}  // namespace stackmesh
