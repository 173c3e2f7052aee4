// Files that were once read wrongly, refused, or that ended the program: each is a file of tests/inputs/cases with the
// right answer.
#include <sys/resource.h>

#include <chrono>
#include <filesystem>
#include <map>

#include "../image/image_files.h"
#include "inputs.h"

namespace {

using namespace inputs;
using image_files::gzip;
using image_files::Nifti;
using image_files::pack;
using image_files::twelve;
using program::Around;

class Cases : public InputTest {
 protected:
  static std::string file(const std::string& name) { return STACKMESH_SOURCE_DIR "/tests/inputs/cases/" + name; }

  /// Number and voxels of every label.
  static std::map<int, int> voxels(const std::string& path, const std::vector<std::string>& more = {}) {
    std::map<int, int> found;
    const Json read = info(path, more);
    if (!read.is_object()) return found;
    for (const Json& l : read.at("labels")) found[l.at("label")] = l.at("voxels");
    return found;
  }

  /// `info` ends with exit 3 and a line that holds every part, within seconds and 500 MB.
  void refuses_at_once(const std::string& path, const std::vector<std::string>& parts) const {
    SCOPED_TRACE(path);
    Around around;
    around.in_child = [] {
      const rlimit data{rlim_t{500} << 20, rlim_t{500} << 20};
      return ::setrlimit(RLIMIT_DATA, &data) == 0;
    };
    const auto start = std::chrono::steady_clock::now();
    fails(3, {"info", path}, parts, {}, around);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
  }
};

const std::map<int, int> kTurned = {{1, 360}};  // the voxels of a box on a grid that is turned about z

TEST_F(Cases, GzipIsToldFromTheBytesAndEndingsMayBeOfAnyCase) {
  for (const char* name : {"Mixed.Nii.Gz", "really_gz.nii", "nokinds4.nrrd"})
    EXPECT_EQ(voxels(file(name)), kTurned) << name;
}

TEST_F(Cases, ASlopeOfZeroMeansNone) {
  EXPECT_EQ(voxels(file("slope0_inter5.nii")), kTurned);
}

TEST_F(Cases, LabelsStoredWithASlopeAreRounded) {
  EXPECT_EQ(voxels(file("edited_i16.nii.gz")), (std::map<int, int>{{1, 800}, {2, 64}}));
  EXPECT_TRUE(succeeds({"info", file("edited_i16.nii.gz")}).warns_of("rounded"));
}

TEST_F(Cases, LeftAnteriorSuperiorTurnsTheSecondAxisOnly) {
  const Json found = info(file("space_LAS.nrrd")), lps = info(file("nokinds4.nrrd"));
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(found.at("origin_mm")[i].get<double>(), (i == 1 ? -1 : 1) * lps.at("origin_mm")[i].get<double>(), 1e-9);
    for (int d = 0; d < 3; ++d)
      EXPECT_NEAR(found.at("direction")[d][i].get<double>(),
                  (i == 1 ? -1 : 1) * lps.at("direction")[d][i].get<double>(), 1e-9);
  }
}

TEST_F(Cases, NamesOfSegmentsSurviveAHoleInTheirNumbers) {
  const Json labels = info(file("hole_in_numbering.seg.nrrd")).at("labels");
  ASSERT_EQ(labels.size(), 3u);
  const char* const names[] = {"A", "B", "C"};
  for (int i = 0; i < 3; ++i) EXPECT_EQ(labels[i].at("name"), names[i]);
}

TEST_F(Cases, TiffNumbersAreLabelsWhateverTheirColour) {
  for (const char* name : {"white_is_zero.tif", "black_is_zero.tif"})
    EXPECT_EQ(voxels(file(name)), (std::map<int, int>{{255, 1176}})) << name;
  EXPECT_EQ(voxels(file("bool.tif")), (std::map<int, int>{{1, 1176}}));
  for (const char* name : {"palette_grey_stretched.tif", "u32.tif"})
    EXPECT_EQ(voxels(file(name)), (std::map<int, int>{{1, 72}, {3, 1104}})) << name;
  const double white = volume(mesh(file("white_is_zero.tif"), {"--spacing", "1,1,2"}), 255),
               black = volume(mesh(file("black_is_zero.tif"), {"--spacing", "1,1,2"}), 255);
  EXPECT_EQ(white, black);
  EXPECT_NEAR(white, 2352, 250);
}

TEST_F(Cases, SegFramesGiveTheirOwnGap) {
  EXPECT_EQ(voxels(file("wrong_spacing.dcm")), (std::map<int, int>{{1, 441}, {2, 630}}));
  const Ended r = succeeds({"info", file("wrong_spacing.dcm"), "--json"});
  EXPECT_EQ(Json::parse(r.out).at("spacing_mm")[2], 2.0);
  EXPECT_NE(r.out.find("frames' own gap"), std::string::npos);
}

TEST_F(Cases, NamesWithAMinusAreNumbersBelowZero) {
  // 780 voxels of a shape that is one piece only in the order of the numbers.
  const Json r = mesh(file("minus_names"), {"--spacing", "1,1,5"});
  EXPECT_EQ(row(r, 1).at("components"), 1);
  EXPECT_EQ(row(r, 1).at("input_components"), 1);
  EXPECT_EQ(info(file("minus_names"), {"--spacing", "1,1,5"}).at("warnings").size(), 0u);
}

TEST_F(Cases, ManyLabelsThatAreParcelsAreRead) {
  EXPECT_EQ(voxels(file("parcels.nii.gz")).size(), 1296u);
  const Json r = mesh(file("parcels.nii.gz"), {"--label", "5,6"});
  EXPECT_EQ(r.at("labels").size(), 2u);
}

TEST_F(Cases, ContourDataAbove64kStoredAsUnIsRead) {
  written_by("write_rtstruct.py", {"long"});
  if (IsSkipped() || HasFatalFailure()) return;
  ASSERT_NE(program::read_file(in("long.dcm")).find(std::string("\x06\x30\x50\0UN", 6)), std::string::npos)
      << "pydicom stores it otherwise";
  const Json found = info(in("long.dcm"));
  EXPECT_EQ(found.at("sections"), 4);
  EXPECT_EQ(found.at("labels")[0].at("name"), "Body");
  EXPECT_NEAR(found.at("labels")[0].at("largest_area_mm2").get<double>(), M_PI * 100 * 80, 5);
}

TEST_F(Cases, EqualPositionsAndEncodingsAreNamed) {
  fails(3, {"info", file("same_pos")}, {"all 12 slices", "same position"});
  fails(3, {"info", file("bz2.nrrd")}, {"bzip2 is not supported"});
}

TEST_F(Cases, MissingAndShortSliceFilesAreNamed) {
  refuses_at_once(file("list/missing.mhd"), {"l4.raw", "missing"});
  refuses_at_once(file("list/pat.mhd"), {"l0.raw", "144 bytes", "16"});
  refuses_at_once(file("list/asc.mha"), {"truncated", "64 numbers"});
}

TEST_F(Cases, WhatAFileClaimsCostsNothing) {
  refuses_at_once(file("mem_ascii.nrrd"), {"truncated"});
  refuses_at_once(file("mem_list.mhd"), {"one.raw"});
  refuses_at_once(file("dcmhuge2"), {"truncated", "s0.dcm"});
  refuses_at_once(file("seg_span2.dcm"), {"absurd number of slices"});
  refuses_at_once(file("fdict.mha"), {"dictionary"});
  refuses_at_once(file("min.nrrd"), {"'space'"});
}

TEST_F(Cases, RangesOfElementsNearTheLargestIntegerAreRefused) {
  fails(3, {"validate", file("elset_int64max.inp")}, {"too large", "byte"});
  const std::string deck = program::read_file(file("elset_int64max.inp"));
  for (const char* range : {"9223372036854775806,9223372036854775807,1", "-9223372036854775807,9223372036854775807,1",
                            "1,9223372036854775807,9223372036854775807"})
    fails(3,
          {"validate",
           write("a.inp", deck.substr(0, deck.find("*ELSET")) + "*ELSET, ELSET=A, GENERATE\n" + range + "\n")},
          {"too large"});
}

TEST_F(Cases, NumbersThatNoDoubleHoldsAreNamed) {
  fails(3, {"fem", program::testdata("border.nii.gz"), "--materials", file("law_1e999.json"), "-o", out("a.inp")},
        {"1e999", "line 1"});
  fails(3, {"validate", file("tet.vtk"), "--limits", write("l.json", "{\"dice_warn\": -1e4000}")}, {"-1e4000"});
}

TEST_F(Cases, DeepNestingIsRefused) {
  const int deep = 100000;
  const std::string nest = std::string(deep, '[') + std::string(deep, ']'), border = program::testdata("border.nii.gz");
  fails(3, {"fem", border, "--materials", write("a.json", "{\"a\":" + nest + "}"), "-o", out("a.inp")}, {"nested"});
  fails(3, {"validate", file("tet.vtk"), "--limits", write("b.json", nest)}, {"nested"});
  // DICOM: undefined lengths, explicit and implicit, and sequences that hide as UN.
  const auto dicom = [](const std::string& syntax, const std::string& level, const std::string& first = "") {
    const std::string uid = syntax + (syntax.size() % 2 ? std::string(1, '\0') : "");
    std::string meta = std::string("\2\0\x10\0UI", 6) + image_files::little<std::uint16_t>(uid.size()) + uid;
    meta = std::string("\2\0\0\0UL\4\0", 8) + image_files::little<std::uint32_t>(meta.size()) + meta;
    std::string all = std::string(128, '\0') + "DICM" + meta + first;
    for (int i = 0; i < 20000; ++i) all += level;
    return all;
  };
  const std::string open("\xff\xff\xff\xff", 4), item = std::string("\xfe\xff\0\xe0", 4) + open;
  refuses_at_once(write("a.dcm", dicom("1.2.840.10008.1.2.1", std::string("\x08\0\x40\x11SQ\0\0", 8) + open + item)),
                  {"nested more than"});
  refuses_at_once(write("b.dcm", dicom("1.2.840.10008.1.2", std::string("\x08\0\x40\x11", 4) + open + item)),
                  {"nested more than"});
  refuses_at_once(write("c.dcm", dicom("1.2.840.10008.1.2.1", std::string("\x08\0\x40\x11", 4) + open + item,
                                       std::string("\x08\0\x40\x11UN\0\0", 8) + open + item)),
                  {"nested more than"});
}

TEST_F(Cases, WhatFollowsTheVoxelsIsNotInflated) {
  // 1,000,000 gzip members of zeros would take minutes; 64 MB of them are enough to see that they are not read.
  const std::string zeros = gzip(std::string(1 << 20, '\0'));
  std::string all = gzip(Nifti().header() + pack<std::uint8_t>(twelve));
  for (int i = 0; i < 64; ++i) all += zeros;
  const Ended r = succeeds({"info", write("tail.nii.gz", all)});
  EXPECT_TRUE(r.warns_of("more data than its header says"));
}

TEST_F(Cases, MemoryIsBoundedAndAnErrorSaysByHowMuch) {
  Nifti n;
  n.dim = {3, 500, 500, 400, 1, 1, 1, 1};
  n.datatype = 4;
  n.bits = 16;
  const std::string path = in("large.nii");
  write("large.nii", n.header());
  std::filesystem::resize_file(path, 352 + 200000000);  // a sparse file: the bytes are there
  fails(4, {"info", path, "--max-memory", "128MB"}, {"191 MB", "128 MB", "--max-memory"});
  fails(2, {"info", path, "--max-memory", "lots"}, {"--max-memory"});
  Around shell;  // a bound that the shell has set is told as it is
  shell.in_child = [] {
    const rlimit space{rlim_t{256} << 20, rlim_t{256} << 20};
    return ::setrlimit(RLIMIT_AS, &space) == 0;
  };
  fails(4, {"info", path}, {"256 MB"}, {}, shell);
}

TEST_F(Cases, APngInAFolderOfDicomIsLeftOut) {
  std::filesystem::copy(STACKMESH_SOURCE_DIR "/tests/inputs/cases/wrong_spacing.dcm", in("wrong_spacing.dcm"));
  write("preview.png", image_files::grey_png(2, 2, {1, 0, 0, 1}));
  const Ended r = succeeds({"info", folder_ + "/in", "--json"});
  EXPECT_EQ(Json::parse(r.out).at("labels").size(), 2u);
  EXPECT_NE(r.out.find("preview.png"), std::string::npos);
}

TEST_F(Cases, ASlabOfOneSliceIsStackedAlongAnotherAxis) {
  Nifti n;
  n.dim = {3, 6, 5, 1, 1, 1, 1, 1};
  n.pixdim = {1, 1, 1, 5};
  n.srow = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 5, 0};
  std::vector<int> values(30, 0);
  for (int y = 1; y < 4; ++y)
    for (int x = 1; x < 5; ++x) values[6 * y + x] = 1;
  const Json r =
      mesh(write("slab.nii", n.header() + pack<std::uint8_t>(values)), {"--simplify", "0", "--interpolate", "0"});
  EXPECT_EQ(r.at("input").at("axis"), "y");
  EXPECT_NEAR(volume(r, 1), 60, 6);
}

/// Minutes, and hundreds of thousands of virtual slices or needles, for a few voxels or lines, as long as they were
/// enhanced.
TEST_F(Cases, AbsurdHeightsAndSpacingsAreToldAndKeptAsStitched) {
  const auto kept = [&](const std::string& path, const std::string& told) {
    const Ended r = succeeds({"mesh", path, "-o", out("a.vtu"), "--report", out("R.json")});
    EXPECT_TRUE(r.warns_of(told)) << r.err;
    EXPECT_TRUE(r.warns_of("kept as stitched"));
    EXPECT_EQ(report().at("surface").at("level"), "stitched");
    EXPECT_EQ(report().at("volume").at("closure"), "verified");
    EXPECT_LT(report().at("stitched").at("triangles").get<int>(), 2000);
  };
  std::vector<int> values(8 * 8 * 3, 0);
  for (int z = 0; z < 3; ++z)
    for (int y = 2; y < 6; ++y)
      for (int x = 2; x < 6; ++x) values[(z * 8 + y) * 8 + x] = 1;
  for (const auto& [x, z] : {std::pair{1.0f, 2000.0f}, std::pair{1.0f, 1e7f}, std::pair{0.002f, 1.0f}}) {
    Nifti n;
    n.dim = {3, 8, 8, 3, 1, 1, 1, 1};
    n.pixdim = {1, x, 1, z};
    n.srow = {x, 0, 0, 0, 0, 1, 0, 0, 0, 0, z, 0};
    kept(write("far.nii", n.header() + pack<std::uint8_t>(values)), "along one axis");
  }
  std::string text = "S 3\n";
  for (const char* z : {"0", "5", "1e6"}) text += std::string("v 4 z ") + z + "\n{\n0 0\n10 0\n10 10\n0 10\n}\n";
  kept(write("far.cnt", text), "mm apart");
}

TEST_F(Cases, NumbersOfDicomThatAreAbsurdAreTold) {
  refuses(file("rt_far.dcm"), {"farther away than 1e12 mm", "'box'", "contour 2"});
  const Ended r = succeeds({"surface", file("rt_points_1e300.dcm"), "-o", out("a.stl")});
  EXPECT_TRUE(r.warns_of("4 points where its header says 1e+300")) << r.err;
}

}  // namespace
