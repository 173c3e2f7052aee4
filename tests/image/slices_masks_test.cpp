// Folders: stacks of PNG/TIFF slices, and one mask per structure.
#include <algorithm>
#include <cmath>

#include "image_files.h"

using namespace image_files;
using stackmesh::LabelVolume;
using stackmesh::read_label_volume;
using stackmesh::ReadOptions;
using stackmesh::Warning;
using stackmesh::WarningCode;

namespace {

class Slices : public ImageTest {};
class Masks : public ImageTest {};

Bytes filled(int value) {
  return grey_png(2, 2, {value, 0, 0, value});
}

TEST_F(Slices, AreStackedInNaturalOrder) {
  for (int n : {1, 2, 9, 10, 11, 3, 4, 5, 6, 7, 8}) write("s/slice" + std::to_string(n) + ".png", filled(n));
  write("s/notes.txt", "ignored");
  write("s/._slice1.png", "ignored too");
  ReadOptions options;
  options.spacing_mm = std::array<double, 3>{0.5, 0.25, 3};
  const LabelVolume v = read_label_volume(at("s"), options);
  EXPECT_EQ(v.size, (std::array<int, 3>{2, 2, 11}));
  for (int k = 0; k < 11; ++k) EXPECT_EQ(number(v, 0, 0, k), k + 1);
  EXPECT_EQ(v.kind, "slices");
  EXPECT_FALSE(v.anatomical);
  EXPECT_EQ(v.spacing_mm, *options.spacing_mm);
  EXPECT_TRUE(v.warnings.empty());
}

TEST_F(Slices, GlobTakesWhatItMatches) {
  for (int n : {2, 10}) write("s/a" + std::to_string(n) + ".png", filled(n));
  write("s/b1.png", filled(1));
  write("s/m.nrrd", "left alone");
  const LabelVolume v = read_label_volume(at("s/a*.png"));
  ASSERT_EQ(v.size[2], 2);
  EXPECT_EQ(number(v, 0, 0, 0), 2);
  EXPECT_TRUE(has_warning(v.warnings, "--spacing"));
}

TEST_F(Slices, PixelsKeepTheirPlaceAndSixteenBits) {
  write("s/1.png", png(3, 2, 16, 0, pack<std::uint16_t>(std::vector<int>{0, 300, 0, 0, 0, 60000}, true)));
  write("s/2.tif", tiff(3, 2, 8, {pack<std::uint8_t>(std::vector<int>{7, 0, 0, 0, 0, 0})}));
  const LabelVolume v = read_label_volume(at("s"));
  EXPECT_EQ(number(v, 1, 0, 0), 300);
  EXPECT_EQ(number(v, 2, 1, 0), 60000);
  EXPECT_EQ(number(v, 0, 0, 1), 7);
  EXPECT_EQ(v.labels.size(), 4u);
}

TEST_F(Slices, PagesOfATiffAreSlices) {
  const auto page = [](int n) { return pack<std::uint16_t>(std::vector<int>{n, 0, 0, 0}); };
  const LabelVolume v = read_label_volume(write("stack.tiff", tiff(2, 2, 16, {page(500), page(2), page(3)})));
  ASSERT_EQ(v.size[2], 3);
  EXPECT_EQ(number(v, 0, 0, 0), 500);
  EXPECT_EQ(number(v, 0, 0, 2), 3);
}

TEST_F(Slices, MissingNumberIsNamed) {
  for (int n : {1, 2, 5, 6}) write("s/slice_" + std::to_string(n) + ".png", filled(1));
  const std::vector<Warning> warnings = read_label_volume(at("s")).warnings;
  EXPECT_TRUE(has_warning(warnings, "missing slice number 3, 4"));
  const auto hole = std::find_if(warnings.begin(), warnings.end(),
                                 [](const Warning& w) { return w.code == WarningCode::missing_slices; });
  ASSERT_NE(hole, warnings.end());
  EXPECT_EQ(hole->where, "slice_2.png");  // the last one before the hole
  for (int n : {10, 20, 40}) write("t/" + std::to_string(n) + ".png", filled(1));
  EXPECT_TRUE(has_warning(read_label_volume(at("t")).warnings, "missing slice number 30"));
  for (int n : {10, 20, 30}) write("u/" + std::to_string(n) + ".png", filled(1));
  EXPECT_FALSE(has_warning(read_label_volume(at("u")).warnings, "missing"));
}

TEST_F(Slices, OfDifferentSizesNameTheFile) {
  write("s/1.png", filled(1));
  write("s/2.png", grey_png(3, 1, {1, 1, 1}));
  expect_error([&] { read_label_volume(at("s")); }, {"size", "2.png", "3 x 1", "2 x 2"});
}

TEST_F(Slices, ColourIsRefusedUnlessGreyInTruth) {
  const LabelVolume v = read_label_volume(write("g.png", png(2, 1, 8, 2, Bytes("\4\4\4\0\0\0", 6))));
  EXPECT_EQ(number(v, 0, 0, 0), 4);
  expect_unreadable(write("c.png", png(2, 1, 8, 2, Bytes("\4\4\4\4\5\4", 6))), {"colour image", "pixel (1, 0)"});
  expect_unreadable(write("p.png", png(2, 1, 8, 3, Bytes("\0\1", 2))), {"colour palette"});
  const LabelVolume opaque = read_label_volume(write("a.png", png(1, 1, 8, 6, Bytes("\4\4\4\xff", 4))));
  EXPECT_EQ(number(opaque, 0, 0, 0), 4);
}

TEST_F(Slices, DamagedFilesAreRefused) {
  Bytes bytes = grey_png(4, 4, std::vector<int>(16, 1));
  bytes[bytes.size() - 25] ^= 1;
  expect_unreadable(write("d.png", bytes), {"damaged"});
  // Whole chunks, but too few or broken pixels within.
  expect_unreadable(write("f.png", short_png(4, 4, zlib(Bytes(10, '\0')))), {"damaged"});
  expect_unreadable(write("f.png", short_png(4, 4, zlib(Bytes(20, '\1')).substr(0, 12))), {"damaged"});
  expect_unreadable(write("f.png", short_png(4, 4, "nonsense")), {"damaged"});
  const Bytes page = tiff(40, 40, 8, {Bytes(1600, '\1')});
  for (std::size_t length : {std::size_t{7}, std::size_t{20}, std::size_t{100}, page.size() - 800, page.size() - 1})
    expect_unreadable(write("d.tif", page.substr(0, length)), {"truncated"});
  const Bytes two = tiff(40, 40, 8, {Bytes(1600, '\1'), Bytes(1600, '\2')});
  expect_unreadable(write("e.tif", two.substr(0, two.size() - 800)), {"truncated", "page 2"});
}

TEST_F(Slices, OddTagsAndProfilesAreNotPrinted) {
  testing::internal::CaptureStderr();
  read_label_volume(write("a.png", filled(1)));                        // carries a broken colour profile
  read_label_volume(write("a.tif", tiff(2, 2, 8, {Bytes(4, '\1')})));  // carries a private tag
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(Slices, BadSpacingIsRefused) {
  write("s/1.png", filled(1));
  for (double s : {0.0, -1.0, std::nan("")}) {
    ReadOptions options;
    options.spacing_mm = std::array<double, 3>{1, s, 1};
    expect_error([&] { read_label_volume(at("s"), options); }, {"--spacing"}, stackmesh::ErrorKind::usage);
  }
}

TEST_F(Slices, FolderWithNothingOrBothKindsIsRefused) {
  std::filesystem::create_directories(at("empty"));
  expect_unreadable(at("empty"), {"no PNG/TIFF slices and no mask"});
  write("both/1.png", filled(1));
  write("both/heart.nrrd", nrrd("uchar", lps_grid, pack<std::uint8_t>(twelve)));
  expect_unreadable(at("both"), {"both", "1.png", "heart.nrrd"});
}

Bytes mask(const std::vector<int>& values, const std::string& grid = lps_grid) {
  return nrrd("uchar", grid, pack<std::uint8_t>(values));
}

TEST_F(Masks, BecomeNamedLabelsInNaturalOrder) {
  write("m/rib_10.nrrd", mask({0, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0}));
  write("m/rib_2.nii.gz",
        gzip(Nifti{}.header() + pack<std::uint8_t>(std::vector<int>{0, 255, 0, 255, 0, 0, 0, 0, 0, 0, 0, 0})));
  Bytes grid = "TransformMatrix = -1 0 0 0 -1 0 0 0 1\n";
  write("m/aorta.mha",
        metaimage("MET_UCHAR", grid, pack<std::uint8_t>(std::vector<int>{1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1})));
  // The three share the grid of RAS identity.
  write("m/rib_10.nrrd", mask({0, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0},
                              "space: LPS\nspace directions: (-1,0,0) (0,-1,0) (0,0,1)\nspace origin: (0,0,0)\n"));
  const LabelVolume v = read_label_volume(at("m"));
  EXPECT_EQ(v.kind, "masks");
  ASSERT_EQ(v.labels.size(), 4u);
  const char* names[] = {"", "aorta", "rib_2", "rib_10"};
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(v.labels[i].number, i);
    EXPECT_EQ(v.labels[i].name, names[i]);
  }
  const std::vector<std::uint16_t> expected = {1, 1, 0, 2, 3, 0, 0, 0, 0, 0, 0, 1};
  EXPECT_EQ(v.voxels, expected);
  ASSERT_EQ(v.warnings.size(), 2u);
  EXPECT_NE(v.warnings[0].text.find("'aorta' and 'rib_2' overlap in 1 voxel"), std::string::npos) << v.warnings[0].text;
  EXPECT_NE(v.warnings[1].text.find("'rib_2' and 'rib_10' overlap in 1 voxel"), std::string::npos)
      << v.warnings[1].text;
}

TEST_F(Masks, WithoutVoxelsAreLeftOutAndNumbersStay) {
  write("m/a.nrrd", mask(std::vector<int>(12, 0)));
  write("m/b.nrrd", mask(twelve));
  const LabelVolume v = read_label_volume(at("m"));
  ASSERT_EQ(v.labels.size(), 2u);
  EXPECT_EQ(v.labels[1].number, 2);
  EXPECT_EQ(v.labels[1].name, "b");
  EXPECT_EQ(v.voxels[1], 1);
  EXPECT_TRUE(has_warning(v.warnings, "'a' has no voxel"));
  EXPECT_TRUE(has_warning(v.warnings, "4 different labels"));
}

TEST_F(Masks, OnDifferentGridsNameTheFile) {
  write("m/a.nrrd", mask(twelve));
  const struct {
    const char* what;
    Bytes bytes;
  } others[] = {
      {"size", nrrd("uchar", lps_grid, Bytes(12, '\1'), "2 3 2")},
      {"voxel size", mask(twelve, "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1.01)\nspace origin: (0,0,0)\n")},
      {"origin", mask(twelve, "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0.5)\n")},
      {"direction", mask(twelve, "space: LPS\nspace directions: (0,1,0) (1,0,0) (0,0,1)\nspace origin: (0,0,0)\n")}};
  for (const auto& other : others) {
    write("m/b.nrrd", other.bytes);
    expect_error([&] { read_label_volume(at("m")); }, {std::string("differs: ") + other.what, "b.nrrd"});
  }
  write("m/b.nrrd",
        mask(twelve, "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1.00001)\nspace origin: (0,0,0.00001)\n"));
  EXPECT_NO_THROW(read_label_volume(at("m")));
}

TEST_F(Masks, OfOneNameAndAnIntensityImageAreRefused) {
  write("m/a.nrrd", mask(twelve));
  write("m/a.mha", metaimage("MET_UCHAR", "", pack<std::uint8_t>(twelve)));
  expect_error([&] { read_label_volume(at("m")); }, {"two masks", "'a'"});
  std::filesystem::remove(at("m/a.mha"));
  write("m/ct.nrrd", nrrd("short", lps_grid, pack<std::int16_t>(std::vector<int>(12, -1000))));
  expect_error([&] { read_label_volume(at("m")); }, {"intensity image", "ct.nrrd"});
}

}  // namespace
