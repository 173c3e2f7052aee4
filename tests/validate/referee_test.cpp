// Defects planted in a good mesh: each must be found, named and located; and perfect meshes of shapes with known
// figures.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>

#include "base/error.h"
#include "files.h"
#include "meshio/read_mesh.h"
#include "run/validate_run.h"
#include "shapes.h"

namespace stackmesh {
namespace {

using namespace test;

constexpr double kPi = 3.14159265358979323846;

/// An ellipsoid of label 1 with a ball of label 2 set into its side, and a second ball of label 2 apart; axes turned,
/// so that LPS and RAS differ.
LabelVolume phantom() {
  LabelVolume v = empty_volume(64, 52, 26, 2);
  v.spacing_mm = {1, 1, 2};
  v.origin_mm = {20, -70, 100};
  for (int k = 0; k < v.size[2]; ++k)
    for (int j = 0; j < v.size[1]; ++j)
      for (int i = 0; i < v.size[0]; ++i) {
        const double x = i - 22, y = j - 25, z = 2.0 * (k - 12.5);
        if (x * x / 289 + y * y / 361 + z * z / 324 < 1) v.voxels[v.index(i, j, k)] = 1;
        const double bx = i - 40, by = j - 25;
        if (bx * bx + by * by + z * z < 64) v.voxels[v.index(i, j, k)] = 2;
        const double cx = i - 56, cy = j - 42;
        if (cx * cx + cy * cy + z * z < 25) v.voxels[v.index(i, j, k)] = 2;
      }
  return v;
}

class Referee : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    labels_ = write_volume_file("phantom.nrrd", phantom());
    const std::string base = folder() + "/good";
    const std::string command =
        std::string(STACKMESH_PROGRAM) + " mesh " + labels_ + " --quiet -o " + base + ".vtu -o " + base + ".vtp";
    ASSERT_EQ(std::system(command.c_str()), 0);
    tets_ = tet_mesh_of(read_mesh(base + ".vtu"));
    const MeshFile s = read_mesh(base + ".vtp");
    surface_ = {s.points, s.triangles};
  }

  static ValidateRunOptions options(const std::string& mesh) {
    ValidateRunOptions o;
    o.meshes = {mesh};
    o.against.emplace();
    o.against->paths = {labels_};
    return o;
  }
  static RunReport judged(const ValidateRunOptions& o) {
    const auto progress = make_terminal_monitor(ProgressMode::none);
    return run_validate(o, *progress)[0];
  }
  static RunReport judged(const InterfaceComplex& surface, const std::string& name) {
    return judged(options(write_mesh_file(name, surface)));
  }
  static RunReport judged(const TetMesh& mesh, const std::string& name) {
    return judged(options(write_mesh_file(name, mesh)));
  }

  static const Verdict& verdict(const RunReport& r, const std::string& id) {
    static const Verdict none;
    for (const Verdict& v : r.verdicts)
      if (v.id == id) return v;
    ADD_FAILURE() << "no verdict " << id;
    return none;
  }
  /// Ids of the verdicts that fail.
  static std::set<std::string> failing(const RunReport& r) {
    std::set<std::string> ids;
    for (const Verdict& v : r.verdicts)
      if (v.status == Status::fail) ids.insert(v.id);
    return ids;
  }
  static std::vector<Defect> defects(const RunReport& r, const std::string& kind) {
    std::vector<Defect> found;
    for (const Defect& d : r.defects)
      if (d.kind == kind) found.push_back(d);
    return found;
  }
  static Vec3 middle(const InterfaceComplex& c, std::size_t t) {
    const auto& v = c.triangles[t].v;
    return (1.0 / 3) * (c.points[v[0]] + c.points[v[1]] + c.points[v[2]]);
  }
  static int section_of(const Vec3& p) { return static_cast<int>(std::lround((p.z - 100) / 2)); }
  static void expect_near(const Vec3& a, const Vec3& b, double tolerance) {
    EXPECT_LT(norm(a - b), tolerance) << a.x << " " << a.y << " " << a.z;
  }

  /// A triangle of label 1 towards the background.
  static std::size_t some_triangle() {
    for (std::size_t t = surface_.triangles.size() / 3; t < surface_.triangles.size(); ++t)
      if (surface_.triangles[t].below == 1 && surface_.triangles[t].above == 0) return t;
    return 0;
  }

  static std::string labels_;
  static TetMesh tets_;
  static InterfaceComplex surface_;
};
std::string Referee::labels_;
TetMesh Referee::tets_;
InterfaceComplex Referee::surface_;

TEST_F(Referee, PassesAGoodMesh) {
  for (const RunReport& r : {judged(tets_, "ok.vtu"), judged(surface_, "ok.vtp")}) {
    EXPECT_EQ(exit_code(r.verdicts), 0);
    for (const char* id : {"closed", "intersections", "components", "position", "fidelity"})
      EXPECT_EQ(verdict(r, id).status, Status::pass) << id << ": " << verdict(r, id).figure;
    ASSERT_EQ(r.labels.size(), 2u);
    EXPECT_EQ(r.labels[1].components, 2);
    EXPECT_EQ(r.labels[0].genus, 0);
    EXPECT_EQ(r.labels[1].genus, 0);
    for (const Defect& d : r.defects) EXPECT_EQ(d.kind.rfind("poor_", 0), 0u) << d.text;
  }
}

TEST_F(Referee, FindsAHoleOfOneTriangle) {
  InterfaceComplex c = surface_;
  const std::size_t t = some_triangle();
  const Vec3 where = middle(c, t);
  c.triangles.erase(c.triangles.begin() + static_cast<std::ptrdiff_t>(t));
  const RunReport r = judged(c, "hole.vtp");
  EXPECT_EQ(exit_code(r.verdicts), 4);
  EXPECT_EQ(verdict(r, "closed").status, Status::fail);
  EXPECT_EQ(verdict(r, "closed").figure, "3 open edges");
  EXPECT_EQ(verdict(r, "closed").labels, std::vector<Label>{1});
  const auto holes = defects(r, "hole");
  ASSERT_EQ(holes.size(), 1u);
  EXPECT_EQ(holes[0].count, 3u);
  EXPECT_EQ(holes[0].label, 1);
  expect_near(holes[0].where, where, 1.5);
  EXPECT_NEAR(*holes[0].section, section_of(where), 1);
}

TEST_F(Referee, FindsAFlippedTriangle) {
  InterfaceComplex c = surface_;
  const std::size_t t = some_triangle();
  std::swap(c.triangles[t].v[1], c.triangles[t].v[2]);
  const Vec3 where = middle(c, t);
  const RunReport r = judged(c, "flipped.vtp");
  EXPECT_EQ(exit_code(r.verdicts), 4);
  const auto flipped = defects(r, "flipped_triangle");
  ASSERT_EQ(flipped.size(), 1u);
  expect_near(flipped[0].where, where, 1e-3);
  EXPECT_EQ(*flipped[0].section, section_of(where));
  EXPECT_TRUE(defects(r, "hole").empty());
}

TEST_F(Referee, FindsTwoCrossingSheets) {
  InterfaceComplex c = surface_;
  // A small closed tetrahedron that sticks through the wall of label 1.
  const std::size_t t = some_triangle();
  const Vec3 where = middle(c, t);
  const std::int32_t n = static_cast<std::int32_t>(c.points.size());
  for (const Vec3& p : {Vec3{-3, -3, -3}, Vec3{3, -2, -3}, Vec3{0, 3, -3}, Vec3{0.1, 0.2, 3}})
    c.points.push_back(where + p);
  for (const auto& v : {std::array<std::int32_t, 3>{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}})
    c.triangles.push_back({{n + v[0], n + v[1], n + v[2]}, 1, 0});
  const RunReport r = judged(c, "crossing.vtp");
  EXPECT_EQ(exit_code(r.verdicts), 4);
  EXPECT_EQ(verdict(r, "closed").status, Status::pass);
  EXPECT_EQ(verdict(r, "intersections").status, Status::fail);
  const auto crossings = defects(r, "self_intersection");
  ASSERT_EQ(crossings.size(), 1u);
  EXPECT_GE(crossings[0].count, 3u);
  expect_near(crossings[0].where, where, 4);
}

TEST_F(Referee, FindsOneInvertedTetWhetherRenumberedOrMoved) {
  TetMesh mesh = tets_;
  const std::size_t t = mesh.tets.size() / 2;
  std::swap(mesh.tets[t][0], mesh.tets[t][1]);
  const RunReport r = judged(mesh, "inverted.vtu");
  EXPECT_EQ(exit_code(r.verdicts), 4);
  EXPECT_EQ(r.volume->inverted, 1u);
  EXPECT_EQ(failing(r).count("orientation"), 1u);
  EXPECT_EQ(verdict(r, "closed").status, Status::pass);
  auto inverted = defects(r, "inverted_tet");
  ASSERT_EQ(inverted.size(), 1u);
  Vec3 where;
  for (const std::int32_t v : tets_.tets[t]) where = where + 0.25 * tets_.points[v];
  expect_near(inverted[0].where, where, 1e-9);
  EXPECT_EQ(inverted[0].label, tets_.labels[t]);

  // An inner point pushed through the far face of one of its tets.
  std::vector<char> outer(tets_.points.size(), 0);
  for (const InterfaceTriangle& f : tets_.faces)
    for (const std::int32_t v : f.v) outer[v] = 1;
  mesh = tets_;
  for (const auto& tet : mesh.tets)
    if (!outer[tet[0]]) {
      const Vec3 far = (1.0 / 3) * (mesh.points[tet[1]] + mesh.points[tet[2]] + mesh.points[tet[3]]);
      where = mesh.points[tet[0]];
      mesh.points[tet[0]] = mesh.points[tet[0]] + 1.5 * (far - mesh.points[tet[0]]);
      break;
    }
  const RunReport moved = judged(mesh, "moved.vtu");
  EXPECT_EQ(exit_code(moved.verdicts), 4);
  inverted = defects(moved, "inverted_tet");
  ASSERT_FALSE(inverted.empty());
  for (const Defect& d : inverted) expect_near(d.where, where, 15);
}

TEST_F(Referee, FindsALostComponent) {
  InterfaceComplex c = surface_;
  const Vec3 ball = {20 + 56, -70 + 42, 100 + 25};
  const auto far = [&](const InterfaceTriangle& t) { return norm(c.points[t.v[0]] - ball) < 8; };
  c.triangles.erase(std::remove_if(c.triangles.begin(), c.triangles.end(), far), c.triangles.end());
  const RunReport r = judged(c, "lost.vtp");
  EXPECT_EQ(exit_code(r.verdicts), 6);
  EXPECT_EQ(verdict(r, "components").status, Status::fail);
  EXPECT_EQ(verdict(r, "components").figure, "1 of 3 components missing");
  EXPECT_EQ(verdict(r, "closed").status, Status::pass);
  const auto lost = defects(r, "missing_component");
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_EQ(lost[0].label, 2);
  expect_near(lost[0].where, ball, 0.5);
  EXPECT_NEAR(*lost[0].section, 12.5, 0.6);
}

TEST_F(Referee, FindsAShiftOfOnePixelAlongAnyAxis) {
  for (int axis = 0; axis < 3; ++axis) {
    InterfaceComplex c = surface_;
    const Vec3 by = axis == 0 ? Vec3{1, 0, 0} : axis == 1 ? Vec3{0, -1, 0} : Vec3{0, 0, 2};
    for (Vec3& p : c.points) p = p + by;
    const RunReport r = judged(c, "shift" + std::to_string(axis) + ".vtp");
    EXPECT_EQ(exit_code(r.verdicts), 6);
    EXPECT_EQ(verdict(r, "position").status, Status::fail) << verdict(r, "position").figure;
    double told[3];
    ASSERT_EQ(
        std::sscanf(verdict(r, "position").figure.c_str(), "shifted by (%lf, %lf, %lf)", &told[0], &told[1], &told[2]),
        3);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(told[k], k == axis ? (axis == 1 ? -1 : 1) : 0, 0.15) << axis << ": " << verdict(r, "position").figure;
  }
}

TEST_F(Referee, FindsSwappedLabels) {
  InterfaceComplex c = surface_;
  for (InterfaceTriangle& t : c.triangles)
    for (Label* l : {&t.below, &t.above})
      if (*l != 0) *l = 3 - *l;
  const RunReport r = judged(c, "swapped.vtp");
  EXPECT_EQ(exit_code(r.verdicts), 6);
  const auto swapped = defects(r, "swapped_label");
  ASSERT_EQ(swapped.size(), 2u);
  for (const Defect& d : swapped) {
    EXPECT_NE(d.text.find("label " + std::to_string(d.label) + " of the mesh lies where label " +
                          std::to_string(3 - d.label)),
              std::string::npos)
        << d.text;
    if (d.label == 2) expect_near(d.where, {20 + 21, -70 + 25, 100 + 25}, 3);  // label 2 now holds the ellipsoid
  }
}

TEST_F(Referee, FindsLpsTakenForRasAndTellsTheFrameWhenTheFileDoesNot) {
  InterfaceComplex ras = surface_;
  for (Vec3& p : ras.points) p.x = -p.x, p.y = -p.y;
  // Wrongly marked.
  const std::string wrong = write_mesh_file("wrong.vtp", ras, "lps");
  try {
    const RunReport r = judged(options(wrong));
    EXPECT_EQ(exit_code(r.verdicts), 6);
    EXPECT_EQ(verdict(r, "frame").status, Status::fail);
    ASSERT_EQ(defects(r, "wrong_frame").size(), 1u);
    EXPECT_NE(defects(r, "wrong_frame")[0].text.find("as RAS it would fit"), std::string::npos);
  } catch (const Error& e) {
    FAIL() << e.what();
  }
  // Rightly marked, unmarked, told.
  for (const char* space : {"ras", "none"}) {
    const RunReport r = judged(options(write_mesh_file(std::string("right_") + space + ".vtp", ras, space)));
    EXPECT_EQ(exit_code(r.verdicts), 0);
    EXPECT_EQ(r.mesh->space, "ras");
    EXPECT_NE(r.mesh->space_reason.find(*space == 'r' ? "the file tells RAS" : "overlap with the labels"),
              std::string::npos)
        << r.mesh->space_reason;
  }
  ValidateRunOptions o = options(wrong);
  o.mesh_space = "ras";
  EXPECT_EQ(exit_code(judged(o).verdicts), 0);
}

TEST_F(Referee, AMirroredFrameIsNotInverted) {
  LabelVolume v = phantom();
  v.axes[0] = {-1, 0, 0};  // left-handed
  v.origin_mm = {20 + 63, -70, 100};
  for (int k = 0; k < v.size[2]; ++k)
    for (int j = 0; j < v.size[1]; ++j)
      std::reverse(v.voxels.begin() + static_cast<std::ptrdiff_t>(v.index(0, j, k)),
                   v.voxels.begin() + static_cast<std::ptrdiff_t>(v.index(0, j, k)) + v.size[0]);
  ValidateRunOptions o = options(folder() + "/good.vtu");
  o.against->paths = {write_volume_file("mirrored.nrrd", v)};
  EXPECT_EQ(exit_code(judged(o).verdicts), 0);

  TetMesh other = tets_;  // a program that numbers nodes the other way
  for (auto& t : other.tets) std::swap(t[0], t[1]);
  for (InterfaceTriangle& t : other.faces) std::swap(t.v[0], t.v[1]);
  std::swap(other.tets[7][0], other.tets[7][1]);  // but for one
  const RunReport r = judged(other, "left.vtu");
  EXPECT_EQ(r.volume->inverted, 1u);
  EXPECT_LE(r.volume->nonconforming_faces, 4u);  // its own
  EXPECT_EQ(r.surface->open_edges, 0u);
}

TEST_F(Referee, ASurfaceWithoutLabelsFindsItsOwn) {
  InterfaceComplex one;
  one.points = surface_.points;
  for (const InterfaceTriangle& t : surface_.triangles) {
    if (t.below == 1) one.triangles.push_back({t.v, 1, 0});
    if (t.above == 1) one.triangles.push_back({{t.v[0], t.v[2], t.v[1]}, 1, 0});
  }
  RunReport r = judged(one, "one.off");
  EXPECT_EQ(exit_code(r.verdicts), 0);
  ASSERT_EQ(r.labels.size(), 1u);
  EXPECT_EQ(r.labels[0].label, 1);
  EXPECT_NE(r.mesh->labels.find("fits label 1 best"), std::string::npos) << r.mesh->labels;

  one.triangles.clear();  // the outline of both together
  for (const InterfaceTriangle& t : surface_.triangles)
    if (t.below == 0 || t.above == 0) one.triangles.push_back({t.v, t.below ? 1 : 0, t.above ? 1 : 0});
  for (InterfaceTriangle& t : one.triangles)
    if (t.below == 0) std::swap(t.v[0], t.v[1]), std::swap(t.below, t.above);
  r = judged(one, "all.off");
  EXPECT_EQ(exit_code(r.verdicts), 0);
  EXPECT_NE(r.mesh->labels.find("all labels together"), std::string::npos) << r.mesh->labels;
  ASSERT_EQ(r.labels.size(), 1u);
  EXPECT_GT(*r.labels[0].dice, 0.98);

  ValidateRunOptions o = options(folder() + "/one.off");
  o.against->labels = "2";
  try {
    EXPECT_EQ(exit_code(judged(o).verdicts), 6);  // told a wrong one
  } catch (const Error& e) {                      // in which not one voxel centre of it lies
    EXPECT_NE(std::string(e.what()).find("do not overlap"), std::string::npos) << e.what();
  }
}

TEST_F(Referee, OtherNumbersAreMatchedByOverlapAndSaid) {
  TetMesh mesh = tets_;
  for (Label& l : mesh.labels) l += 40;
  mesh.faces = faces_of_tets(mesh);
  const RunReport r = judged(mesh, "numbers.msh");
  EXPECT_EQ(exit_code(r.verdicts), 0);
  EXPECT_TRUE(std::any_of(r.warnings.begin(), r.warnings.end(), [](const Warning& w) {
    return w.text.find("41 as 1") != std::string::npos && w.text.find("42 as 2") != std::string::npos;
  }));
}

TEST_F(Referee, MeshesSideBySideAndWithoutLabels) {
  InterfaceComplex worse = surface_;
  for (Vec3& p : worse.points) p = p + Vec3{0.3, 0, 0};
  ValidateRunOptions o = options(folder() + "/good.vtp");
  o.meshes.push_back(write_mesh_file("worse.vtp", worse));
  const auto progress = make_terminal_monitor(ProgressMode::none);
  const std::vector<RunReport> reports = run_validate(o, *progress);
  ASSERT_EQ(reports.size(), 2u);
  EXPECT_LT(reports[0].labels[0].distance_mm->mean, reports[1].labels[0].distance_mm->mean);

  o.against.reset();
  const std::vector<RunReport> alone = run_validate(o, *progress);
  EXPECT_FALSE(alone[0].labels[0].dice);
  EXPECT_EQ(exit_code(alone[0].verdicts), 0);
}

TEST_F(Referee, MeshElsewhereIsOneClearErrorWithTheLikelyReason) {
  const auto error = [&](const std::string& path) {
    try {
      judged(options(path));
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::input);
      return std::string(e.what());
    }
    return std::string("none");
  };
  InterfaceComplex c = surface_;
  for (Vec3& p : c.points) p = p + Vec3{5000, 0, 0};
  EXPECT_NE(error(write_mesh_file("far.vtp", c, "none")).find("do not overlap (neither as LPS nor as RAS)"),
            std::string::npos);
  c = surface_;
  for (Vec3& p : c.points) p = 1e-3 * p;
  EXPECT_NE(error(write_mesh_file("metres.vtp", c, "none")).find("it would fit in metres"), std::string::npos);
}

// ---- perfect meshes

RunReport judge_perfect(const LabelVolume& volume, const InterfaceComplex& surface, const std::string& name) {
  ValidateRunOptions o;
  o.meshes = {write_mesh_file(name + ".vtp", surface)};
  o.against.emplace();
  o.against->paths = {write_volume_file(name + ".nrrd", volume)};
  const auto progress = make_terminal_monitor(ProgressMode::none);
  return run_validate(o, *progress)[0];
}

TEST(PerfectMesh, ABoxOnVoxelFacesIsExact) {
  LabelVolume v = empty_volume(30, 24, 20, 1);
  v.spacing_mm = {1, 1, 1};
  fill(v, {5, 6, 4}, {25, 18, 14}, 1);  // 20 x 12 x 10
  const RunReport r = judge_perfect(v, box({4.5, 5.5, 3.5}, {24.5, 17.5, 13.5}, 1), "box");
  const LabelReport& l = r.labels[0];
  EXPECT_DOUBLE_EQ(l.surface_volume_mm3, 2400);
  EXPECT_DOUBLE_EQ(*l.input_volume_mm3, 2400);
  EXPECT_DOUBLE_EQ(l.surface_area_mm2, 2 * (240 + 200 + 120));
  EXPECT_EQ(*l.dice, 1);
  EXPECT_LT(l.distance_mm->max, 1e-6);
  EXPECT_LT(l.reverse_distance_mm->max, 1e-6);
  EXPECT_EQ(l.euler, 2);
  EXPECT_EQ(*l.genus, 0);
  EXPECT_NEAR(r.surface->angle_min_deg, std::atan(0.5) * 180 / kPi, 1e-9);  // the 20 x 10 side
  EXPECT_NEAR(l.angle_min_deg, std::atan(0.5) * 180 / kPi, 1e-9);
  EXPECT_NEAR(*l.thickness_p5_mm, 10, 1e-9);
  EXPECT_EQ(exit_code(r.verdicts), 0);
}

TEST(PerfectMesh, ASphereHasItsFigures) {
  LabelVolume v = empty_volume(56, 56, 56, 1);
  v.spacing_mm = {1, 1, 1};
  const Vec3 centre = {27.3, 27.9, 28.2};
  const double radius = 20;
  for (int k = 0; k < 56; ++k)
    for (int j = 0; j < 56; ++j)
      for (int i = 0; i < 56; ++i)
        if (norm(Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)} - centre) < radius)
          v.voxels[v.index(i, j, k)] = 1;
  const RunReport r = judge_perfect(v, icosphere(radius, 5, 1, centre), "sphere");
  const LabelReport& l = r.labels[0];
  const double volume = 4.0 / 3 * kPi * radius * radius * radius;
  EXPECT_NEAR(l.surface_volume_mm3, volume, 2e-3 * volume);  // 20480 flat triangles lie inside
  EXPECT_LT(l.surface_volume_mm3, volume);
  EXPECT_NEAR(l.surface_area_mm2, 4 * kPi * radius * radius, 2e-3 * 4 * kPi * radius * radius);
  EXPECT_GT(*l.dice, 0.999);  // centres decide: only those between the sphere and its triangles differ
  // a voxel face lies up to half a voxel's diagonal off, by half that on average
  EXPECT_LT(l.distance_mm->mean, 0.35);
  EXPECT_GT(l.distance_mm->mean, 0.15);
  EXPECT_LT(l.distance_mm->max, std::sqrt(3.0) / 2 + 0.05);
  EXPECT_LT(l.reverse_distance_mm->max, 0.9);
  EXPECT_GT(l.angle_min_deg, 40);
  EXPECT_EQ(*l.genus, 0);
  EXPECT_NEAR(*l.thickness_p5_mm, 2 * radius, 0.2);
  for (const Verdict& verdict : r.verdicts)
    EXPECT_EQ(verdict.status, Status::pass) << verdict.title << ": " << verdict.figure;
}

TEST(PerfectMesh, AFrameAndATouchingPairHaveTheirGenus) {
  LabelVolume v = empty_volume(9, 9, 5, 1);
  fill(v, {1, 1, 1}, {8, 8, 4}, 1);
  fill(v, {3, 3, 1}, {6, 6, 4}, 0);  // a square ring
  EXPECT_EQ(*judge_perfect(v, voxel_surface(v), "ring").labels[0].genus, 1);
  LabelVolume w = empty_volume(6, 6, 6, 1);
  fill(w, {1, 1, 1}, {3, 3, 3}, 1);
  fill(w, {3, 3, 3}, {5, 5, 5}, 1);  // two cubes that touch at a corner
  const RunReport r = judge_perfect(w, voxel_surface(w), "corner");
  EXPECT_EQ(*r.labels[0].genus, 0);
  EXPECT_EQ(r.labels[0].euler, 3);
  EXPECT_EQ(r.labels[0].components, 2);
}

}  // namespace
}  // namespace stackmesh
