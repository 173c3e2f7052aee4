// Drawn shapes with no option, through the program: the enhanced surface is what was drawn, in volume, place, genus and
// ends.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <sstream>

#include "meshio/read_mesh.h"
#include "program.h"

namespace program {
namespace {

using stackmesh::InterfaceTriangle;
using stackmesh::MeshFile;
using stackmesh::Vec3;

using Outline = std::vector<std::array<double, 2>>;
using Outlines = std::vector<Outline>;

constexpr double kPlace = 0.05;  // mm: of every vertex
constexpr double kChord = 0.12;  // mm: of every drawn point from the triangles, whose edges are chords of the outlines

Outline box(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

Outline disc(double cx, double cy, double r, int n = 64) {
  Outline p;
  for (int i = 0; i < n; ++i) p.push_back({cx + r * std::cos(2 * M_PI * i / n), cy + r * std::sin(2 * M_PI * i / n)});
  return p;
}

double disc_area(double r, int n) {
  return 0.5 * n * std::sin(2 * M_PI / n) * r * r;
}

double squared_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, n = cross(ab, ac);
  const auto to_edge = [&](const Vec3& u, const Vec3& v) {
    const Vec3 e = v - u;
    const Vec3 q = p - (u + std::clamp(dot(p - u, e) / std::max(dot(e, e), 1e-300), 0.0, 1.0) * e);
    return dot(q, q);
  };
  const bool above =
      dot(cross(ab, p - a), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 && dot(cross(a - c, p - c), n) >= 0;
  if (above && dot(n, n) > 0) return dot(p - a, n) * dot(p - a, n) / dot(n, n);
  return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

/// The largest distance of a vertex of one mesh to the other's triangles, mm; of some 1,500 of them, evenly chosen.
double farthest(const MeshFile& from, const MeshFile& to) {
  std::vector<char> used(from.points.size(), 0);
  for (const InterfaceTriangle& t : from.triangles)
    for (const std::int32_t v : t.v) used[v] = 1;
  double worst = 0;
  const std::size_t every = static_cast<std::size_t>(std::count(used.begin(), used.end(), 1)) / 1500 + 1;
  std::size_t number = 0;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v] || number++ % every != 0) continue;
    const Vec3& p = from.points[v];
    double least = std::numeric_limits<double>::infinity();
    for (const InterfaceTriangle& t : to.triangles) {
      const Vec3 &a = to.points[t.v[0]], &b = to.points[t.v[1]], &c = to.points[t.v[2]];
      const double dx = std::max({std::min({a.x, b.x, c.x}) - p.x, p.x - std::max({a.x, b.x, c.x}), 0.0}),
                   dy = std::max({std::min({a.y, b.y, c.y}) - p.y, p.y - std::max({a.y, b.y, c.y}), 0.0});
      if (dx * dx + dy * dy >= least) continue;
      least = std::min(least, squared_distance(p, a, b, c));
      if (least < 1e-8) break;
    }
    worst = std::max(worst, std::sqrt(least));
  }
  return worst;
}

class DrawnShapes : public ProgramTest {
 protected:
  template <class At>
  std::string drawn(const std::string& name, double first, double gap, int sections, At at) const {
    std::ostringstream text;
    text.precision(17);
    text << "S " << sections << "\n";
    for (int k = 0; k < sections; ++k) {
      const double z = first + gap * k;
      const Outlines outlines = at(z);
      std::size_t points = 0;
      for (const Outline& o : outlines) points += o.size();
      text << "v " << points << " z " << z << "\n";
      for (const Outline& o : outlines) {
        text << "{\n";
        for (const auto& p : o) text << p[0] << ' ' << p[1] << "\n";
        text << "}\n";
      }
    }
    return write(name, text.str());
  }
  /// The enhanced surface of inputs with no option but `more`.
  Json surface(std::vector<std::string> inputs, const std::vector<std::string>& more = {}) {
    inputs.insert(inputs.begin(), "surface");
    inputs.insert(inputs.end(), {"-o", out("a.vtp"), "--report", out("R.json")});
    inputs.insert(inputs.end(), more.begin(), more.end());
    ended_ = succeeds(inputs);
    mesh_ = stackmesh::read_mesh(out("a.vtp"));
    const Json r = report();
    EXPECT_EQ(r.at("surface").at("level"), "enhanced");
    EXPECT_EQ(r.at("surface").at("self_intersections"), 0);
    return r;
  }
  /// The same, and it lies where the stitched surface does, whose sections are what was drawn.
  Json in_place(const std::vector<std::string>& inputs, double place_mm = kPlace, double chord_mm = kChord) {
    const Json r = surface(inputs);
    std::vector<std::string> raw = {"surface", "--raw", "-o", out("raw.vtp")};
    raw.insert(raw.begin() + 1, inputs.begin(), inputs.end());
    succeeds(raw);
    const MeshFile stitched = stackmesh::read_mesh(out("raw.vtp"));
    const double off = farthest(mesh_, stitched), chord = farthest(stitched, mesh_);
    std::printf("%s: vertices within %.3f mm, drawn points within %.3f mm, %zu triangles\n",
                inputs[0].substr(inputs[0].rfind('/') + 1).c_str(), off, chord, mesh_.triangles.size());
    EXPECT_LT(off, place_mm) << inputs[0];
    EXPECT_LT(chord, chord_mm) << inputs[0];
    return r;
  }
  std::array<double, 2> heights(int label) const {
    std::array<double, 2> z = {1e300, -1e300};
    for (const InterfaceTriangle& t : mesh_.triangles)
      if (t.below == label || t.above == label)
        for (const std::int32_t v : t.v) z = {std::min(z[0], mesh_.points[v].z), std::max(z[1], mesh_.points[v].z)};
    return z;
  }
  static double volume(const Json& r, int label) { return row(r, label).at("surface_volume_mm3"); }
  static void has(const Json& r, int label, double volume_mm3, double within_rel, int genus, int pieces = 1) {
    EXPECT_NEAR(volume(r, label), volume_mm3, within_rel * volume_mm3) << label;
    EXPECT_EQ(row(r, label).at("genus"), genus) << label;
    EXPECT_EQ(row(r, label).at("components"), pieces) << label;
  }
  Ended ended_;
  MeshFile mesh_;
};

TEST_F(DrawnShapes, FilesLieWhereTheyWereDrawn) {
  has(in_place({testdata("drawn/box20.cnt")}), 1, 20 * 20 * 21, 0.005, 0);
  has(in_place({testdata("drawn/rt_box100.dcm")}), 1, 100 * 100 * 24, 0.005, 0);
  has(in_place({testdata("drawn/rt_dup.dcm")}), 1, 30096, 0.005, 0);
  has(in_place({testdata("drawn/rt_inner_end.dcm")}), 1, 30075, 0.005, 0);
  has(in_place({testdata("drawn/rt_jitter3.dcm")}), 1, 18850, 0.005, 0);
}

TEST_F(DrawnShapes, FilesWithManyPointsLieWhereTheyWereDrawn) {
  Json r = in_place({testdata("drawn/rt_gap.dcm")});
  has(r, 1, 56313, 0.005, 0);
  has(r, 2, disc_area(8, 64) * 41, 0.005, 0);
  r = in_place({testdata("drawn/rt_un.dcm")});
  has(r, 1, disc_area(150, 2600) * 12, 0.005, 0);
  EXPECT_NEAR(heights(1)[0], -1.5, 1e-6);
  EXPECT_NEAR(heights(1)[1], 10.5, 1e-6);
}

TEST_F(DrawnShapes, PrismsKeepTheirVolumeAndPlace) {
  const std::vector<std::pair<Outlines, double>> prisms = {
      {{box(-10, -10, 10, 10)}, 400},
      {{Outline{{0, 0}, {30, 0}, {30, 8}, {8, 8}, {8, 30}, {0, 30}}}, 30 * 8 + 22 * 8},
      {{box(0, 0, 40, 40), box(5, 5, 35, 35)}, 1600 - 900},
      {{disc(0, 0, 15, 8)}, disc_area(15, 8)},
      {{disc(0, 0, 15, 16)}, disc_area(15, 16)},
      {{disc(0, 0, 15, 64)}, disc_area(15, 64)}};
  int k = 0;
  for (const auto& [outlines, area] : prisms) {
    const std::string file =
        drawn("prism" + std::to_string(k++) + ".cnt", 0, 3, 7, [&, o = &outlines](double) { return *o; });
    // Sixteen corners of 22.5 degrees are no corners but a smooth outline: its surface lies between the polygon and the
    // circle, or beside it by the chords.
    const bool smooth = outlines[0].size() == 16;
    const double bulge = 15 * (1 - std::cos(M_PI / 16));
    has(smooth ? in_place({file}, bulge, 2 * bulge) : in_place({file}), 1, area * 18, 0.005,
        static_cast<int>(outlines.size()) - 1);
    EXPECT_NEAR(heights(1)[0], 0, 1e-6) << k;
    EXPECT_NEAR(heights(1)[1], 18, 1e-6) << k;
  }
}

TEST_F(DrawnShapes, ATorusAlongAndAcrossItsSectionsIsOneRing) {
  const double R = 20, r = 6;
  // of its cross-section, below and above the first and last cut
  const double beyond = 2 * (r * r * std::acos(5 / r) - 5 * std::sqrt(r * r - 25));
  const auto lying = [&](double z) {
    const double w = std::sqrt(std::max(0.0, r * r - z * z));
    return Outlines{disc(0, 0, R + w, 96), disc(0, 0, R - w, 72)};
  };
  has(surface({drawn("lying.cnt", -5, 1, 11, lying)}, {"--caps", "flat"}), 1, 2 * M_PI * R * (M_PI * r * r - beyond),
      0.01, 1);
  const auto standing = [&](double z) {
    const int n = 60;
    const double t0 = std::abs(z) > R ? std::sqrt(std::max(0.0, r * r - (std::abs(z) - R) * (std::abs(z) - R))) : r;
    const auto outer = [&](double y) {
      return std::sqrt(std::max(0.0, std::pow(R + std::sqrt(std::max(0.0, r * r - y * y)), 2) - z * z));
    };
    const auto inner = [&](double y) {
      return std::sqrt(std::max(0.0, std::pow(R - std::sqrt(std::max(0.0, r * r - y * y)), 2) - z * z));
    };
    Outlines all;
    if (std::abs(z) >= R - r) {
      Outline one;
      for (int i = 0; i < n; ++i) one.push_back({outer(-t0 * std::cos(M_PI * i / n)), -t0 * std::cos(M_PI * i / n)});
      for (int i = 0; i < n; ++i) one.push_back({-outer(t0 * std::cos(M_PI * i / n)), t0 * std::cos(M_PI * i / n)});
      return Outlines{one};
    }
    for (const double side : {1.0, -1.0}) {
      Outline p;
      for (int i = 0; i < n; ++i) p.push_back({side * outer(-r * std::cos(M_PI * i / n)), -r * std::cos(M_PI * i / n)});
      for (int i = 0; i < n; ++i) p.push_back({side * inner(r * std::cos(M_PI * i / n)), r * std::cos(M_PI * i / n)});
      all.push_back(p);
    }
    return all;
  };
  has(surface({drawn("standing.cnt", -25, 2, 26, standing)}), 1, 2 * M_PI * R * M_PI * r * r, 0.02, 1);
}

TEST_F(DrawnShapes, WhatBranchesEndsOrOpensDoesSoOnce) {
  const auto fork = [](double z) {
    return z < 9 ? Outlines{disc(0, 0, 12)} : Outlines{disc(-5 - 0.5 * z, 0, 6), disc(5 + 0.5 * z, 0, 6)};
  };
  const Json y = surface({drawn("fork.cnt", 0, 3, 9, fork)});
  // and the gap of 3 mm between them holds from the one to the other
  const double trunk = disc_area(12, 64) * 6, arms = 2 * disc_area(6, 64) * 15;
  has(y, 1, trunk + arms + 1.5 * (disc_area(12, 64) + 2 * disc_area(6, 64)), 0.1, 0);
  EXPECT_NEAR(heights(1)[0], 0, 0.01);
  // A cone that ends between sections, beside a rod that goes on.
  const auto cone = [](double z) { return Outlines{disc(0, 0, 17 - z)}; };
  const auto rod = [](double) { return Outlines{disc(60, 0, 8)}; };
  const Json c = surface({"1=" + drawn("cone.cnt", 0, 4, 5, cone), "2=" + drawn("rod.cnt", 0, 4, 9, rod)});
  has(c, 1, M_PI / 3 * (17 * 17 * 17 - 1), 0.02, 0);
  EXPECT_NEAR(heights(1)[1], 17, 1.2);  // its tip; half a gap beyond its last section is 18
  has(c, 2, disc_area(8, 64) * 32, 0.005, 0);
  EXPECT_NEAR(heights(2)[1], 32, 1e-6);
  const auto opening = [](double z) {
    if (z < 9) return Outlines{disc(0, 0, 20), disc(0, 0, 12)};
    Outline o;
    for (int i = 0; i <= 80; ++i)
      o.push_back({20 * std::cos(0.4 + (2 * M_PI - 0.8) * i / 80), 20 * std::sin(0.4 + (2 * M_PI - 0.8) * i / 80)});
    for (int i = 80; i >= 0; --i)
      o.push_back({12 * std::cos(0.4 + (2 * M_PI - 0.8) * i / 80), 12 * std::sin(0.4 + (2 * M_PI - 0.8) * i / 80)});
    return Outlines{o};
  };
  const double ring = M_PI * (400 - 144), c_part = ring * (1 - 0.8 / (2 * M_PI));
  has(surface({drawn("ring.cnt", 0, 3, 7, opening)}), 1, 6 * ring + 9 * c_part + 3 * 0.5 * (ring + c_part), 0.015, 1);
}

TEST_F(DrawnShapes, NestedStacksStayNested) {
  for (const unsigned seed : {1u, 6u, 11u, 16u, 21u, 26u}) {
    std::mt19937 random(seed);
    const auto real = [&](double low, double high) { return low + (high - low) * (random() / 4294967296.0); };
    const int levels = 2 + static_cast<int>(seed % 3), sections = 3 + static_cast<int>(random() % 3);
    const double gap = real(3, 10), wall = real(2, 5);
    std::vector<std::array<double, 2>> at;  // middle of each section: it moves by up to the wall
    double x = 0, y = 0;
    for (int k = 0; k < sections; ++k) {
      const double angle = real(0, 2 * M_PI), way = real(0.3, 1) * wall;
      at.push_back({x += way * std::cos(angle), y += way * std::sin(angle)});
    }
    std::vector<std::string> inputs;
    for (int d = 0; d < levels; ++d)
      inputs.push_back(std::to_string(d + 1) + "=" +
                       drawn("n" + std::to_string(d) + ".cnt", 0, gap, sections, [&](double z) {
                         const auto& m = at[static_cast<std::size_t>(std::lround(z / gap))];
                         return Outlines{disc(m[0], m[1], 14 + wall * (levels - 1 - d), 72)};
                       }));
    const Json r = surface(inputs, {"--caps", "round"});
    for (int d = 1; d <= levels; ++d) {
      EXPECT_EQ(row(r, d).at("genus"), 0) << seed << ' ' << d;
      EXPECT_EQ(row(r, d).at("components"), 1) << seed << ' ' << d;
      EXPECT_EQ(row(r, d).at("closed"), true) << seed << ' ' << d;
    }
    for (const InterfaceTriangle& t : mesh_.triangles)
      ASSERT_EQ(std::abs(t.below - t.above), 1) << "seed " << seed << ": " << t.below << " meets " << t.above;
  }
}

}  // namespace
}  // namespace program
