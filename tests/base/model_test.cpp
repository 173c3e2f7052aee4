// The types in which the stages meet: labels and their selection, frames, areas.
#include <gtest/gtest.h>

#include <string>

#include "base/error.h"
#include "model/label_table.h"
#include "model/label_volume.h"
#include "model/space.h"
#include "model/stack.h"
#include "random_stacks.h"

namespace stackmesh {
namespace {

using Indices = std::vector<std::size_t>;

const std::vector<LabelInfo> kLabels = {{1, "heart"}, {4, "lung-2"}, {7, ""},         {8, "3-9"},
                                        {9, "femur"}, {1000, "12"},  {70000, "femur"}};

/// Counted from 1.
Indices resolved(const std::string& text) {
  Indices chosen = LabelTable(kLabels).resolve(text);
  for (std::size_t& k : chosen) ++k;
  return chosen;
}

TEST(ResolveLabels, TakesNumbersRangesAndNames) {
  EXPECT_EQ(resolved(""), (Indices{1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(resolved("4"), Indices{2});
  EXPECT_EQ(resolved("9,1"), (Indices{1, 5}));
  EXPECT_EQ(resolved("4,4,4"), Indices{2});
  EXPECT_EQ(resolved("7-9"), (Indices{3, 4, 5}));
  EXPECT_EQ(resolved("0-5"), (Indices{1, 2}));  // no background
  EXPECT_EQ(resolved("2-6,heart"), (Indices{1, 2}));
  EXPECT_EQ(resolved("70000"), Indices{7});
  EXPECT_EQ(resolved("007"), Indices{3});
  EXPECT_EQ(resolved("1,7-8,femur"), (Indices{1, 3, 4, 5, 7}));  // both of that name
}

TEST(ResolveLabels, ANameWinsOverANumberOrARange) {
  EXPECT_EQ(resolved("lung-2"), Indices{2});
  EXPECT_EQ(resolved("3-9"), Indices{4});
  EXPECT_EQ(resolved("12"), Indices{6});
  EXPECT_EQ(resolved("3-9,lung-2,heart,heart"), (Indices{1, 2, 4}));
}

ErrorKind refusal(const std::string& text, std::string* message = nullptr) {
  try {
    LabelTable(kLabels).resolve(text);
  } catch (const Error& e) {
    if (message != nullptr) *message = e.what();
    return e.kind();
  }
  ADD_FAILURE() << "accepted: " << text;
  return ErrorKind::internal;
}

TEST(ResolveLabels, GivesNumbersAndValuesByLabel) {
  const LabelTable table(kLabels);
  EXPECT_EQ(table.numbers("femur,1"), (std::vector<Label>{1, 9, 70000}));
  EXPECT_EQ(table.in_order("femur,1"), (Indices{4, 6, 0}));
  const std::map<Label, double> sizes = table.values<double>({{"7-9", 2.5}, {"9", 1.0}}, "--edge-length");
  EXPECT_EQ(sizes, (std::map<Label, double>{{7, 2.5}, {8, 2.5}, {9, 1.0}}));
}

TEST(ResolveLabels, RefusesWhatIsAbsent) {
  for (const char* text :
       {"2", "5-6", "liver", "1,2", "0", "Heart", "-3", "7-", "-", "1-2-3", "99999999999999999999", "1;4", " 4"})
    EXPECT_EQ(refusal(text), ErrorKind::input) << text;
  std::string message;
  refusal("1,liver", &message);
  EXPECT_NE(message.find("label 'liver' is not in the input"), std::string::npos) << message;
  EXPECT_NE(message.find("4 (lung-2), 7, "), std::string::npos) << message;  // what there is
}

TEST(ResolveLabels, RefusesWhatIsMalformed) {
  for (const char* text : {",", "1,", ",1", "1,,4", "9-7"}) EXPECT_EQ(refusal(text), ErrorKind::usage) << text;
}

TEST(SelectLabels, TheRestBecomesBackground) {
  for (int seed = 0; seed < 40; ++seed) {
    const LabelVolume v = testing_support::random_volume(seed);
    Indices keep;
    for (std::size_t l = 1; l < v.labels.size(); l += 2) keep.push_back(l);
    const LabelVolume kept = select_labels(v, keep, false), merged = select_labels(v, keep, true);
    ASSERT_EQ(kept.labels.size(), keep.size() + 1);
    ASSERT_EQ(merged.labels.size(), 2U);
    EXPECT_EQ(merged.labels[1].number, v.labels[keep[0]].number);  // the smallest
    EXPECT_EQ(kept.labels[0].number, 0);
    for (std::size_t i = 0; i < v.voxels.size(); ++i) {
      const Label was = v.labels[v.voxels[i]].number;
      const Label expected = v.voxels[i] % 2 != 0 ? was : 0;
      ASSERT_EQ(kept.labels[kept.voxels[i]].number, expected);
      ASSERT_EQ(merged.labels[merged.voxels[i]].number, expected != 0 ? merged.labels[1].number : 0);
    }
  }
}

TEST(CountVoxels, CountsEachLabel) {
  const LabelVolume v = testing_support::volume_of({{"0120", "2200"}, {"0003", "1111"}});
  EXPECT_EQ(count_voxels(v), (Indices{7, 5, 3, 1}));
}

TEST(LabelVolume, WorldFollowsSpacingOriginAndAxes) {
  LabelVolume v;
  v.spacing_mm = {2, 3, 4};
  v.origin_mm = {10, 20, 30};
  v.axes = {Vec3{0, 1, 0}, Vec3{0, 0, -1}, Vec3{1, 0, 0}};
  const Vec3 p = v.world(1, 2, 3);
  EXPECT_EQ(p.x, 10 + 12);
  EXPECT_EQ(p.y, 20 + 2);
  EXPECT_EQ(p.z, 30 - 6);
  EXPECT_EQ(v.voxel_volume_mm3(), 24);
}

TEST(Frame, MapsThereAndBack) {
  const Frame right{{1, 2, 3}, {Vec3{0.6, 0.8, 0}, Vec3{-0.8, 0.6, 0}, Vec3{0, 0, 1}}};
  const Frame left{{1, 2, 3}, {Vec3{0.6, 0.8, 0}, Vec3{-0.8, 0.6, 0}, Vec3{0, 0, -1}}};
  EXPECT_FALSE(right.mirrors());
  EXPECT_TRUE(left.mirrors());
  for (const Frame& f : {right, left})
    EXPECT_LT(norm(f.to_stack(f.to_world({7, -5, 0.25})) - Vec3{7, -5, 0.25}), 1e-12);
}

TEST(Space, AMirroringFrameTurnsTrianglesAndElementsRound) {
  Frame frame;
  frame.origin = {10, 20, 30};
  frame.axes = {Vec3{0, 1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}};
  TetMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 2}};
  mesh.tets = {{0, 1, 2, 3}};
  mesh.labels = {4};
  mesh.faces = {{{0, 2, 1}, 4, 0}};
  change_space(mesh, Space::lps, frame);
  EXPECT_EQ(mesh.space, Space::lps);
  const auto at = [&](std::int32_t v) { return mesh.points[v]; };
  const auto& t = mesh.tets[0];
  EXPECT_GT(dot(cross(at(t[1]) - at(t[0]), at(t[2]) - at(t[0])), at(t[3]) - at(t[0])), 0);
  const auto& f = mesh.faces[0].v;
  EXPECT_LT(cross(at(f[1]) - at(f[0]), at(f[2]) - at(f[0])).z, 0);  // still out of the tetrahedron
  EXPECT_EQ(at(3).x, 10);
  EXPECT_EQ(at(3).z, 32);
}

TEST(Space, RasIsHalfARevolutionAndBackIsExact) {
  InterfaceComplex surface;
  surface.points = {{0.1, -0.3, 7}, {1e-17, 2, 3}, {5, 6, 1.0 / 3}};
  surface.triangles = {{{0, 1, 2}, 1, 0}};
  surface.space = Space::lps;
  const InterfaceComplex before = surface;
  change_space(surface, Space::ras);
  EXPECT_EQ(surface.space, Space::ras);
  EXPECT_EQ(surface.points[0].x, -0.1);
  EXPECT_EQ(surface.points[0].y, 0.3);
  EXPECT_EQ(surface.points[0].z, 7);
  EXPECT_EQ(surface.triangles[0].v, before.triangles[0].v);
  const Vec3 p = between(Space::ras, Space::lps).to_world(surface.points[2]);
  EXPECT_EQ(norm(p - before.points[2]), 0);
  change_space(surface, Space::lps);
  for (std::size_t i = 0; i < surface.points.size(); ++i) EXPECT_EQ(norm(surface.points[i] - before.points[i]), 0);
}

TEST(Space, StackToRasGoesByTheFramesWorld) {
  InterfaceComplex surface;
  surface.points = {{1, 2, 3}};
  Frame frame;
  frame.origin = {10, 0, 0};
  change_space(surface, Space::ras, frame);
  EXPECT_EQ(surface.points[0].x, -11);
  EXPECT_EQ(surface.points[0].y, -2);
  surface.space = Space::none;  // no anatomy: taken as they are
  change_space(surface, Space::lps);
  EXPECT_EQ(surface.points[0].x, -11);
  EXPECT_THROW(change_space(surface, Space::stack), Error);  // only a frame leads there
  EXPECT_THROW(in_space({1, 2, 3}, Space::stack, Space::lps), Error);
}

TEST(LabelArea, IsSignedByTheSideThatTheLabelIsOn) {
  Stack stack;
  stack.grid_x_mm = 0.5;
  stack.grid_y_mm = 2;
  const std::int32_t big = 1 << 29;  // the largest coordinates that are allowed
  Section s;
  s.points = {{-big, -big}, {big, -big}, {big, big}, {-big, big}};
  s.edges = {{0, 1, 5, 7}, {1, 2, 5, 7}, {2, 3, 5, 7}, {3, 0, 5, 7}};
  EXPECT_EQ(label_area_mm2(stack, s, 5), 0x1p60);
  EXPECT_EQ(label_area_mm2(stack, s, 7), -0x1p60);
  EXPECT_EQ(label_area_mm2(stack, s, 6), 0);
}

TEST(EndHalfGap, IsHalfTheOutermostGap) {
  Stack stack;
  stack.pixel_mm = 0.8;
  stack.sections.resize(1);
  EXPECT_EQ(end_half_gap_mm(stack, false), 0.4);
  stack.sections.resize(3);
  stack.sections[1].z_mm = 2;
  stack.sections[2].z_mm = 7;
  EXPECT_EQ(end_half_gap_mm(stack, false), 1);
  EXPECT_EQ(end_half_gap_mm(stack, true), 2.5);
  stack.end_gap_mm = 6;  // sections were interpolated
  EXPECT_EQ(end_half_gap_mm(stack, false), 3);
  EXPECT_EQ(end_half_gap_mm(stack, true), 3);
}

}  // namespace
}  // namespace stackmesh
