// --refine: eight tets for each, on the same sides.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "blocks.h"
#include "meshio/read_mesh.h"
#include "shapes.h"
#include "validate/check_surface.h"
#include "validate/check_volume.h"
#include "volume/fill_volume.h"
#include "volume/raise_order.h"
#include "volume/refine_tets.h"

namespace stackmesh {
namespace {

Vec3 place(const TetMesh& mesh, std::size_t t, const std::array<double, 4>& l) {
  Vec3 x;
  for (int i = 0; i < 4; ++i) x = x + (mesh.mid.empty() ? l[i] : l[i] * (2 * l[i] - 1)) * mesh.points[mesh.tets[t][i]];
  if (!mesh.mid.empty())
    for (int k = 0; k < 6; ++k) x = x + 4 * l[kTetEdges[k][0]] * l[kTetEdges[k][1]] * mesh.points[mesh.mid[t][k]];
  return x;
}

TetMesh filled(const InterfaceComplex& complex) {
  FillResult result = fill_volume(complex, {});
  EXPECT_EQ(result.status, FillResult::Status::verified) << result.message;
  return std::move(result.mesh);
}

/// Every point of every child is the point of its parent at the same place: nothing has moved.
void expect_same_shape(const TetMesh& coarse, const TetMesh& fine) {
  ASSERT_EQ(fine.tets.size(), 8 * coarse.tets.size());
  ASSERT_EQ(fine.mid.size(), coarse.mid.empty() ? 0 : fine.tets.size());
  ASSERT_EQ(fine.faces.size(), 4 * coarse.faces.size());
  for (std::size_t v = 0; v < coarse.points.size(); ++v) ASSERT_EQ(norm(fine.points[v] - coarse.points[v]), 0);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (std::size_t t = 0; t < coarse.tets.size(); ++t) {
    // Where the parent's ten nodes lie in it. Of a linear parent they are found by their coordinates.
    const auto local = [&](std::int32_t v) {
      for (int i = 0; i < 4; ++i)
        if (coarse.tets[t][i] == v) {
          std::array<double, 4> l{};
          l[i] = 1;
          return l;
        }
      for (int e = 0; e < 6; ++e) {
        std::array<double, 4> l{};
        l[kTetEdges[e][0]] = l[kTetEdges[e][1]] = 0.5;
        if (coarse.mid.empty() ? norm(place(coarse, t, l) - fine.points[v]) < 1e-12 : coarse.mid[t][e] == v) return l;
      }
      ADD_FAILURE() << "a child's corner is no node of its parent";
      return std::array<double, 4>{};
    };
    for (std::size_t c = 8 * t; c < 8 * t + 8; ++c) {
      ASSERT_EQ(fine.labels[c], coarse.labels[t]);
      std::array<double, 4> w, l{};
      double sum = 0;
      for (double& x : w) sum += x = uniform(random);
      for (int k = 0; k < 4; ++k) {
        const auto corner = local(fine.tets[c][k]);
        for (int i = 0; i < 4; ++i) l[i] += w[k] / sum * corner[i];
      }
      for (double& x : w) x /= sum;
      ASSERT_LT(norm(place(fine, c, w) - place(coarse, t, l)), 1e-12 * (1 + norm(place(coarse, t, l)))) << "tet " << t;
    }
  }
}

void expect_sound(const TetMesh& mesh) {
  const VolumeCheck v = check_volume(mesh, {});
  EXPECT_EQ(v.inverted, 0u);
  EXPECT_TRUE(v.conforms);
  const SurfaceCheck s = check_surface(surface_of(mesh), {});
  EXPECT_EQ(s.open_edges, 0u);
  EXPECT_EQ(s.self_intersections, 0u);
  if (mesh.mid.empty()) return;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> on_edge;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (int e = 0; e < 6; ++e) {
      const auto ends = std::minmax(mesh.tets[t][kTetEdges[e][0]], mesh.tets[t][kTetEdges[e][1]]);
      ASSERT_EQ(on_edge.insert({ends, mesh.mid[t][e]}).first->second, mesh.mid[t][e]) << "two nodes on an edge";
    }
}

TEST(Refine, StraightAndCurvedMeshesOfTwoLabelsKeepTheirShape) {
  TetMesh linear = filled(shapes::sphere(2, 10));
  for (const bool curved : {false, true}) {
    const TetMesh coarse = curved ? raise_order(linear).mesh : linear;
    const TetMesh fine = refine_tets(coarse, 1);
    expect_same_shape(coarse, fine);
    expect_sound(fine);
    // Twice is once and once again.
    const TetMesh finer = refine_tets(coarse, 2);
    expect_same_shape(fine, finer);
    EXPECT_EQ(finer.points.size(), refine_tets(fine, 1).points.size());
  }
}

TEST(Refine, InterfacesAndLabelsStay) {
  TetMesh mesh = blocks::block(3, 2, 2, {1, 1.3, 0.7}, [](int i, int j, int) { return i == 0 ? 4 : j == 0 ? 9 : 2; });
  blocks::disturb(mesh, 3, 2, 2, {1, 1.3, 0.7});
  mesh.faces = faces_of_tets(mesh);
  const TetMesh fine = refine_tets(mesh, 2);
  expect_sound(fine);
  std::map<Label, double> before, after;
  for (const auto& [label, v] : shapes::volumes(mesh)) before[label] = v;
  for (const auto& [label, v] : shapes::volumes(fine)) after[label] = v;
  ASSERT_EQ(before.size(), 3u);
  for (const auto& [label, v] : before) EXPECT_NEAR(after[label], v, 1e-12 * v);
  // The fine mesh's own faces are its triangles.
  const auto key = [](const InterfaceTriangle& t) {
    std::array<std::int32_t, 3> v = t.v;
    std::sort(v.begin(), v.end());
    return std::make_pair(v, std::minmax(t.below, t.above));
  };
  std::set<std::pair<std::array<std::int32_t, 3>, std::pair<Label, Label>>> own, given;
  for (const InterfaceTriangle& t : faces_of_tets(fine)) own.insert(key(t));
  for (const InterfaceTriangle& t : fine.faces) given.insert(key(t));
  EXPECT_EQ(own, given);
}

}  // namespace
}  // namespace stackmesh
