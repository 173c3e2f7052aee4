// Labels and contours in memory to a checked mesh in memory, without files.
#include "mesh/mesh.h"

#include <dirent.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <thread>

#include "checks.h"

using namespace stackmesh;

namespace {

/// Two balls that touch, one in a shell: labels 3, 5 and 9 in 24 x 24 x 24 voxels.
LabelVolume balls() {
  const int n = 24;
  std::vector<Label> labels;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const double r = std::hypot(i - 8.0, j - 11.5, k - 11.5), s = std::hypot(i - 18.0, j - 11.5, k - 11.5);
        labels.push_back(r < 4 ? 3 : r < 7 ? 5 : s < 4.5 ? 9 : 0);
      }
  LabelVolume v = volume_of_labels(labels, {n, n, n}, {1, 1, 1.25});
  v.origin_mm = {-30, 12, 100};
  return v;
}

MeshOptions coarse() {
  MeshOptions o;
  o.enhancement.edge_length_mm = 2;
  o.enhancement.usual_target = false;
  o.fill.worker_path = STACKMESH_WORKER;
  return o;
}

std::map<Label, double> tet_volumes(const TetMesh& m) {
  std::map<Label, double> mm3;
  for (std::size_t t = 0; t < m.tets.size(); ++t) {
    const auto& v = m.tets[t];
    mm3[m.labels[t]] +=
        dot(m.points[v[1]] - m.points[v[0]], cross(m.points[v[2]] - m.points[v[0]], m.points[v[3]] - m.points[v[0]])) /
        6;
  }
  return mm3;
}

bool same(const InterfaceComplex& a, const InterfaceComplex& b) {
  return a.points.size() == b.points.size() && a.triangles.size() == b.triangles.size() &&
         std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof(Vec3)) == 0;
}

bool same(const LabelMesh& a, const LabelMesh& b) {
  return same(a.surface, b.surface) && a.tets && b.tets && a.tets->tets == b.tets->tets &&
         a.tets->points.size() == b.tets->points.size() &&
         std::memcmp(a.tets->points.data(), b.tets->points.data(), a.tets->points.size() * sizeof(Vec3)) == 0;
}

/// Children of this process that are stackmesh's workers.
int workers() {
  int found = 0;
  DIR* proc = opendir("/proc");
  while (const dirent* e = readdir(proc)) {
    if (std::strspn(e->d_name, "0123456789") != std::strlen(e->d_name)) continue;
    std::ifstream stat(std::string("/proc/") + e->d_name + "/stat");
    std::string text((std::istreambuf_iterator<char>(stat)), {});
    const std::size_t end = text.rfind(')');
    if (end == std::string::npos) continue;
    char state = 0;
    int parent = 0;
    std::sscanf(text.c_str() + end + 1, " %c %d", &state, &parent);
    found += parent == getpid();
  }
  closedir(proc);
  return found;
}

TEST(MeshLabels, FillsEveryLabelWithItsVolumeWhereItLies) {
  const LabelVolume labels = balls();
  const LabelMesh m = mesh_labels(labels, coarse());
  ASSERT_TRUE(m.tets);
  EXPECT_EQ(m.closure, Closure::verified);
  EXPECT_EQ(m.level, SurfaceLevel::enhanced);
  ASSERT_EQ(m.labels.size(), 3u);
  EXPECT_EQ(m.labels[2].number, 9);
  EXPECT_EQ(m.surface_check.open_edges, 0u);
  EXPECT_EQ(m.surface_check.self_intersections, 0u);
  EXPECT_TRUE(m.tets_check->conforms);
  EXPECT_EQ(m.contours.sections, 24u);
  const std::map<Label, double> mm3 = tet_volumes(*m.tets);
  ASSERT_EQ(mm3.size(), 3u);
  for (const auto& [label, volume] : mm3)
    EXPECT_NEAR(volume, m.input_volume_mm3.at(label), 0.005 * m.input_volume_mm3.at(label)) << "label " << label;
  Vec3 low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
  for (const Vec3& p : m.tets->points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  EXPECT_NEAR(low.x, -30 + 1, 0.8);  // the ball of radius 7 about x = 8
  EXPECT_NEAR(high.x, -30 + 22.5, 0.8);
  EXPECT_NEAR(low.z, 100 + 1.25 * 4.5, 1);
}

TEST(MeshLabels, GivesTheSameWhateverTheThreadsAndHoweverTheVolumeIsHandedOver) {
  MeshOptions o = coarse();
  o.threads = 1;
  const LabelMesh one = mesh_labels(balls(), o);
  o.threads = 2;
  const LabelVolume kept = balls();
  EXPECT_TRUE(same(one, mesh_labels(kept, o)));
  EXPECT_FALSE(kept.voxels.empty());
  LabelVolume given = balls();
  EXPECT_TRUE(same(one, mesh_labels(std::move(given), o)));
  EXPECT_TRUE(given.voxels.empty());  // NOLINT: the memory is given back early
}

TEST(MeshLabels, RunsTwiceAtOnce) {
  const LabelMesh alone = mesh_labels(balls(), coarse());
  LabelMesh a, b;
  std::thread other([&] { a = mesh_labels(balls(), coarse()); });
  b = mesh_labels(balls(), coarse());
  other.join();
  EXPECT_TRUE(same(alone, a));
  EXPECT_TRUE(same(alone, b));
}

TEST(MeshLabels, LeavesVoidsEmptyAndNamesTheWalls) {
  MeshOptions o = coarse();
  o.voids = {3};
  const LabelMesh m = mesh_labels(balls(), o);
  ASSERT_TRUE(m.tets);
  const std::map<Label, double> mm3 = tet_volumes(*m.tets);
  EXPECT_EQ(mm3.count(3), 0u);
  EXPECT_NEAR(mm3.at(5), m.input_volume_mm3.at(5), 0.005 * m.input_volume_mm3.at(5));
  ASSERT_EQ(m.behind.size(), m.tets->faces.size());
  EXPECT_GT(std::count(m.behind.begin(), m.behind.end(), 3), 50);
}

TEST(MeshLabels, GoesToTheSurfaceAlone) {
  MeshOptions o = coarse();
  o.target = Target::surface;
  o.fill.worker_path = "/nonexistent";  // nothing is filled
  const LabelMesh m = mesh_labels(balls(), o);
  EXPECT_FALSE(m.tets);
  EXPECT_EQ(m.closure, Closure::skipped);
  EXPECT_GT(m.surface.triangles.size(), 500u);
}

TEST(MeshLabels, MakesTenNodesAndRefines) {
  MeshOptions o = coarse();
  const std::size_t tets = mesh_labels(balls(), o).tets->tets.size();
  o.order = 2;
  o.refine = 1;
  const LabelMesh m = mesh_labels(balls(), o);
  EXPECT_EQ(m.tets->tets.size(), 8 * tets);
  EXPECT_EQ(m.tets->mid.size(), m.tets->tets.size());
}

TEST(MeshLabels, LeavesSmallPiecesOutAndShowsTheLabelsItUsed) {
  LabelVolume v = balls();
  v.voxels[v.index(1, 1, 1)] = 1;  // a crumb of label 3
  MeshOptions o = coarse();
  o.pieces.keep_largest = 1;
  o.keep_judged = true;
  const LabelMesh m = mesh_labels(v, o);
  ASSERT_TRUE(m.changed_labels);
  EXPECT_EQ(m.changed_labels->voxels[v.index(1, 1, 1)], 0);
  for (const LabelSurface& l : m.surface_check.labels) EXPECT_EQ(l.components, 1) << l.label;
  ASSERT_FALSE(m.warnings.empty());
  EXPECT_NE(m.warnings[0].text.find("left out"), std::string::npos);
  EXPECT_EQ(m.warnings[0].code, WarningCode::pieces_left_out);
  EXPECT_EQ(m.warnings[0].where.rfind("label ", 0), 0u);
}

TEST(MeshLabels, TellsHowFarItCameWhereNothingIsFilled) {
  MeshOptions o = coarse();
  o.fill.timeout_s = 1e-6;
  try {
    mesh_labels(balls(), o);
    FAIL() << "no time, and yet a mesh";
  } catch (const MeshRefused& e) {
    EXPECT_EQ(e.kind(), ErrorKind::no_result);
    EXPECT_NE(e.problem().find("did not fill"), std::string::npos) << e.what();
    EXPECT_NE(e.mend().find("longer"), std::string::npos) << e.what();
    EXPECT_EQ(e.partial->closure, Closure::failed);
    EXPECT_FALSE(e.partial->tets);
    EXPECT_GT(e.partial->surface.triangles.size(), 500u);
  }
}

/// Cancels as soon as a stage of that name has run for a moment.
struct Canceller : Monitor {
  explicit Canceller(std::string at) : at_(std::move(at)) {}
  void begin(const std::string& stage) override {
    if (stage == at_ && !since_.load()) since_ = now();
  }
  bool cancelled() const override { return since_.load() != 0 && now() - since_.load() > 20'000'000; }
  static long now() { return std::chrono::steady_clock::now().time_since_epoch().count(); }
  double late_s() const { return 1e-9 * static_cast<double>(now() - since_.load()); }
  std::string at_;
  std::atomic<long> since_{0};
};

TEST(MeshLabels, EndsSoonAfterItIsCancelledAndLeavesNoWorker) {
  const int n = 56;  // long enough in each stage
  std::vector<Label> labels;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        labels.push_back(std::hypot(i - 27.5, j - 27.5, k - 27.5) < 26 ? 1 + (i / 16 + j / 16 + k / 16) % 2 : 0);
  const LabelVolume v = volume_of_labels(labels, {n, n, n}, {1, 1, 1});
  for (const char* stage : {"contours", "stitch", "enhance", "volume"}) {
    MeshOptions o;
    o.enhancement.edge_length_mm = 1.2;
    o.fill.worker_path = STACKMESH_WORKER;
    Canceller canceller(stage);
    try {
      mesh_labels(v, o, canceller);
      ADD_FAILURE() << stage << ": it went on to the end";
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::cancelled) << e.what();
    }
    RecordProperty(std::string("late_ms_") + stage, static_cast<int>(1e3 * canceller.late_s()));
    EXPECT_LT(canceller.late_s(), 2.5) << stage;  // half a second is usual; the machine may be busy
    EXPECT_EQ(workers(), 0) << stage;
  }
}

TEST(MeshLabels, RefusesWhatIsNoVolumeInOneLine) {
  const auto refusal = [](const std::function<void(LabelVolume&)>& spoil) {
    LabelVolume v = balls();
    spoil(v);
    try {
      mesh_labels(v, coarse());
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::input) << e.what();
      EXPECT_FALSE(e.problem().empty());
      EXPECT_FALSE(e.mend().empty());
      return std::string(e.what());
    }
    return std::string("it was meshed");
  };
  EXPECT_NE(refusal([](LabelVolume& v) { v.voxels.pop_back(); }).find("voxels for a size"), std::string::npos);
  EXPECT_NE(refusal([](LabelVolume& v) { v.size = {0, 0, 0}; }).find("no voxels along x"), std::string::npos);
  EXPECT_NE(refusal([](LabelVolume& v) { v.voxels[0] = 7; }).find("index 7"), std::string::npos);
  EXPECT_NE(refusal([](LabelVolume& v) { v.spacing_mm[1] = -1; }).find("spacing"), std::string::npos);
  EXPECT_NE(refusal([](LabelVolume& v) { v.axes[1] = v.axes[0]; }).find("orthonormal"), std::string::npos);
  EXPECT_NE(refusal([](LabelVolume& v) { std::swap(v.labels[1], v.labels[2]); }).find("does not follow"),
            std::string::npos);
  EXPECT_NE(refusal([](LabelVolume& v) { v.labels[0].number = 1; }).find("background"), std::string::npos);
  EXPECT_NE(refusal([](LabelVolume& v) { v.voxels.assign(v.voxels.size(), 0); }).find("no label"), std::string::npos);
  EXPECT_NE(refusal([](LabelVolume& v) { v.origin_mm.x = std::nan(""); }).find("origin"), std::string::npos);
  EXPECT_THROW(volume_of_labels({0, -1}, {2, 1, 1}, {1, 1, 1}), Error);
  EXPECT_THROW(volume_of_labels({0, 1}, {3, 1, 1}, {1, 1, 1}), Error);
}

TEST(MeshContours, FillsDrawnLabelsExactly) {
  LabelContours box;
  box.label = 4;
  box.name = "box";
  for (const double z : {0.0, 2.0, 4.0, 6.0}) box.sections.push_back({z, {{{{0, 0}, {10, 0}, {10, 8}, {0, 8}}}}});
  MeshOptions o;
  o.fill.worker_path = STACKMESH_WORKER;
  o.stitch.caps = Caps::flat;
  const LabelMesh m = mesh_contours({box}, o);
  ASSERT_TRUE(m.tets);
  EXPECT_EQ(m.labels.at(0).name, "box");
  EXPECT_NEAR(tet_volumes(*m.tets).at(4), 10 * 8 * 6, 1e-6);
  ContourStackOptions slices;
  slices.slices = true;  // each contour stands for a slice, which reaches half a gap to either side
  EXPECT_NEAR(tet_volumes(*mesh_contours({box}, o, slices).tets).at(4), 10 * 8 * 8, 1e-6);
}

TEST(MeshContours, TwoSectionsOfOneLabelAtAboutTheSameHeightAreOne) {
  LabelContours both;
  both.label = 1;
  for (const double z : {0.0, 2.0, 4.0}) {
    both.sections.push_back({z, {{{{0, 0}, {10, 0}, {10, 10}, {0, 10}}}}});
    // the second piece, listed on its own
    both.sections.push_back({z + 5e-4, {{{{20, 0}, {30, 0}, {30, 10}, {20, 10}}}}});
  }
  MeshOptions o;
  o.fill.worker_path = STACKMESH_WORKER;
  o.stitch.caps = Caps::flat;
  EXPECT_NEAR(tet_volumes(*mesh_contours({both}, o).tets).at(1), 2 * 10 * 10 * 4, 1);
}

}  // namespace
