// Walls of left ventricles from drawn contours: how thick they are in space, against what was drawn.
#include <algorithm>
#include <cmath>
#include <limits>

#include "image/read_contours.h"
#include "meshio/read_mesh.h"
#include "program.h"

namespace program {
namespace {

using stackmesh::Vec3;

/// Squared distance of a point to a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
double squared_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto to = [&](const Vec3& q) { return dot(p - q, p - q); };
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
               d6 = dot(ac, cp);
  if (d1 <= 0 && d2 <= 0) return to(a);
  if (d3 >= 0 && d4 <= d3) return to(b);
  if (d6 >= 0 && d5 <= d6) return to(c);
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return to(a + (d1 / (d1 - d3)) * ab);
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return to(a + (d2 / (d2 - d6)) * ac);
  if (va <= 0 && d4 >= d3 && d5 >= d6) return to(b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b));
  return to(a + (vb / (va + vb + vc)) * ab + (vc / (va + vb + vc)) * ac);
}

class HeartWalls : public ProgramTest {
 protected:
  /// Smallest distance between the two outlines in any section up to a height, mm.
  static double thinnest_drawn(const std::string& epi, const std::string& endo, double up_to) {
    const stackmesh::LabelContours outer = stackmesh::read_contour_file(epi),
                                   inner = stackmesh::read_contour_file(endo);
    double least = std::numeric_limits<double>::infinity();
    const auto measure = [&](const stackmesh::ContourPolygon& from, const stackmesh::ContourPolygon& to) {
      for (const auto& v : from.points)
        for (std::size_t i = 0; i < to.points.size(); ++i) {
          const auto &a = to.points[i], &b = to.points[(i + 1) % to.points.size()];
          const Vec3 start{a[0], a[1], 0};
          least = std::min(least, squared_distance({v[0], v[1], 0}, start, {b[0], b[1], 0}, start));
        }
    };
    for (const stackmesh::ContourSection& s : outer.sections)
      for (const stackmesh::ContourSection& t : inner.sections)
        if (std::abs(s.z_mm - t.z_mm) < 1e-3 && s.z_mm <= up_to)
          for (const auto& p : s.polygons)
            for (const auto& q : t.polygons) measure(p, q), measure(q, p);
    return std::sqrt(least);
  }

  /// The wall between the labels' surfaces is nowhere thinner than half of the thinnest drawn one, up to a height.
  void is_kept(const std::string& heart, double up_to, const std::vector<std::string>& more = {}) {
    const std::string epi = shared_data("heart_sax_sunnybrook/" + heart + "/epi_ED.cnt"),
                      endo = shared_data("heart_sax_sunnybrook/" + heart + "/endo_ED.cnt");
    if (epi.empty() || endo.empty()) GTEST_SKIP() << "NOT TESTED: needs ../shared/data/heart_sax_sunnybrook";
    std::vector<std::string> command = {"surface",    "1=" + epi, "2=" + endo,  "-o",
                                        out("a.vtp"), "--report", out("R.json")};
    command.insert(command.end(), more.begin(), more.end());
    succeeds(command);
    for (int label : {1, 2}) {
      EXPECT_EQ(row(report(), label).at("genus"), 0) << label;
      EXPECT_EQ(row(report(), label).at("components"), 1) << label;
    }
    const stackmesh::MeshFile mesh = stackmesh::read_mesh(out("a.vtp"));
    double top = -1e300;
    for (const Vec3& p : mesh.points) top = std::max(top, p.z);
    std::vector<std::array<Vec3, 3>> outside;
    std::vector<char> inside(mesh.points.size(), 0);
    for (const stackmesh::InterfaceTriangle& t : mesh.triangles) {
      const std::array<Vec3, 3> at = {mesh.points[t.v[0]], mesh.points[t.v[1]], mesh.points[t.v[2]]};
      const bool on_top = std::min({at[0].z, at[1].z, at[2].z}) > top - 1e-6;  // the flat end is no side of the wall
      const auto sides = std::minmax(t.below, t.above);
      if (sides.first == 0 && sides.second == 1 && !on_top) outside.push_back(at);
      if (sides.first == 1 && sides.second == 2)
        for (std::int32_t v : t.v) inside[v] = 1;
    }
    double least = std::numeric_limits<double>::infinity();
    Vec3 where;
    for (std::size_t v = 0; v < inside.size(); ++v) {
      const Vec3& p = mesh.points[v];
      if (!inside[v] || p.z > up_to) continue;
      for (const auto& t : outside) {
        const double away =
            std::max({std::min({t[0].z, t[1].z, t[2].z}) - p.z, p.z - std::max({t[0].z, t[1].z, t[2].z}), 0.0});
        if (away * away >= least) continue;
        if (const double d = squared_distance(p, t[0], t[1], t[2]); d < least) least = d, where = p;
      }
    }
    const double wall = std::sqrt(least), drawn = thinnest_drawn(epi, endo, up_to);
    RecordProperty("thinnest_mm", std::to_string(wall));
    std::printf("%s: thinnest wall %.3f mm at (%.1f, %.1f, %.1f), drawn %.3f mm\n", heart.c_str(), wall, where.x,
                where.y, where.z, drawn);
    EXPECT_GT(drawn, 1) << "the contours touch";
    EXPECT_GE(wall, 0.5 * drawn) << where.x << ' ' << where.y << ' ' << where.z;
  }
};

// The topmost two contours run on each other along the dent of the outer one, which a warning names; slivers of wall
// between them hang on nothing.
TEST_F(HeartWalls, OfTheFirstIsKeptBeneathWhereItsContoursOpenIt) {
  is_kept("SC-HF-I-1", -68.9, {"--min-piece", "50"});
}
TEST_F(HeartWalls, OfTheSecondIsKept) {
  is_kept("SC-HF-I-2", 1e9);
}
TEST_F(HeartWalls, OfTheFourthIsKept) {
  is_kept("SC-HF-I-4", 1e9);
}

}  // namespace
}  // namespace program
