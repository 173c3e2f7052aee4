// The page: what is packed comes out again, nothing of the input can act as HTML, and the file stays small.
#include "report/html_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "../validate/shapes.h"
#include "model/space.h"
#include "page_reader.h"

namespace {

using namespace stackmesh;
using namespace stackmesh::test;
using namespace page_reader;

constexpr double kPi = 3.14159265358979;

/// Two boxes of labels 3 and 7 that share a face, in a volume whose voxels they fill exactly.
struct TwoBoxes {
  LabelVolume volume = empty_volume(12, 10, 8, 7);
  InterfaceComplex surface;
  TwoBoxes() {
    volume.spacing_mm = {1, 1.5, 2};
    fill(volume, {2, 2, 2}, {6, 7, 6}, 3);
    fill(volume, {6, 2, 2}, {10, 7, 6}, 7);
    surface = voxel_surface(volume);
    surface.space = Space::lps;
  }
  HtmlScene scene() const {
    HtmlScene s;
    s.surface = &surface;
    s.volume = &volume;
    return s;
  }
};

RunReport plain_report(const std::string& path = "labels.nii.gz") {
  RunReport r;
  r.version = "0";
  r.command = "mesh";
  r.input.path = path;
  r.surface.emplace();
  return r;
}

std::string page(const HtmlScene& scene, const RunReport& report, const HtmlOptions& options = {}) {
  const HtmlPictures pictures = draw_pictures(scene, options);
  return to_html({{"mesh", &report, &pictures}});
}

double enclosed(const Mesh& m, int label) {
  double volume = 0;
  for (std::size_t t = 0; t < m.elements.size(); ++t) {
    const int sign = (m.labels[t][0] == label) - (m.labels[t][1] == label);
    const auto& v = m.elements[t];
    volume += sign * dot(m.points[v[0]], cross(m.points[v[1]], m.points[v[2]])) / 6;
  }
  return volume;
}

TEST(HtmlReport, TheUnpackedSurfaceHasTheTrianglesAndVolumes) {
  const TwoBoxes boxes;
  const std::string html = page(boxes.scene(), plain_report());
  const Mesh m = mesh(html, 0, "surface");
  EXPECT_EQ(m.elements.size(), boxes.surface.triangles.size());
  EXPECT_EQ(m.points.size(), boxes.surface.points.size());
  const double box = 4 * 1 * 5 * 1.5 * 4 * 2;
  EXPECT_NEAR(enclosed(m, 3), box, 1e-3 * box);
  EXPECT_NEAR(enclosed(m, 7), box, 1e-3 * box);
  for (const double d : m.distances_mm) EXPECT_EQ(d, 0);  // it lies on the voxel faces
  for (const double a : m.angles_deg) EXPECT_TRUE(a >= 26 && a <= 45) << a;
}

TEST(HtmlReport, TheUnpackedTetsHaveTheVolumeOfEachLabel) {
  // Tets between the cells of a jittered grid: volumes by label are sums that packing must keep.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> jitter(-0.2, 0.2);
  TetMesh tets;
  const int n = 9;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) tets.points.push_back({i + jitter(random), j + jitter(random), k + jitter(random)});
  const int corners[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  double volume[3] = {0, 0, 0};
  for (int k = 0; k + 1 < n; ++k)
    for (int j = 0; j + 1 < n; ++j)
      for (int i = 0; i + 1 < n; ++i)
        for (const auto& c : corners) {
          std::array<std::int32_t, 4> t;
          for (int v = 0; v < 4; ++v) t[v] = ((k + (c[v] >> 2)) * n + j + (c[v] >> 1 & 1)) * n + i + (c[v] & 1);
          const Vec3 a = tets.points[t[0]];
          const double six = dot(tets.points[t[1]] - a, cross(tets.points[t[2]] - a, tets.points[t[3]] - a));
          tets.tets.push_back(t);
          tets.labels.push_back(1 + (i + j) % 2);
          volume[tets.labels.back()] += std::abs(six) / 6;
        }
  const InterfaceComplex surface = box({0, 0, 0}, {8, 8, 8}, 1);
  InterfaceComplex both = surface;
  both.space = Space::none;
  add_box(both, {1, 1, 1}, {2, 2, 2}, 2, 1);
  HtmlScene scene;
  scene.surface = &both;
  scene.mesh = &tets;
  const std::string html = page(scene, plain_report());
  const Mesh m = mesh(html, 0, "tets");
  ASSERT_EQ(m.elements.size(), tets.tets.size());
  double unpacked[3] = {0, 0, 0};
  for (std::size_t t = 0; t < m.elements.size(); ++t) {
    const auto& v = m.elements[t];
    const Vec3 a = m.points[v[0]];
    unpacked[m.labels[t][0]] += std::abs(dot(m.points[v[1]] - a, cross(m.points[v[2]] - a, m.points[v[3]] - a))) / 6;
  }
  for (const int label : {1, 2}) EXPECT_NEAR(unpacked[label], volume[label], 2e-3 * volume[label]);
}

TEST(HtmlReport, TheUnpackedSlicesAreTheVoxels) {
  std::mt19937 random(2);
  for (const int axis : {0, 1, 2}) {
    LabelVolume v = empty_volume(7, 6, 5, 4);
    for (auto& voxel : v.voxels) voxel = static_cast<std::uint16_t>(random() % 5);
    const InterfaceComplex surface = voxel_surface(v);
    HtmlScene scene;
    scene.surface = &surface;
    scene.volume = &v;
    scene.stack_axis = axis;
    const std::string html = page(scene, plain_report());
    const Json pictures = page_data(html)["meshes"][0]["pictures"];
    const auto& w = pictures["slices"]["window"];
    for (int k = 0; k < v.size[axis]; ++k) {
      Numbers runs(chunk(html, 0, pictures["slices"], static_cast<std::size_t>(k)));
      std::uint64_t left = 0, label = 0;
      for (int y = 0; y < w[3]; ++y)
        for (int x = 0; x < w[2]; ++x) {
          if (left == 0) label = runs.number(), left = runs.number();
          --left;
          std::array<int, 3> at{};
          at[axis] = k, at[(axis + 1) % 3] = w[0].get<int>() + x, at[(axis + 2) % 3] = w[1].get<int>() + y;
          ASSERT_EQ(label, v.voxels[v.index(at[0], at[1], at[2])]) << axis << " " << k << " " << x << " " << y;
        }
      EXPECT_TRUE(runs.at_end());
    }
  }
}

TEST(HtmlReport, CutsOfABoxHaveItsAreaInEverySectionAndGap) {
  const TwoBoxes boxes;
  const std::string html = page(boxes.scene(), plain_report());
  const Json pictures = page_data(html)["meshes"][0]["pictures"];
  ASSERT_EQ(pictures["planes"].size(), 2u * 8 - 1);
  int full = 0;
  for (std::size_t p = 0; p < pictures["planes"].size(); ++p) {
    const double z = pictures["planes"][p]["z"];  // sections are 2 mm apart, the boxes reach from 3 to 11
    const auto cut = lines(chunk(html, 0, pictures["cuts"], p), pictures["cuts"]["unit_mm"]);
    const bool inside = z > 3 && z <= 11;
    const double area = inside ? 4 * 5 * 1.5 : 0;
    for (const int label : {3, 7}) EXPECT_NEAR(area_of(cut, label), area, 0.2) << z;
    full += inside;
    EXPECT_EQ(cut.size(), inside ? 3u : 0u);  // one line round each box, and the one between them
  }
  EXPECT_EQ(full, 8);
}

TEST(HtmlReport, CutsOfASphereAreClosedCirclesOfItsRadius) {
  LabelVolume v = empty_volume(40, 40, 40, 1);
  fill(v, {10, 10, 10}, {29, 29, 29}, 1);
  const Vec3 centre = {19.5, 19.5, 19.5};
  const InterfaceComplex sphere = icosphere(10, 5, 1, centre);
  HtmlScene scene;
  scene.surface = &sphere;
  scene.volume = &v;
  const std::string html = page(scene, plain_report());
  const Json pictures = page_data(html)["meshes"][0]["pictures"];
  const double tolerance = pictures["cuts"]["tolerance_mm"].get<double>() + pictures["cuts"]["unit_mm"].get<double>();
  int circles = 0;
  for (std::size_t p = 0; p < pictures["planes"].size(); ++p) {
    const double h = pictures["planes"][p]["z"].get<double>() - centre.z, r2 = 100 - h * h;
    for (const Line& line : lines(chunk(html, 0, pictures["cuts"], p), pictures["cuts"]["unit_mm"])) {
      EXPECT_TRUE(line.closed());
      ++circles;
      // Section coordinates begin at the outer corner of the first pixel.
      for (const auto& q : line.points)
        EXPECT_NEAR(std::hypot(q[0] - 0.5 - centre.x, q[1] - 0.5 - centre.y), std::sqrt(r2),
                    0.02 + 10 * tolerance / std::sqrt(r2))
            << h;
    }
  }
  EXPECT_EQ(circles, 39);  // every half millimetre, the poles left out
}

TEST(HtmlReport, ACutHasItsLabelOnTheSameSideInAMirroredVolume) {
  for (const bool mirrored : {false, true}) {
    TwoBoxes boxes;
    if (mirrored) boxes.volume.axes[0] = {-1, 0, 0};
    boxes.surface = voxel_surface(boxes.volume);
    const std::string html = page(boxes.scene(), plain_report());
    const Json pictures = page_data(html)["meshes"][0]["pictures"];
    const Mesh m = mesh(html, 0, "surface");
    EXPECT_GT(enclosed(m, 3) * area_of(lines(chunk(html, 0, pictures["cuts"], 7), pictures["cuts"]["unit_mm"]), 3), 0)
        << mirrored;
  }
}

TEST(HtmlReport, ContoursAreDrawnAsTheyAre) {
  Stack stack;
  stack.grid_x_mm = stack.grid_y_mm = 0.25;
  stack.pixel_mm = 1;
  stack.slices = false;
  stack.labels = {{0, ""}, {4, "wall"}};
  for (const double z : {0.0, 8.0, 20.0}) {
    Section s;
    s.z_mm = z;
    s.points = {{0, 0}, {40, 0}, {40, 24}, {0, 24}};
    s.edges = {{0, 1, 4, 0}, {1, 2, 4, 0}, {2, 3, 4, 0}, {3, 0, 4, 0}};
    stack.sections.push_back(s);
  }
  InterfaceComplex surface = box({0, 0, 0}, {10, 6, 20}, 4);
  surface.space = Space::none;
  HtmlScene scene;
  scene.surface = &surface;
  scene.sections = &stack;
  const Json pictures = [&] {
    const std::string html = page(scene, plain_report("wall.cnt"));
    const Json p = page_data(html)["meshes"][0]["pictures"];
    const auto contour = lines(chunk(html, 0, p["contours"], 1), p["contours"]["unit_mm"]);
    EXPECT_EQ(contour.size(), 1u);
    EXPECT_NEAR(area_of(contour, 1), 60, 1e-9);
    EXPECT_NEAR(area_of(lines(chunk(html, 0, p["cuts"], 1), p["cuts"]["unit_mm"]), 1), 60, 0.1);
    return p;
  }();
  ASSERT_EQ(pictures["planes"].size(), 5u);
  EXPECT_EQ(pictures["planes"][3]["z"], 14.0);
  EXPECT_FALSE(pictures.contains("slices"));
  EXPECT_TRUE(pictures["orientation"]["letters"].is_null());
}

TEST(HtmlReport, SectionsAreShownAsRadiologistsDo) {
  // Axis by axis of an RAS-stored volume: the patient's right is on the left, the front or the head on top.
  TwoBoxes boxes;
  boxes.volume.axes = {Vec3{-1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}};
  boxes.surface = voxel_surface(boxes.volume);
  for (const auto& [axis, letters, right_axis, right_sign, down_sign] :
       {std::tuple(2, "RLAP", 0, -1, -1), std::tuple(1, "RLSI", 1, -1, -1), std::tuple(0, "APSI", 0, -1, -1)}) {
    HtmlScene scene = boxes.scene();
    scene.stack_axis = axis;
    const Json o = page_data(page(scene, plain_report()))["meshes"][0]["pictures"]["orientation"];
    EXPECT_EQ(o["letters"], letters);
    EXPECT_EQ(o["right"]["axis"], right_axis) << axis;
    EXPECT_EQ(o["right"]["sign"], right_sign) << axis;
    EXPECT_EQ(o["down"]["sign"], down_sign) << axis;
  }
}

TEST(HtmlReport, NothingOfTheInputCanActAsHtml) {
  const std::string evil = "</script><script>alert(1)</script><img src=x onerror=\"alert(2)\">'&\"";
  TwoBoxes boxes;
  boxes.volume.labels[3].name = evil;
  RunReport r = plain_report("/data/" + evil + ".nii.gz");
  r.options = {{evil, evil}};
  r.warnings = {{WarningCode::other, "", evil}};
  r.input.kind = evil;
  LabelReport row;
  row.label = 3;
  row.name = evil;
  row.cap_low = evil;
  r.labels = {row};
  r.stages = {{evil, 1, 1}};
  const std::string clean = page(TwoBoxes().scene(), plain_report()), html = page(boxes.scene(), r);
  const auto count = [](const std::string& text, const std::string& part) {
    int n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(html.find("<script>alert"), std::string::npos);
  EXPECT_EQ(html.find("<img src=x"), std::string::npos);
  EXPECT_EQ(count(html, "<script"), count(clean, "<script"));
  EXPECT_EQ(count(html, "</script"), count(clean, "</script"));
  EXPECT_GE(count(html, "&lt;script&gt;alert(1)&lt;/script&gt;"), 6);
  EXPECT_EQ(page_data(html)["meshes"][0]["pictures"]["labels"][3]["name"], evil);  // and it is all there
}

Verdict verdict(const char* title, Status status, bool validity = false) {
  Verdict v;
  v.id = title;
  v.title = title;
  v.figure = std::string("figure of ") + title;
  v.limit = std::string("limit of ") + title;
  v.explanation = std::string("explanation of ") + title;
  v.status = status;
  v.validity = validity;
  return v;
}

TEST(HtmlReport, SaysTheVerdictInWordsWithFiguresAndLimits) {
  const struct {
    std::vector<Verdict> verdicts;
    const char *word, *sentence;
  } cases[] = {{{verdict("Closed", Status::pass, true), verdict("Quality", Status::pass)},
                "PASS",
                "valid and inside every limit"},
               {{verdict("Closed", Status::pass, true), verdict("Quality", Status::warn)},
                "WARN",
                "Look before you use it at: Quality."},
               {{verdict("Closed", Status::pass, true), verdict("Quality", Status::fail)},
                "FAIL",
                "valid, but outside a limit: Quality."},
               {{verdict("Closed", Status::fail, true), verdict("Quality", Status::fail)},
                "FAIL",
                "is invalid and should not be used. What is wrong: Closed."}};
  for (const auto& c : cases) {
    RunReport r = plain_report();
    r.verdicts = c.verdicts;
    const std::string html = page(TwoBoxes().scene(), r);
    EXPECT_NE(html.find(std::string(">") + c.word + "<"), std::string::npos) << c.word;
    EXPECT_NE(html.find(c.sentence), std::string::npos) << c.sentence;
    for (const Verdict& v : c.verdicts)
      for (const std::string& part :
           {v.title, v.figure, v.limit, v.explanation, ">" + std::string(to_text(v.status)) + "<"})
        EXPECT_NE(html.find(part), std::string::npos) << part;
  }
}

TEST(HtmlReport, ListsDefectsWithTheirPlaceInThePicturesFrame) {
  for (const bool ras : {false, true}) {
    TwoBoxes boxes;
    RunReport r = plain_report();
    Defect d;
    d.kind = "self_intersection";
    d.where = {4, -5, 6};
    d.section = 11;
    d.text = "two <sheets> cross";
    r.defects = {d};
    if (ras) change_space(boxes.surface, Space::ras);
    HtmlScene scene = boxes.scene();
    const std::string html = page(scene, r);
    EXPECT_NE(html.find(ras ? "data-at=\"[-4,5,6]\"" : "data-at=\"[4,-5,6]\""), std::string::npos);
    EXPECT_NE(html.find("two &lt;sheets&gt; cross"), std::string::npos);
    EXPECT_NE(html.find("self intersection"), std::string::npos);
    EXPECT_EQ(page_data(html)["meshes"][0]["defects"][0]["at_mm"][1], ras ? 5 : -5);
    // turned back for the voxels
    for (const double distance : mesh(html, 0, "surface").distances_mm) EXPECT_LT(distance, 1e-3);
  }
}

TEST(HtmlReport, ComparesSeveralMeshesAndMarksTheBest) {
  const TwoBoxes boxes;
  RunReport good = plain_report(), bad = plain_report();
  good.surface->angle_min_deg = 30, bad.surface->angle_min_deg = 3;
  good.verdicts = {verdict("Quality", Status::pass)}, bad.verdicts = {verdict("Quality", Status::warn)};
  const HtmlPictures pictures = draw_pictures(boxes.scene());
  HtmlOptions without;
  without.labels = false;
  const HtmlPictures more = draw_pictures(boxes.scene(), without);
  const std::string html = to_html({{"a.vtu", &good, &pictures}, {"b<i>.stl", &bad, &more}});
  EXPECT_NE(html.find("<td class=\"best\">\xe2\x98\x85 30.00</td><td>3.00</td>"), std::string::npos);
  EXPECT_EQ(html.find("b<i>"), std::string::npos);
  const Json data = page_data(html);
  ASSERT_EQ(data["meshes"].size(), 2u);
  EXPECT_TRUE(data["meshes"][0]["pictures"].contains("slices"));
  EXPECT_FALSE(data["meshes"][1]["pictures"].contains("slices"));
  EXPECT_EQ(mesh(html, 1, "surface").elements.size(), boxes.surface.triangles.size());
}

TEST(HtmlReport, WithoutLabelsPlanesAreSpreadOverTheMesh) {
  InterfaceComplex b = box({1, 2, 3}, {4, 6, 9}, 2);
  b.space = Space::none;
  HtmlScene scene;
  scene.surface = &b;
  const std::string html = page(scene, plain_report());
  const Json pictures = page_data(html)["meshes"][0]["pictures"];
  ASSERT_EQ(pictures["planes"].size(), 60u);
  EXPECT_EQ(pictures["planes_are"], "planes");
  for (const std::size_t p : {0u, 30u, 59u})
    EXPECT_NEAR(area_of(lines(chunk(html, 0, pictures["cuts"], p), pictures["cuts"]["unit_mm"]), 1), 12, 0.05) << p;
}

TEST(HtmlReport, NamesThatAreNotUtf8DoNotBreakThePage) {
  RunReport r = plain_report("caf\xe9.nii.gz");
  r.warnings = {{WarningCode::other, "", "\xff\xfe"}};
  const std::string html = page(TwoBoxes().scene(), r);
  EXPECT_NE(html.find("caf\xef\xbf\xbd.nii.gz"), std::string::npos);
  EXPECT_EQ(html.find('\xff'), std::string::npos);
}

TEST(HtmlReport, ThePageAsksForNothingOutside) {
  const std::string html = page(TwoBoxes().scene(), plain_report());
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
  for (const char* part : {"src=\"http", "src='http", "href=\"http", "@import", "<iframe", "<link rel=\"stylesheet\""})
    EXPECT_EQ(html.find(part), std::string::npos) << part;
}

TEST(HtmlReport, TheSameBytesForAnyNumberOfThreads) {
  LabelVolume v = empty_volume(30, 30, 30, 3);
  std::mt19937 random(7);
  for (int n = 0; n < 60; ++n) {
    const int x = static_cast<int>(random() % 24), y = static_cast<int>(random() % 24),
              z = static_cast<int>(random() % 24);
    fill(v, {x, y, z}, {x + 5, y + 5, z + 5}, 1 + n % 3);
  }
  const InterfaceComplex surface = voxel_surface(v);
  HtmlScene scene;
  scene.surface = &surface;
  scene.volume = &v;
  HtmlOptions options;
  options.threads = 1;
  const std::string one = page(scene, plain_report(), options);
  for (const int threads : {2, 7}) {
    options.threads = threads;
    EXPECT_TRUE(page(scene, plain_report(), options) == one) << threads;
  }
}

/// Directed edges of a label's shell that no other one runs against.
std::size_t open_edges(const Mesh& m, int label) {
  std::map<std::pair<int, int>, int> sum;
  for (std::size_t t = 0; t < m.elements.size(); ++t) {
    const int sign = (m.labels[t][0] == label) - (m.labels[t][1] == label);
    for (int k = 0; k < 3; ++k) {
      const int a = m.elements[t][k], b = m.elements[t][(k + 1) % 3];
      sum[{std::min(a, b), std::max(a, b)}] += a < b ? sign : -sign;
    }
  }
  return std::count_if(sum.begin(), sum.end(), [](const auto& e) { return e.second != 0; });
}

TEST(HtmlReport, ABigSurfaceIsDecimatedAndKeepsItsWorstPlaceAndShape) {
  LabelVolume v = empty_volume(60, 60, 60, 1);
  fill(v, {10, 10, 10}, {49, 49, 49}, 1);
  InterfaceComplex sphere = icosphere(20, 7, 1, {29.5, 29.5, 29.5});  // 327,680 triangles
  const Vec3 worst = {29.5, 29.5, 29.5 + 20.9};
  for (Vec3& p : sphere.points)
    if (p.z > 29.5 + 19.998) p = worst;
  HtmlScene scene;
  scene.surface = &sphere;
  scene.volume = &v;
  HtmlOptions options;
  options.bytes_limit = 3600 * 1000;
  const std::string html = page(scene, plain_report(), options);
  const Json pictures = page_data(html)["meshes"][0]["pictures"];
  EXPECT_EQ(pictures["surface"]["cell_mm"], 0);
  EXPECT_EQ(pictures["surface"]["of"], sphere.triangles.size());
  const Mesh m = mesh(html, 0, "surface");
  EXPECT_LE(m.elements.size(), 110000u);
  EXPECT_GT(m.elements.size(), 50000u);
  EXPECT_NEAR(enclosed(m, 1), 4.0 / 3 * kPi * 8000, 0.001 * 33510);
  EXPECT_EQ(open_edges(m, 1), 0u);
  bool found = false;
  for (const auto& place : pictures["worst"])
    found = found || (place["kind"] == "angle" && std::abs(place["at_mm"][2].get<double>() - worst.z) < 1);
  EXPECT_TRUE(found);
  EXPECT_LT(*std::min_element(m.angles_deg.begin(), m.angles_deg.end()), 1);
  for (const auto& h : pictures["histograms"]) {
    if (h["name"] != "distances") continue;
    EXPECT_NEAR(*std::max_element(m.distances_mm.begin(), m.distances_mm.end()), h["largest"].get<double>(), 0.1);
  }
}

TEST(HtmlReport, DecimationOpensNothingBetweenLabels) {
  const int n = 56;
  LabelVolume v = empty_volume(n, n, n, 5);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(6, n - 6);
  std::array<Vec3, 5> seeds;
  for (Vec3& s : seeds) s = {place(random), place(random), place(random)};
  const Vec3 middle = {n / 2.0, n / 2.0, n / 2.0};
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const Vec3 p = {x + 0.5, y + 0.5, z + 0.5};
        if (norm(p - middle) > 0.45 * n) continue;
        std::size_t nearest = 0;
        for (std::size_t s = 1; s < seeds.size(); ++s)
          if (norm(p - seeds[s]) < norm(p - seeds[nearest])) nearest = s;
        v.voxels[v.index(x, y, z)] = static_cast<std::uint16_t>(nearest + 1);
      }
  const InterfaceComplex surface = voxel_surface(v);
  HtmlScene scene;
  scene.surface = &surface;
  scene.volume = &v;
  const Mesh full = mesh(page(scene, plain_report()), 0, "surface");
  ASSERT_EQ(full.elements.size(), surface.triangles.size());
  HtmlOptions options;
  options.bytes_limit = surface.triangles.size() * 20;
  const std::string html = page(scene, plain_report(), options);
  EXPECT_EQ(page_data(html)["meshes"][0]["pictures"]["surface"]["cell_mm"], 0);
  const Mesh m = mesh(html, 0, "surface");
  EXPECT_LT(m.elements.size(), 0.7 * static_cast<double>(full.elements.size()));
  for (int label = 1; label <= 5; ++label) {
    EXPECT_EQ(open_edges(m, label), open_edges(full, label)) << label;
    EXPECT_NEAR(enclosed(m, label), enclosed(full, label), 0.02 * enclosed(full, label)) << label;
  }
}

TEST(HtmlReport, ALimitOfBytesIsKept) {
  LabelVolume v = empty_volume(40, 40, 40, 5);
  std::mt19937 random(3);
  for (auto& voxel : v.voxels) voxel = static_cast<std::uint16_t>(random() % 6);  // noise: nothing packs worse
  const InterfaceComplex surface = voxel_surface(v);
  TetMesh tets;
  tets.points = surface.points;
  for (std::int32_t t = 0; t + 3 < static_cast<std::int32_t>(surface.points.size()); ++t) {
    tets.tets.push_back({t, t + 1, t + 2, t + 3});
    tets.labels.push_back(1 + t % 5);
  }
  HtmlScene scene;
  scene.surface = &surface;
  scene.mesh = &tets;
  scene.volume = &v;
  const HtmlOptions options;
  const HtmlPictures pictures = draw_pictures(scene, options);
  std::size_t bytes = pictures.json.size();
  for (const auto& [name, blob] : pictures.blobs) bytes += blob.size();
  EXPECT_LT(bytes, options.bytes_limit);
  HtmlOptions tight;
  tight.bytes_limit = 600 * 1000;
  const HtmlPictures small = draw_pictures(scene, tight);
  bytes = small.json.size();
  for (const auto& [name, blob] : small.blobs) bytes += blob.size();
  EXPECT_LT(bytes, tight.bytes_limit);
  EXPECT_GT(Json::parse(small.json)["tets"]["one_of"], 1);
}

TEST(HtmlReport, HistogramsCountEveryAngleAndEdge) {
  const TwoBoxes boxes;
  const Json pictures = page_data(page(boxes.scene(), plain_report()))["meshes"][0]["pictures"];
  for (const auto& h : pictures["histograms"]) {
    std::size_t sum = 0;
    for (const auto& c : h["counts"]) sum += c.get<std::size_t>();
    EXPECT_EQ(sum, h["values"]);
    if (h["name"] == "angles") {
      EXPECT_EQ(sum, 3 * boxes.surface.triangles.size());
      EXPECT_NEAR(h["largest"].get<double>(), 90, 1e-4);
    }
    // Euler: a closed surface of triangles with E edges has 2 E = 3 F; here the wall between the boxes shares edges.
    if (h["name"] == "edges") {
      EXPECT_LT(sum, 3 * boxes.surface.triangles.size() / 2 + 1);
    }
  }
}

TEST(HtmlReport, AnEmptyMeshStillMakesAPage) {
  const TwoBoxes boxes;
  InterfaceComplex nothing;
  nothing.space = Space::lps;
  HtmlScene scene = boxes.scene();
  scene.surface = &nothing;
  const std::string html = page(scene, plain_report());
  EXPECT_FALSE(page_data(html)["meshes"][0]["pictures"].contains("surface"));
}

}  // namespace
