#include <dirent.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "shapes.h"
#include "volume/fill_volume.h"

namespace stackmesh {
namespace {

using Status = FillResult::Status;

InterfaceComplex cube(int n = 1) {
  return shapes::voxels(n, n, n, {1, 1, 1}, [](int, int, int) { return 1; });
}

bool contains(const std::vector<std::int32_t>& v, std::int32_t x) {
  return std::find(v.begin(), v.end(), x) != v.end();
}

std::size_t open_descriptors() {
  std::size_t n = 0;
  DIR* d = opendir("/proc/self/fd");
  while (readdir(d)) ++n;
  closedir(d);
  return n;
}

FillOptions shell(const std::string& script, double timeout_s = 20) {
  FillOptions options;
  options.worker_path = "/bin/sh";
  options.worker_args = {"-c", script};
  options.timeout_s = timeout_s;
  return options;
}

TEST(FillRefusal, OpenSurfaceIsNamed) {
  auto complex = cube();
  complex.triangles.pop_back();
  const FillResult r = fill_volume(complex, {});
  EXPECT_EQ(r.status, Status::refused);
  EXPECT_NE(r.message.find("open along 3 edges"), std::string::npos) << r.message;
  EXPECT_EQ(r.offending_triangles.size(), 3u);
  EXPECT_TRUE(r.mesh.tets.empty());
}

TEST(FillRefusal, LabelThatIsNotClosedAtAJunctionIsNamed) {
  auto complex = shapes::voxels(2, 1, 1, {1, 1, 1}, [](int i, int, int) { return i + 1; });
  for (auto& t : complex.triangles)
    if (t.below == 1 && t.above == 2) t.above = 3;
  const FillResult r = fill_volume(complex, {});
  EXPECT_EQ(r.status, Status::refused);
  EXPECT_NE(r.message.find("open"), std::string::npos) << r.message;
  EXPECT_FALSE(r.offending_triangles.empty());
}

TEST(FillRefusal, InterpenetratingBoxesGiveTheCrossingTriangles) {
  InterfaceComplex complex;
  shapes::add_box(complex, {0, 0, 0}, {4, 4, 4}, 1);
  shapes::add_box(complex, {3, 1, 1}, {6, 2, 2}, 2);        // goes in through the first one's side at x = 4
  shapes::add_box(complex, {20, 20, 20}, {21, 21, 21}, 3);  // has no part in it
  const FillResult r = fill_volume(complex, {});
  EXPECT_EQ(r.status, Status::refused) << r.message;
  // Triangles 10, 11 are the side x = 4; the small box's sides along x are quads 0..3, its triangles 12..19.
  EXPECT_TRUE(contains(r.offending_triangles, 10) || contains(r.offending_triangles, 11)) << r.message;
  int crossing = 0;
  for (int i = 12; i < 20; ++i) crossing += contains(r.offending_triangles, i);
  EXPECT_GE(crossing, 4) << r.message;
  for (const std::int32_t i : r.offending_triangles) EXPECT_LT(i, 24);
  EXPECT_NE(r.message.find("intersect"), std::string::npos) << r.message;
  EXPECT_EQ(r.message.find('\n'), std::string::npos);
  EXPECT_TRUE(r.mesh.tets.empty());
}

TEST(FillRefusal, TriangleThroughAnotherIsFoundAmongMany) {
  auto complex = cube(12);
  // Pull one surface point of the side z = 0 through to beyond the opposite side.
  std::int32_t moved = -1;
  for (std::size_t i = 0; i < complex.points.size(); ++i)
    if (complex.points[i].x == 5 && complex.points[i].y == 6 && complex.points[i].z == 0)
      moved = static_cast<std::int32_t>(i);
  ASSERT_GE(moved, 0);
  complex.points[moved].z = 14.3;
  complex.points[moved].x = 5.37;
  complex.points[moved].y = 6.21;
  const FillResult r = fill_volume(complex, {});
  EXPECT_EQ(r.status, Status::refused) << r.message;
  std::size_t of_the_spike = 0;
  for (const std::int32_t i : r.offending_triangles) {
    const auto& v = complex.triangles[i].v;
    of_the_spike += std::find(v.begin(), v.end(), moved) != v.end();
  }
  EXPECT_GE(of_the_spike, 3u) << r.message;
  EXPECT_LT(r.offending_triangles.size(), 30u);
}

TEST(FillRefusal, RepeatedAndDegenerateTrianglesAreNamed) {
  auto complex = cube();
  complex.triangles.push_back(complex.triangles[4]);
  complex.triangles.push_back({{1, 1, 2}, 1, 0});
  const FillResult r = fill_volume(complex, {});
  EXPECT_EQ(r.status, Status::refused);
  EXPECT_EQ(r.offending_triangles, (std::vector<std::int32_t>{4, 12, 13}));
}

TEST(FillRefusal, FlatSurfaceDoesNotHurtTheCaller) {
  InterfaceComplex complex;  // four coplanar points, closed by triangles on both sides of one square
  complex.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  complex.triangles = {{{0, 1, 2}, 0, 1}, {{0, 2, 3}, 0, 1}, {{0, 1, 3}, 1, 0}, {{1, 2, 3}, 1, 0}};
  const FillResult r = fill_volume(complex, {});
  EXPECT_NE(r.status, Status::verified);
  EXPECT_FALSE(r.message.empty());
  EXPECT_TRUE(r.mesh.tets.empty());
}

TEST(FillRefusal, CollinearTriangleIsNotVerified) {
  auto complex = cube();
  // A sliver of no area in a side's diagonal: points 0, m, c with m on the line.
  complex.points.push_back({0.5, 0.5, 0.5});
  const auto m = static_cast<std::int32_t>(complex.points.size() - 1);
  const auto& t = complex.triangles[0].v;
  const Vec3 mid = 0.5 * (complex.points[t[0]] + complex.points[t[2]]);
  complex.points[m] = mid;
  complex.triangles.push_back({{t[0], m, t[2]}, 1, 0});
  complex.triangles.push_back({{t[0], t[2], m}, 1, 0});
  const FillResult r = fill_volume(complex, {});
  EXPECT_NE(r.status, Status::verified);
  EXPECT_FALSE(r.message.empty());
}

TEST(FillRefusal, InsideOutLabelIsNotVerified) {
  auto complex = cube();
  for (auto& t : complex.triangles) std::swap(t.below, t.above);  // label 1 is all but the cube
  const FillResult r = fill_volume(complex, {});
  EXPECT_NE(r.status, Status::verified) << r.message;
  EXPECT_FALSE(r.message.empty());
}

TEST(FillRefusal, RegionWithTwoLabelsIsNotVerified) {
  InterfaceComplex complex;  // the inner box says that 5 surrounds it; the outer one is full of 1
  shapes::add_box(complex, {0, 0, 0}, {10, 10, 10}, 1);
  shapes::add_box(complex, {4, 4, 4}, {6, 6, 6}, 2, 5);
  const FillResult r = fill_volume(complex, {});
  EXPECT_EQ(r.status, Status::refused);
  EXPECT_NE(r.message.find("labelled both"), std::string::npos) << r.message;
}

TEST(FillRefusal, NothingToFillIsEmpty) {
  EXPECT_EQ(fill_volume({}, {}).status, Status::empty);
  auto complex = cube();
  for (auto& t : complex.triangles) t.below = t.above = 0;
  EXPECT_EQ(fill_volume(complex, {}).status, Status::empty);
}

TEST(FillRefusal, BrokenInputThrows) {
  auto complex = cube();
  complex.triangles[0].v[0] = 99;
  EXPECT_THROW(fill_volume(complex, {}), Error);
  complex = cube();
  complex.points[3].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(fill_volume(complex, {}), Error);
  FillOptions options;
  options.max_volume_mm3 = 0;
  EXPECT_THROW(fill_volume(cube(), options), Error);
}

TEST(FillWorker, SleepingWorkerTimesOut) {
  for (const char* script : {"exec sleep 60", "sleep 60; true"}) {
    const auto start = std::chrono::steady_clock::now();
    const FillResult r = fill_volume(cube(20), shell(script, 0.5));
    const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    EXPECT_EQ(r.status, Status::timed_out) << r.message;
    EXPECT_NE(r.message.find("ended after"), std::string::npos) << r.message;
    EXPECT_GE(s, 0.5);
    EXPECT_LT(s, 3);
  }
}

TEST(FillWorker, RealWorkerTimesOut) {
  FillOptions options;
  options.timeout_s = 3;
  options.max_volume_mm3 = 1e-7;  // 8e9 tets: never done
  const auto start = std::chrono::steady_clock::now();
  auto complex = cube(8);
  const FillResult r = fill_volume(complex, options);
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 60);
  // Plain filling takes a few milliseconds, so the fallback fits in what is left.
  ASSERT_EQ(r.status, Status::verified) << r.message;
  EXPECT_NE(r.fallback, "");
  EXPECT_NE(r.fallback.find("was ended after"), std::string::npos) << r.fallback;
  shapes::expect_fills(r.mesh, complex);
}

TEST(FillWorker, KilledWorkerIsACrash) {
  const FillResult r = fill_volume(cube(20), shell("kill -9 $$"));
  EXPECT_EQ(r.status, Status::crashed);
  EXPECT_NE(r.message.find("signal 9"), std::string::npos) << r.message;
}

TEST(FillWorker, WorkerThatSpeaksOtherwiseIsACrash) {
  for (const char* script : {"exit 3", "echo hello world, this is not the answer you are looking for", "cat"}) {
    const FillResult r = fill_volume(cube(20), shell(script));
    EXPECT_EQ(r.status, Status::crashed) << script;
    EXPECT_NE(r.message.find("/bin/sh"), std::string::npos) << r.message;
  }
}

TEST(FillWorker, MissingWorkerIsNamed) {
  FillOptions options;
  options.worker_path = "/nonexistent/stackmesh";
  const FillResult r = fill_volume(cube(), options);
  EXPECT_EQ(r.status, Status::crashed);
  EXPECT_NE(r.message.find("/nonexistent/stackmesh"), std::string::npos) << r.message;
  EXPECT_NE(r.message.find("No such file"), std::string::npos) << r.message;
}

// Workers that die unless the switches contain the given text: every other way to call TetGen fails.
FillOptions picky(const std::string& wanted, bool refine) {
  FillOptions options;
  options.worker_path = "/proc/self/exe";
  options.worker_args = {"--picky-worker", wanted};
  if (refine) options.radius_edge = 1.4;
  return options;
}

TEST(FillWorker, FailedCallIsTriedOtherwise) {
  const auto complex = cube(4);
  const FillResult r = fill_volume(complex, picky("T1e-16", false));
  ASSERT_EQ(r.status, Status::verified) << r.message;
  EXPECT_NE(r.message.find("T1e-16"), std::string::npos) << r.message;
  EXPECT_NE(r.fallback.find("TetGen -pYM died"), std::string::npos) << r.message;
  shapes::expect_fills(r.mesh, complex);
}

TEST(FillWorker, RefinementIsTriedAgainWhereFillingSucceeds) {
  const auto complex = cube(4);
  const FillResult r = fill_volume(complex, picky("T1e-12", true));
  ASSERT_EQ(r.status, Status::verified) << r.message;
  EXPECT_EQ(r.message.find("TetGen -pq1.4YMT1e-12"), 0u) << r.message;
  shapes::expect_fills(r.mesh, complex);
}

TEST(FillWorker, FailedRefinementFallsBackToPlainFilling) {
  const auto complex = cube(4);
  const FillResult r = fill_volume(complex, picky("pYM", true));
  ASSERT_EQ(r.status, Status::verified) << r.message;
  EXPECT_EQ(r.message.find("TetGen -pYM:"), 0u) << r.message;
  EXPECT_NE(r.fallback.find("TetGen -pq1.4YM died"), std::string::npos) << r.message;
}

TEST(FillWorker, WorkerThatAlwaysDiesIsACrash) {
  const FillResult r = fill_volume(cube(4), picky("no such switch", true));
  EXPECT_EQ(r.status, Status::crashed);
  EXPECT_NE(r.message.find("signal 6"), std::string::npos) << r.message;
  EXPECT_TRUE(r.mesh.tets.empty());
}

TEST(FillWorker, WorkerThatIsKilledTwiceIsACrashAndNothingElseIsTried) {
  const FillResult r = fill_volume(cube(20), shell("kill -9 $$"));
  EXPECT_EQ(r.status, Status::crashed);
  EXPECT_NE(r.message.find("signal 9"), std::string::npos) << r.message;
  EXPECT_EQ(r.fallback, "");
}

TEST(FillWorker, LeavesNoDescriptorAndNoChildBehind) {
  const std::size_t before = open_descriptors();
  fill_volume(cube(), {});
  fill_volume(cube(20), shell("kill -9 $$"));
  fill_volume(cube(20), shell("exec sleep 60", 0.1));
  EXPECT_EQ(open_descriptors(), before);
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);  // no child, not even a dead one
  EXPECT_EQ(errno, ECHILD);
}

TEST(FillWorker, PrintsNothing) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  fill_volume(cube(), {});
  InterfaceComplex crossing;
  shapes::add_box(crossing, {0, 0, 0}, {4, 4, 4}, 1);
  shapes::add_box(crossing, {3, 1, 1}, {6, 2, 2}, 2);
  fill_volume(crossing, {});
  fill_volume(cube(), shell("echo out; echo err >&2"));
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace stackmesh
