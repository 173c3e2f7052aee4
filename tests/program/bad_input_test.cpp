// Every bad input: exit 3, one line that says what, where and how to mend, and nothing written.
#include <cmath>
#include <filesystem>
#include <numeric>

#include "../image/image_files.h"
#include "program.h"

namespace program {
namespace {

using namespace image_files;

class BadInput : public ProgramTest {
 protected:
  static Bytes border() { return read_file(testdata("border.nii.gz")); }
  static Bytes nifti(const Nifti& header = {}, const Bytes& data = pack<std::uint8_t>(twelve)) {
    return header.header() + data;
  }
  /// A NIfTI of 20 x 10 x 10 values of one type.
  template <class T>
  static Bytes big_volume(int datatype, const std::vector<T>& values) {
    Nifti header;
    header.dim = {3, 20, 10, 10, 1, 1, 1, 1};
    header.datatype = datatype;
    header.bits = 8 * sizeof(T);
    return header.header() + pack<T>(values);
  }
};

TEST_F(BadInput, MissingFile) {
  refuses(in("absent.nii.gz"), {"does not exist", "check the path"});
  refuses(in("absent.cnt"), {"does not exist"});
  refuses(in("absent"), {"does not exist"});
  refuses(in("*.png"), {"no file matches"});
}

TEST_F(BadInput, UnknownEndingAndEmptyFolder) {
  refuses(write("labels.dat", "x"), {"no known format", ".nii.gz"});
  std::filesystem::create_directories(in("empty"));
  refuses(in("empty"), {"no PNG/TIFF slices and no mask volumes"});
}

TEST_F(BadInput, TruncatedNifti) {
  const Bytes whole = nifti();
  refuses(write("a.nii", whole.substr(0, whole.size() - 1)), {"truncated"});
  refuses(write("b.nii", whole.substr(0, 200)), {"truncated"});
  refuses(write("c.nii", ""), {"truncated"});
  refuses(write("d.nii.gz", border().substr(0, 300)), {"truncated"});
  refuses(write("e.nii.gz", border().substr(0, border().size() - 4)), {"truncated"});
}

TEST_F(BadInput, CorruptNifti) {
  Bytes flipped = border();
  flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 0x10);
  refuses(write("a.nii.gz", flipped), {"damaged"});
  refuses(write("b.nii", "this is a letter to the editor, not an image"), {"truncated"});
  refuses(write("c.nii", Bytes(1000, 'x')), {"header"});
  refuses(write("d.nii.gz", "not gzip at all"), {""});
}

TEST_F(BadInput, WrongEndianHeader) {
  // The length field says big-endian, the rest is little-endian.
  Bytes mixed = nifti();
  mixed.replace(0, 4, big<std::int32_t>(348));
  refuses(write("a.nii", mixed), {"byte order"});
}

TEST_F(BadInput, TruncatedAndCorruptNrrd) {
  const Bytes data = pack<std::uint8_t>(twelve);
  refuses(write("a.nrrd", nrrd("uint8", lps_grid, data.substr(0, 11))), {"truncated"});
  Bytes zipped = gzip(data);
  zipped[14] = static_cast<char>(zipped[14] ^ 1);
  refuses(write("b.nrrd", nrrd("uint8", lps_grid, zipped, "3 2 2", "gzip")), {"damaged"});
  refuses(write("c.nrrd", nrrd("uint8", lps_grid, gzip(data).substr(0, 20), "3 2 2", "gzip")), {"truncated"});
  refuses(write("d.nrrd", "NRRD0004\ntype: uint8\n"), {""});
  refuses(write("e.nrrd", "no header"), {""});
}

TEST_F(BadInput, TruncatedMetaImageAndGipl) {
  refuses(write("a.mha", metaimage("MET_UCHAR", "", pack<std::uint8_t>(twelve).substr(0, 7))), {"truncated"});
  refuses(write("b.mhd",
                "ObjectType = Image\nNDims = 3\nDimSize = 3 2 2\nElementType = MET_UCHAR\nElementDataFile = "
                "gone.raw\n"),
          {"gone.raw"});
  refuses(write("c.gipl", gipl().substr(0, 260)), {"truncated"});
}

TEST_F(BadInput, TruncatedAndCorruptPng) {
  const Bytes good = grey_png(3, 2, {0, 1, 1, 0, 1, 1});
  write("cut/s1.png", good);
  write("cut/s2.png", good.substr(0, good.size() - 20));
  refuses(in("cut"), {"s2.png"}, {"--spacing", "1,1,2"});
  Bytes flipped = good;
  flipped[flipped.size() - 20] = static_cast<char>(flipped[flipped.size() - 20] ^ 1);
  write("flip/s1.png", flipped);
  write("flip/s2.png", good);
  refuses(in("flip"), {"s1.png"}, {"--spacing", "1,1,2"});
}

TEST_F(BadInput, ZeroAndNegativeSpacing) {
  Nifti header;
  header.pixdim = {1, 0, 1, 1};
  refuses(write("a.nii", nifti(header)), {"voxel size is 0 along axis 1"});
  header.pixdim = {1, 1, 1, -2.5f};
  refuses(write("b.nii", nifti(header)), {"voxel size is -2.5 along axis 3"});
  header.pixdim = {1, 1, std::nanf(""), 1};
  refuses(write("c.nii", nifti(header)), {"voxel size"});
  refuses(write("d.mha", metaimage("MET_UCHAR", "ElementSpacing = 1 1 0\n", pack<std::uint8_t>(twelve))),
          {"voxel size is 0"});
  refuses(write("e.gipl", gipl(1, -1, 1)), {"voxel size is -1"});
  refuses(write("f.nrrd", nrrd("uint8", "spacings: 1 0 1\n", pack<std::uint8_t>(twelve))), {"voxel size"});
}

TEST_F(BadInput, NoLabelAtAll) {
  refuses(write("a.nii", nifti({}, Bytes(12, '\0'))), {"every voxel is background"});
  write("s/1.png", grey_png(2, 2, {0, 0, 0, 0}));
  write("s/2.png", grey_png(2, 2, {0, 0, 0, 0}));
  refuses(in("s"), {"every voxel is background"}, {"--spacing", "1,1,2"});
}

TEST_F(BadInput, LabelThatIsNotThere) {
  const std::string input = testdata("border.nii.gz");
  const auto mesh = [&](const std::string& label) {
    return std::vector<std::string>{"mesh", input, "-o", out("a.vtu"), "--label", label};
  };
  fails(3, mesh("99"), {"'99' is not in the input", "1, 2, 3"});
  fails(3, mesh("1,femur"), {"'femur' is not in the input"});
  fails(3, mesh("7-9"), {"'7-9' is not in the input"});
  fails(3, {"mesh", input, "-o", out("a.vtu"), "--caps", "9=flat"}, {"'9' is not in the input"});
  fails(3, {"mesh", testdata("masks"), "-o", out("a.vtu"), "--label", "liver"}, {"'liver'", "heart"});
}

TEST_F(BadInput, IntensityImageGivenByMistake) {
  std::vector<float> fractions(2000, 0.f);
  fractions[1] = 0.5f;
  refuses(write("a.nii", big_volume(16, fractions)),
          {"given by mistake", "0.5 is not a whole number", "voxel (1, 0, 0)"});
  std::vector<std::int16_t> negative(2000, 0);
  negative[21] = -1000;
  refuses(write("b.nii", big_volume(4, negative)), {"given by mistake", "negative value -1000", "voxel (1, 1, 0)"});
  std::vector<std::int16_t> many(2000);
  std::iota(many.begin(), many.end(), std::int16_t{0});
  refuses(write("c.nii", big_volume(4, many)), {"given by mistake", "more than 1000 distinct values"});
  std::vector<float> infinite(12, 0.f);
  infinite[5] = INFINITY;
  refuses(write("d.nrrd", nrrd("float", lps_grid, pack<float>(infinite))), {"given by mistake", "voxel (2, 1, 0)"});
}

TEST_F(BadInput, AThousandLabelsAreNotTooMany) {
  std::vector<std::int16_t> values(2000, 0);
  for (int i = 0; i < 1000; ++i) values[i] = static_cast<std::int16_t>(i + 1);
  const Ended r = succeeds({"info", write("a.nii", big_volume(4, values)), "--json"});
  EXPECT_EQ(Json::parse(r.out).at("labels").size(), 1000u);
}

TEST_F(BadInput, OneSliceOnly) {
  Nifti flat;
  flat.dim = {3, 3, 4, 1, 1, 1, 1, 1};
  refuses(write("a.nii", nifti(flat)), {"only one slice", "at least two"});
  refuses(write("b.png", grey_png(2, 2, {1, 1, 1, 1})), {"only one slice"}, {"--spacing", "1,1,2"});
  refuses(write("c.cnt", "S 1\nv 3 z 0\n{\n0 0\n1 0\n0 1\n}\n"), {"only 1 section", "at least two"});
  fails(3, {"contours", in("a.nii"), "-o", out("a.json")}, {"only one slice", in("a.nii")});
}

TEST_F(BadInput, SlicesOfDifferentSizes) {
  write("s/slice1.png", grey_png(3, 2, {0, 1, 1, 0, 1, 1}));
  write("s/slice2.png", grey_png(2, 2, {1, 1, 1, 1}));
  refuses(in("s"), {"differ in size: 2 x 2 against 3 x 2", "slice2.png", "slice1.png"}, {"--spacing", "1,1,2"});
}

TEST_F(BadInput, MissingSliceNumberIsAWarning) {
  for (const char* name : {"s/slice_8.png", "s/slice_9.png", "s/slice_12.png"})
    write(name, grey_png(3, 2, {0, 1, 1, 0, 1, 1}));
  const Ended r = succeeds({"mesh", in("s"), "--spacing", "1,1,2", "-o", out("a.vtu"), "--report", out("R.json")});
  EXPECT_TRUE(r.warns_of("10")) << r.err;
  EXPECT_EQ(r.err.find("error"), std::string::npos) << r.err;
  EXPECT_EQ(report().at("input").at("sections"), 3);
  EXPECT_NE(report().at("warnings").dump().find("10"), std::string::npos);
}

TEST_F(BadInput, SpacingThatIsNotNeededOrNotKnown) {
  fails(2, {"mesh", testdata("border.nii.gz"), "--spacing", "1,1,1", "-o", out("a.vtu")},
        {"--spacing is for PNG/TIFF slices"});
  fails(2, {"mesh", testdata("tube.cnt"), "--spacing", "1,1,1", "-o", out("a.vtu")},
        {"--spacing is for PNG/TIFF slices"});
  const Ended r = succeeds({"info", testdata("slices_png")});
  EXPECT_TRUE(r.warns_of("--spacing")) << r.err;
}

// ---- contour files ----

const std::string square = "{\n0 0\n10 0\n10 10\n0 10\n}\n";

class BadContours : public ProgramTest {};

TEST_F(BadContours, FewerThanThreePoints) {
  refuses(write("a.cnt", "S 2\nv 4 z 0\n" + square + "v 6 z 1.5\n" + square + "{\n20 20\n30 30\n}\n"),
          {"three different points", "section 2 (z 1.5 mm), contour 2"});
  refuses(write("b.cnt", "S 2\nv 4 z 0\n{\n0 0\n1 1\n0 0\n1 1\n}\nv 4 z 1\n" + square),
          {"three different points", "section 1", "contour 1"});
}

TEST_F(BadContours, RepeatedPointsAreCleanedWithAWarning) {
  const std::string input = write("a.cnt", "S 2\nv 6 z 0\n{\n0 0\n10 0\n10 0\n10 10\n0 10\n0 0\n}\nv 4 z 1\n" + square);
  const Ended r =
      succeeds({"mesh", input, "-o", out("a.vtu"), "--report", out("R.json"), "--caps", "flat", "--no-enhance"});
  EXPECT_TRUE(r.warns_of("2 repeated points removed (section 1")) << r.err;
  EXPECT_EQ(report().at("contours").at("vertices"), 8);
  EXPECT_NEAR(row(report(), 1).at("tet_volume_mm3").get<double>(), 100, 1e-9);
}

TEST_F(BadContours, BowTie) {
  refuses(write("a.cnt",
                "S 2\nv 4 z 0\n" + square + "v 8 z 1\n{\n20 0\n30 0\n30 10\n20 10\n}\n{\n0 0\n10 10\n10 0\n0 10\n}\n"),
          {"crosses itself", "section 2", "contour 2"});
}

TEST_F(BadContours, OverlappingContours) {
  refuses(write("a.cnt", "S 3\nv 4 z 0\n" + square + "v 4 z 1\n" + square + "v 8 z 2.5\n" + square +
                             "{\n5 5\n15 5\n15 15\n5 15\n}\n"),
          {"contour 1 overlaps contour 2", "section 3 at z = 2.5"});
}

TEST_F(BadContours, NonFiniteCoordinates) {
  for (const char* bad : {"nan", "inf", "-inf", "1e999", "NaN"}) {
    refuses(write("a.cnt", std::string("S 2\nv 3 z 0\n{\n0 0\n10 ") + bad + "\n0 10\n}\nv 4 z 1\n" + square),
            {bad, "line 5"});
    refuses(write("b.cnt", std::string("S 2\nv 4 z ") + bad + "\n" + square + "v 4 z 1\n" + square), {bad, "line 2"});
  }
}

TEST_F(BadContours, Truncated) {
  refuses(write("a.cnt", "S 2\nv 4 z 0\n" + square), {"truncated", "1 sections where its header says 2"});
  refuses(write("b.cnt", "S 2\nv 4 z 0\n" + square + "v 4 z 1\n{\n0 0\n1 0\n"), {"truncated"});
  refuses(write("c.cnt", ""), {""});
  refuses(write("d.cnt", "hello\n"), {"line 1"});
  refuses(write("e.cnt", "S 0\n"), {"no contour"});
}

TEST_F(BadContours, TwoFilesWithOneNumber) {
  const std::string a = write("a.cnt", "S 2\nv 4 z 0\n" + square + "v 4 z 1\n" + square),
                    b = write("b.cnt", read_file(a));
  fails(3, {"mesh", "1=" + a, "1=" + b, "-o", out("a.vtu")}, {"two contour files for label 1", b});
  fails(2, {"mesh", "0=" + a, "-o", out("a.vtu")}, {"'0'"});
  fails(2, {"mesh", a, testdata("border.nii.gz"), "-o", out("a.vtu")}, {"cannot be mixed"});
}

}  // namespace
}  // namespace program
