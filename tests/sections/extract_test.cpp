// Volumes to sections: axis, frame, order, threads, symmetry, refusals.
#include "sections/extract.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "base/error.h"
#include "oracle.h"
#include "random_stacks.h"

namespace stackmesh::contour_tests {
namespace {

ContourResult extract(const LabelVolume& volume, StackAxis axis, double simplify_px = 0, int threads = 1) {
  ContourOptions options;
  options.axis = axis;
  options.simplify_px = simplify_px;
  options.threads = threads;
  Monitor silent;
  return extract_sections(volume, options, silent);
}

constexpr StackAxis kAxes[] = {StackAxis::x, StackAxis::y, StackAxis::z};

/// Random labels, with an oblique grid that is left-handed for odd seeds.
LabelVolume oblique_volume(int seed) {
  LabelVolume v = testing_support::random_volume(seed);
  v.spacing_mm = {0.8, 1.7, 2.9};
  v.origin_mm = {-31.5, 12.25, 204};
  const double a = 0.3 + seed, b = 1.1;
  const Vec3 x = {std::cos(a), std::sin(a), 0},
             y = {-std::sin(a) * std::cos(b), std::cos(a) * std::cos(b), std::sin(b)};
  v.axes = {x, y, (seed % 2 != 0 ? -1.0 : 1.0) * cross(x, y)};
  return v;
}

/// All that a section is, to be compared.
std::vector<std::tuple<double, std::int64_t, std::int64_t, std::int64_t, std::int64_t>> digest(const Stack& stack) {
  std::vector<std::tuple<double, std::int64_t, std::int64_t, std::int64_t, std::int64_t>> all;
  for (const Section& s : stack.sections) {
    all.emplace_back(s.z_mm, s.points.size(), s.edges.size(), 0, 0);
    for (GridPoint p : s.points) all.emplace_back(0, p.x, p.y, 0, 0);
    for (const SectionEdge& e : s.edges) all.emplace_back(0, e.a, e.b, e.left, e.right);
  }
  for (Label l : stack.touches_low) all.emplace_back(1, l, 0, 0, 0);
  for (Label l : stack.touches_high) all.emplace_back(2, l, 0, 0, 0);
  return all;
}

TEST(StackingAxis, AutomaticIsTheCoarsestAndZWhenEqual) {
  LabelVolume v;
  const auto axis = [&](double x, double y, double z) {
    v.spacing_mm = {x, y, z};
    return stacking_axis(v, StackAxis::automatic);
  };
  EXPECT_EQ(axis(1, 1, 1), 2);
  EXPECT_EQ(axis(1, 1, 5), 2);
  EXPECT_EQ(axis(1, 5, 1), 1);
  EXPECT_EQ(axis(5, 1, 1), 0);
  EXPECT_EQ(axis(1.009, 1, 1), 2);
  EXPECT_EQ(axis(1.011, 1, 1), 0);
  EXPECT_EQ(axis(1, 1.009, 1), 2);
  EXPECT_EQ(axis(1, 1.011, 1), 1);
  EXPECT_EQ(axis(3, 2, 1), 0);
  EXPECT_EQ(axis(2, 3, 1), 1);
  v.spacing_mm = {1, 1, 5};
  EXPECT_EQ(stacking_axis(v, StackAxis::x), 0);
  EXPECT_EQ(stacking_axis(v, StackAxis::y), 1);
  EXPECT_EQ(stacking_axis(v, StackAxis::z), 2);
}

TEST(ExtractSections, EveryVoxelIsInTheRegionOfItsLabelWhereItLiesInTheWorld) {
  for (int seed = 0; seed < 24; ++seed) {
    const LabelVolume v = oblique_volume(seed);
    for (StackAxis axis : kAxes)
      for (double simplify : {0.0, 0.5}) {
        const ContourResult result = extract(v, axis, simplify);
        const Stack& stack = result.stack;
        const int w = result.axis;
        ASSERT_EQ(stack.sections.size(), static_cast<std::size_t>(v.size[w]));
        ASSERT_EQ(stack.frame.mirrors(), seed % 2 != 0);
        ASSERT_DOUBLE_EQ(stack.pixel_mm, std::min(v.spacing_mm[(w + 1) % 3], v.spacing_mm[(w + 2) % 3]));
        for (int k = 0; k < v.size[2]; ++k)
          for (int j = 0; j < v.size[1]; ++j)
            for (int i = 0; i < v.size[0]; ++i) {
              const Vec3 p = stack.frame.to_stack(v.world(i, j, k));
              const int slice = std::array{i, j, k}[w];
              ASSERT_NEAR(p.z, stack.sections[slice].z_mm, 1e-9);
              const Label label = v.labels[v.voxels[v.index(i, j, k)]].number;
              const double px = p.x / stack.grid_x_mm, py = p.y / stack.grid_y_mm;
              bool inside = false;
              if (label == 0) continue;  // covered: regions of labels hold their voxels, and areas add up below
              for (const SectionEdge& e : stack.sections[slice].edges) {
                if (e.left != label && e.right != label) continue;
                const GridPoint a = stack.sections[slice].points[e.a], b = stack.sections[slice].points[e.b];
                if ((a.y <= py) == (b.y <= py)) continue;
                if (a.x + (py - a.y) * (static_cast<double>(b.x) - a.x) / (static_cast<double>(b.y) - a.y) > px)
                  inside = !inside;
              }
              ASSERT_TRUE(inside) << "seed " << seed << " axis " << w << " voxel " << i << " " << j << " " << k;
            }
        if (simplify > 0) continue;
        const auto voxels = count_voxels(v);
        for (std::size_t l = 1; l < v.labels.size(); ++l) {
          double area = 0;
          for (const Section& s : stack.sections) area += label_area_mm2(stack, s, v.labels[l].number);
          ASSERT_NEAR(area * v.spacing_mm[w], voxels[l] * v.voxel_volume_mm3(), 1e-9 * v.voxels.size());
        }
      }
  }
}

TEST(ExtractSections, AnotherAxisIsThePermutedVolume) {
  for (int seed = 0; seed < 200; ++seed) {
    const LabelVolume v = oblique_volume(seed);
    for (StackAxis axis : {StackAxis::x, StackAxis::y}) {
      const int w = axis == StackAxis::x ? 0 : 1, u = (w + 1) % 3, t = (w + 2) % 3;
      LabelVolume p = v;
      p.size = {v.size[u], v.size[t], v.size[w]};
      p.spacing_mm = {v.spacing_mm[u], v.spacing_mm[t], v.spacing_mm[w]};
      p.axes = {v.axes[u], v.axes[t], v.axes[w]};
      for (int k = 0; k < p.size[2]; ++k)
        for (int j = 0; j < p.size[1]; ++j)
          for (int i = 0; i < p.size[0]; ++i) {
            std::array<int, 3> from;
            from[u] = i;
            from[t] = j;
            from[w] = k;
            p.voxels[p.index(i, j, k)] = v.voxels[v.index(from[0], from[1], from[2])];
          }
      const ContourResult a = extract(v, axis, 0.5), b = extract(p, StackAxis::z, 0.5);
      ASSERT_EQ(digest(a.stack), digest(b.stack)) << "seed " << seed;
      ASSERT_EQ(a.loops, b.loops);
      ASSERT_LT(norm(a.stack.frame.to_world({3, 4, 5}) - b.stack.frame.to_world({3, 4, 5})), 1e-9);
      ASSERT_DOUBLE_EQ(a.stack.grid_x_mm, b.stack.grid_x_mm);
      ASSERT_DOUBLE_EQ(a.stack.grid_y_mm, b.stack.grid_y_mm);
    }
  }
}

TEST(ExtractSections, ThreadsDoNotShow) {
  for (int seed = 0; seed < 60; ++seed) {
    const LabelVolume v = testing_support::random_volume(seed);
    for (StackAxis axis : kAxes)
      for (double simplify : {0.0, 0.5, 2.0}) {
        const auto one = digest(extract(v, axis, simplify, 1).stack);
        ASSERT_EQ(one, digest(extract(v, axis, simplify, 2).stack)) << "seed " << seed;
        ASSERT_EQ(one, digest(extract(v, axis, simplify, 5).stack)) << "seed " << seed;
      }
  }
}

TEST(ExtractSections, MirroredAndTransposedVolumesHaveTheSameAreas) {
  for (int seed = 0; seed < 300; ++seed) {
    const LabelVolume v = testing_support::random_volume(seed);
    LabelVolume mirrored = v, transposed = v;
    std::swap(transposed.size[0], transposed.size[1]);
    std::swap(transposed.spacing_mm[0], transposed.spacing_mm[1]);
    for (int k = 0; k < v.size[2]; ++k)
      for (int j = 0; j < v.size[1]; ++j)
        for (int i = 0; i < v.size[0]; ++i) {
          mirrored.voxels[v.index(v.size[0] - 1 - i, j, k)] = v.voxels[v.index(i, j, k)];
          transposed.voxels[transposed.index(j, i, k)] = v.voxels[v.index(i, j, k)];
        }
    const ContourResult a = extract(v, StackAxis::z), b = extract(mirrored, StackAxis::z),
                        c = extract(transposed, StackAxis::z);
    ASSERT_EQ(a.vertices_traced, b.vertices_traced);
    ASSERT_EQ(a.vertices_traced, c.vertices_traced);
    ASSERT_EQ(a.loops, b.loops);
    ASSERT_EQ(a.loops, c.loops);
    for (std::size_t k = 0; k < a.stack.sections.size(); ++k)
      for (const LabelInfo& l : v.labels) {
        const double area = label_area_mm2(a.stack, a.stack.sections[k], l.number);
        ASSERT_NEAR(area, label_area_mm2(b.stack, b.stack.sections[k], l.number), 1e-9) << "seed " << seed;
        ASSERT_NEAR(area, label_area_mm2(c.stack, c.stack.sections[k], l.number), 1e-9) << "seed " << seed;
      }
  }
}

TEST(ExtractSections, SimplifiedSectionsOfRandomStacksKeepCentresAndDoNotCross) {
  for (int seed = 0; seed < 400; ++seed) {
    const LabelVolume v = testing_support::random_volume(seed);  // palette and numbers agree: centres can be compared
    const ContourResult result = extract(v, StackAxis::z, seed % 2 != 0 ? 0.5 : 2);
    ASSERT_LE(result.vertices, result.vertices_traced);
    for (int k = 0; k < v.size[2]; ++k) {
      Slice s;
      s.width = v.size[0];
      s.height = v.size[1];
      s.pixels.assign(v.voxels.begin() + static_cast<std::ptrdiff_t>(v.index(0, 0, k)),
                      v.voxels.begin() + static_cast<std::ptrdiff_t>(v.index(0, 0, k + 1)));
      const std::vector<Edge> edges = edges_of(result.stack.sections[k]);
      ASSERT_EQ(count_relabelled_centres(s, edges), 0) << "seed " << seed << " slice " << k;
      ASSERT_EQ(count_clashes(edges), 0) << "seed " << seed << " slice " << k;
      ASSERT_GE(smallest_boundary(edges), 3U) << "seed " << seed << " slice " << k;
    }
  }
}

TEST(ExtractSections, NamesWhatTouchesTheEnds) {
  const LabelVolume v = testing_support::volume_of({{"0120", "0000"}, {"0333", "3330"}, {"0000", "0040"}});
  const Stack stack = extract(v, StackAxis::z).stack;
  EXPECT_EQ(stack.touches_low, (std::vector<Label>{1, 2}));
  EXPECT_EQ(stack.touches_high, (std::vector<Label>{4}));
}

TEST(ExtractSections, AnEmptySliceIsAnEmptySection) {
  const Stack stack =
      extract(testing_support::volume_of({{"11", "11"}, {"00", "00"}, {"11", "11"}}, 2.5), StackAxis::z).stack;
  ASSERT_EQ(stack.sections.size(), 3U);
  EXPECT_TRUE(stack.sections[1].edges.empty());
  EXPECT_EQ(stack.sections[1].z_mm, 2.5);
}

TEST(ExtractSections, MarksInterpolatedSections) {
  const LabelVolume v = testing_support::volume_of({{"1"}, {"1"}, {"1"}, {"1"}, {"1"}, {"1"}, {"1"}}, 2);
  ContourOptions options;
  options.axis = StackAxis::z;
  options.virtual_per_gap = 2;
  Monitor silent;
  const Stack stack = extract_sections(v, options, silent).stack;
  for (std::size_t k = 0; k < 7; ++k) EXPECT_EQ(stack.sections[k].interpolated, k % 3 != 0) << k;
  EXPECT_EQ(stack.end_gap_mm, 6);  // an end stands for half a gap of the real slices
}

TEST(ExtractSections, ProgressEndsAtOne) {
  struct Watch : Monitor {
    void advance(double fraction) override { last = std::max(last, fraction); }
    double last = 0;
  } watch;
  extract_sections(testing_support::volume_of({{"11"}, {"11"}}), ContourOptions{}, watch);
  EXPECT_EQ(watch.last, 1);
}

TEST(ExtractSections, RefusesOneSliceAndEmptyVolumes) {
  const auto error = [](const LabelVolume& v, StackAxis axis) -> std::string {
    try {
      extract(v, axis);
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::input);
      return e.what();
    }
    return "no error";
  };
  const LabelVolume one = testing_support::volume_of({{"01", "11"}});
  EXPECT_NE(error(one, StackAxis::z).find("only one slice along the stacking axis, axis z"), std::string::npos)
      << error(one, StackAxis::z);
  EXPECT_EQ(error(one, StackAxis::x), "no error");
  EXPECT_NE(error(testing_support::volume_of({{"00"}, {"00"}}), StackAxis::z).find("no non-zero label"),
            std::string::npos);
}

}  // namespace
}  // namespace stackmesh::contour_tests
