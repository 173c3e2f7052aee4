// Intensities: where they lie in the world, slope and intercept, and what is refused.
#include "image/read_image.h"

#include <cmath>
#include <limits>

#include "image_files.h"

using namespace image_files;
using stackmesh::IntensityVolume;
using stackmesh::read_image;
using stackmesh::Vec3;

namespace {

class ReadImage : public ImageTest {};

TEST_F(ReadImage, KeepsNegativeValuesAndTheirPlaceInTheWorld) {
  Nifti n;
  n.pixdim = {1, 2, 3, 4};
  n.srow = {2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30};
  n.datatype = 4;
  n.bits = 16;
  const std::vector<int> hu = {-1000, -50, 0, 7, 300, 1500, 1, 2, 3, 4, 5, 6};
  const IntensityVolume v = read_image(write("a.nii", n.header() + pack<std::int16_t>(hu)));
  ASSERT_EQ(v.values.size(), 12u);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(v.values[i], hu[i]);
  EXPECT_EQ(v.kind, "nifti");
  // RAS (10 + 2 i, 20 + 3 j, 30 + 4 k) is LPS (-10 - 2 i, -20 - 3 j, 30 + 4 k).
  EXPECT_NEAR(*v.sample({-14, -23, 30}), 1500, 1e-9);
  EXPECT_NEAR(*v.sample({-11, -20, 30}), -525, 1e-9);  // between -1000 and -50
  EXPECT_NEAR(*v.sample({-10, -21.5, 32}), (-1000 + 7 + 1 + 4) / 4.0, 1e-9);
}

TEST_F(ReadImage, AppliesSlopeAndIntercept) {
  Nifti n;
  n.slope = 2;
  n.inter = -1024;
  const IntensityVolume v = read_image(write("a.nii.gz", gzip(n.header() + pack<std::uint8_t>(twelve))));
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(v.values[i], 2 * twelve[i] - 1024);
}

TEST_F(ReadImage, Nifti2IsReadAsNifti1) {
  for (const bool big_endian : {false, true})
    for (const bool by_sform : {false, true}) {
      Nifti n;
      n.big_endian = big_endian;
      n.datatype = 4;
      n.bits = 16;
      n.pixdim = {-1, 2, 3, 4};
      n.quatern = {0.5f, 0.5f, 0.5f, 11, 22, 33};
      n.srow = {0, 3, 0, 10, 2, 0, 0, 20, 0, 0, 4, 30};
      n.qform = by_sform ? 0 : 1;
      n.sform = by_sform ? 1 : 0;
      n.slope = 2;
      n.inter = -3;
      n.units = 3;  // micrometres
      const Bytes voxels = pack<std::int16_t>(twelve, big_endian);
      const IntensityVolume one = read_image(write("one.nii", n.header() + voxels)),
                            two = read_image(write("two.nii.gz", gzip(n.header2() + voxels)));
      EXPECT_EQ(two.values, one.values);
      EXPECT_EQ(two.values[5], 7);
      EXPECT_EQ(two.size, one.size);
      for (int d = 0; d < 3; ++d) {
        EXPECT_NEAR(two.spacing_mm[d], one.spacing_mm[d], 1e-9);
        EXPECT_NEAR(norm(two.axes[d] - one.axes[d]), 0, 1e-9);
      }
      EXPECT_NEAR(norm(two.origin_mm - one.origin_mm), 0, 1e-9);
      EXPECT_NEAR(two.spacing_mm[2], 0.004, 1e-9);
    }
}

TEST_F(ReadImage, DamagedNifti2IsOneClearError) {
  const Nifti n;
  const Bytes good = n.header2() + pack<std::uint8_t>(twelve);
  EXPECT_EQ(read_image(write("good.nii", good)).values.size(), 12u);
  expect_error([&] { read_image(write("cut.nii", good.substr(0, 500))); }, {"cut.nii", "no complete NIfTI header"});
  expect_error([&] { read_image(write("short.nii", good.substr(0, 550))); }, {"short.nii"});
  Bytes ends = good;
  ends.replace(4, 8, Bytes("n+2\0\n\n\x1a\n", 8));
  expect_error([&] { read_image(write("ends.nii", ends)); }, {"ends.nii", "NIfTI-2"});
  for (const std::int64_t size : {std::int64_t{-1}, std::int64_t{1} << 40, std::int64_t{2000000000}}) {
    Bytes huge = good;
    for (int d = 1; d < 4; ++d) huge.replace(16 + 8 * d, 8, little<std::int64_t>(size));
    expect_error([&] { read_image(write("huge.nii", huge)); }, {"huge.nii"});
  }
  for (const std::int64_t dimensions : {std::int64_t{-1}, std::int64_t{8}, std::int64_t{1} << 40}) {
    Bytes many = good;
    many.replace(16, 8, little<std::int64_t>(dimensions));
    expect_error([&] { read_image(write("many.nii", many)); },
                 {"many.nii", "it has " + std::to_string(dimensions) + " dimensions"});
  }
}

TEST_F(ReadImage, SampleIsConstantInTheOuterHalfVoxelAndNoneBeyond) {
  IntensityVolume v;
  v.size = {2, 1, 1};
  v.spacing_mm = {2, 1, 1};
  v.values = {10, 20};
  EXPECT_NEAR(*v.sample({-0.9, 0.4, -0.4}), 10, 1e-12);
  EXPECT_NEAR(*v.sample({2.9, 0, 0}), 20, 1e-12);
  EXPECT_NEAR(*v.sample({1, 0, 0}), 15, 1e-12);
  EXPECT_FALSE(v.sample({3.1, 0, 0}).has_value());
  EXPECT_FALSE(v.sample({0, 0.6, 0}).has_value());
  EXPECT_FALSE(v.sample({0, 0, -0.6}).has_value());
}

TEST_F(ReadImage, LinearFieldOnATurnedGridIsReproduced) {
  IntensityVolume v;
  v.size = {5, 6, 7};
  v.spacing_mm = {1.5, 0.7, 2};
  v.origin_mm = {3, -4, 5};
  const double c = std::cos(0.4), s = std::sin(0.4);
  v.axes = {Vec3{c, s, 0}, Vec3{0, 0, -1}, Vec3{s, -c, 0}};
  const auto field = [](Vec3 p) { return 2 * p.x - 3 * p.y + 0.5 * p.z; };
  for (int k = 0; k < 7; ++k)
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 5; ++i) v.values.push_back(static_cast<float>(field(v.world(i, j, k))));
  for (const Vec3 at : {Vec3{0.3, 4.2, 5.9}, Vec3{3.99, 0.01, 0.5}, Vec3{2, 3, 4}}) {
    const Vec3 p = v.world(at.x, at.y, at.z);
    EXPECT_NEAR(*v.sample(p), field(p), 1e-5);
  }
}

TEST_F(ReadImage, RefusesWhatIsNoImage) {
  expect_error([&] { read_image(at("none.nii")); }, {"does not exist", "none.nii"});
  expect_error([&] { read_image(write("a.txt", "x")); }, {"no image file", "a.txt"});
  expect_error([&] { read_image(folder_); }, {"no image file"});
  Nifti n;
  n.datatype = 16;
  n.bits = 32;
  std::vector<float> values(12, 1);
  values[4] = std::numeric_limits<float>::quiet_NaN();
  // (niftilib itself reads such a value as 0)
  expect_error([&] { read_image(write("nan.nrrd", nrrd("float", lps_grid, pack<float>(values)))); },
               {"not finite", "voxel (1, 1, 0)"});
  expect_error([&] { read_image(write("cut.nii", (n.header() + pack<float>(values)).substr(0, 380))); }, {"cut.nii"});
}

}  // namespace
