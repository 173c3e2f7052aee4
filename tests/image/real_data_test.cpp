// The project's real data, where it is at hand.
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <iostream>

#include "image/read_contours.h"
#include "image_files.h"

using namespace image_files;
using stackmesh::LabelVolume;
using stackmesh::read_label_volume;

#ifndef STACKMESH_SHARED_DATA
#define STACKMESH_SHARED_DATA ""
#endif

namespace {

namespace fs = std::filesystem;
const std::string data = STACKMESH_SHARED_DATA;

#define NEEDS_DATA()                                                       \
  if (data.empty() || !fs::exists(data))                                   \
  GTEST_SKIP() << "REAL DATA ABSENT (STACKMESH_SHARED_DATA): nothing was " \
                  "tested"

TEST(RealData, EveryLabelVolumeIsReadAndTheCtIsNot) {
  NEEDS_DATA();
  int read = 0;
  testing::internal::CaptureStderr();
  for (const auto& entry : fs::recursive_directory_iterator(data)) {
    const std::string name = entry.path().filename().string(), end = entry.path().extension().string();
    const bool gz = name.find(".nii.gz") != std::string::npos || name.find(".gipl.gz") != std::string::npos;
    if (end != ".nrrd" && end != ".mha" && !gz) continue;
    SCOPED_TRACE(entry.path().string());
    if (name.compare(0, 3, "ct_") == 0) continue;
    LabelVolume v;
    ASSERT_NO_THROW(v = read_label_volume(entry.path().string()));
    EXPECT_GT(v.labels.size(), 1u);
    EXPECT_EQ(v.voxels.size(), static_cast<std::size_t>(v.size[0]) * v.size[1] * v.size[2]);
    for (std::size_t n : count_voxels(v)) EXPECT_GT(n, 0u);
    ++read;
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_GE(read, 20);
  expect_unreadable(data + "/torso_totalseg/ct_3mm.nii.gz", {"intensity image"});
}

TEST(RealData, FloatStoredBrainInLiaOrientation) {
  NEEDS_DATA();
  const LabelVolume v = read_label_volume(data + "/brain_labels_lab2im/brain_label_map.nii.gz");
  EXPECT_EQ(v.labels.size(), 26u);
  // Voxel axes point left, inferior, anterior.
  EXPECT_NEAR(v.axes[0].x, 1, 1e-6);
  EXPECT_NEAR(v.axes[1].z, -1, 1e-6);
  EXPECT_NEAR(v.axes[2].y, -1, 1e-6);
}

TEST(RealData, ThickSpinalCordIsOblique) {
  NEEDS_DATA();
  const LabelVolume v = read_label_volume(data + "/spinal_cord_thick_sct/mt1_seg.nii.gz");
  EXPECT_EQ(v.size, (std::array<int, 3>{40, 40, 5}));
  EXPECT_NEAR(v.spacing_mm[2], 17, 1e-5);
  EXPECT_NEAR(v.axes[1].z, -0.0749588, 1e-6);
  EXPECT_NEAR(norm(v.axes[1]), 1, 1e-14);
}

TEST(RealData, EveryContourFileIsRead) {
  NEEDS_DATA();
  int read = 0;
  for (const auto& entry : fs::recursive_directory_iterator(data)) {
    if (entry.path().extension() != ".cnt") continue;
    SCOPED_TRACE(entry.path().string());
    stackmesh::LabelContours f;
    ASSERT_NO_THROW(f = stackmesh::read_contour_file(entry.path().string()));
    EXPECT_GE(f.sections.size(), 2u);
    ++read;
  }
  EXPECT_GE(read, 20);
}

TEST(RealData, LargeLungsAreReadWithinMemory) {
  NEEDS_DATA();
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  const auto start = std::chrono::steady_clock::now();
  const LabelVolume v = read_label_volume(data + "/lung_lr_cip/lungs_left_right.nrrd");
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  getrusage(RUSAGE_SELF, &after);
  EXPECT_EQ(v.size, (std::array<int, 3>{512, 512, 630}));
  ASSERT_EQ(v.labels.size(), 3u);
  EXPECT_LT(after.ru_maxrss / 1024, 1200) << "MiB";
  std::cout << "lungs 512 x 512 x 630: " << seconds << " s, peak of the process " << after.ru_maxrss / 1024 << " MiB\n";
}

}  // namespace
