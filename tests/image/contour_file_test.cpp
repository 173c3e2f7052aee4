// .cnt files: what they say, and every way in which they can be bad.
#include <cmath>
#include <set>

#include "image/read_contours.h"
#include "image_files.h"

using namespace image_files;
using stackmesh::is_contour_input;
using stackmesh::LabelContours;
using stackmesh::read_contour_file;

namespace {

class ContourInput : public ImageTest {
 protected:
  void refuse(const std::string& text, std::vector<std::string> parts) {
    const std::string path = write("bad.cnt", text);
    parts.push_back(path);
    expect_error([&] { read_contour_file(path); }, parts);
  }
};

const std::string square = "{\n0 0\n4 0\n4 4\n0 4\n}\n";

TEST_F(ContourInput, IsToldByItsEnding) {
  EXPECT_TRUE(is_contour_input("a.cnt"));
  EXPECT_TRUE(is_contour_input("Heart=b/a.CNT"));
  EXPECT_FALSE(is_contour_input("a.cnt.nii"));
  EXPECT_FALSE(is_contour_input("cnt"));
}

TEST_F(ContourInput, PointsAndHeightsBeyondReasonAreRefused) {
  refuse("S 2\nv 4 z 0\n" + square + "v 4 z 1e200\n" + square, {"'1e200' is farther away than 1e12 mm", "line 9"});
  refuse("S 1\nv 3 z 0\n{\n0 0\n-2e12 0\n0 1\n}\n", {"'-2e12' is farther away than 1e12 mm", "line 5"});
  EXPECT_EQ(read_contour_file(write("a.cnt", "S 2\nv 4 z 0\n" + square + "v 4 z 1e12\n" + square)).sections[1].z_mm,
            1e12);
}

TEST_F(ContourInput, SectionsAreSortedAndEmptyOnesKept) {
  const LabelContours f = read_contour_file(
      write("a.cnt", "S 3\nv 4 z 2.5\n" + square + "v 0 z 1.25\nv 7 z -1e0\n" + square + "{\n1 1\n2 1\n1 2.5\n}\n"));
  ASSERT_EQ(f.sections.size(), 3u);
  EXPECT_EQ(f.sections[0].z_mm, -1);
  EXPECT_EQ(f.sections[1].z_mm, 1.25);
  EXPECT_EQ(f.sections[2].z_mm, 2.5);
  EXPECT_TRUE(f.sections[1].polygons.empty());
  ASSERT_EQ(f.sections[0].polygons.size(), 2u);
  EXPECT_EQ(f.sections[0].polygons[1].points[2], (std::array<double, 2>{1, 2.5}));
  EXPECT_EQ(f.label, 1);
  EXPECT_TRUE(f.warnings.empty());
}

TEST_F(ContourInput, CaseLineEndsAndLayoutDoNotMatter) {
  const LabelContours f =
      read_contour_file(write("a.cnt", "\xEF\xBB\xBFs 1\r\nV 4 Z 3\r\n{ 0 0 4 0\r\n 4 4\t0 +4 }\r\n\r\n"));
  ASSERT_EQ(f.sections.size(), 1u);
  EXPECT_EQ(f.sections[0].polygons[0].points.size(), 4u);
  EXPECT_TRUE(f.warnings.empty());
}

TEST_F(ContourInput, PairsCarryNumberOrName) {
  const std::string path = write("a.cnt", "S 1\nv 4 z 0\n" + square);
  EXPECT_EQ(read_contour_file("3=" + path).label, 3);
  EXPECT_EQ(read_contour_file("3=" + path).path, path);
  EXPECT_EQ(read_contour_file("Left lung=" + path).label, 0);
  EXPECT_EQ(read_contour_file("Left lung=" + path).name, "Left lung");
  for (const char* label : {"0", "-3", "2147483648", ""})
    expect_error([&] { read_contour_file(label + ("=" + path)); }, {"="}, stackmesh::ErrorKind::usage);
  const std::string odd = write("k=5/a=b.cnt", "S 1\nv 4 z 0\n" + square);
  EXPECT_EQ(read_contour_file(odd).label, 1);
  EXPECT_EQ(read_contour_file(odd).path, odd);
}

TEST_F(ContourInput, RepeatedPointsAreRemovedWithAWarning) {
  const LabelContours f = read_contour_file(
      write("a.cnt", "S 2\nv 4 z 0\n" + square + "v 7 z 1\n{\n0 0\n0 0\n4 0\n4 4\n4 4\n0 4\n0 0\n}\n"));
  EXPECT_EQ(f.sections[1].polygons[0].points.size(), 4u);
  ASSERT_EQ(f.warnings.size(), 1u);
  EXPECT_NE(f.warnings[0].text.find("3 repeated points"), std::string::npos);
  EXPECT_EQ(f.warnings[0].code, stackmesh::WarningCode::repeated);
  EXPECT_EQ(f.warnings[0].text.rfind(f.warnings[0].where + ": ", 0), 0u);
  EXPECT_NE(f.warnings[0].text.find("section 2 (z 1 mm): 3"), std::string::npos) << f.warnings[0].text;
}

TEST_F(ContourInput, TooFewPointsNameSectionAndContour) {
  const std::string good = "S 2\nv 4 z 0\n" + square;
  refuse(good + "v 6 z 7.5\n" + square + "{\n0 0\n1 1\n}\n", {"three", "section 2 (z 7.5 mm)", "contour 2"});
  refuse(good + "v 4 z 7.5\n{\n0 0\n1 1\n0 0\n1 1\n}\n", {"three", "section 2", "contour 1"});
  refuse(good + "v 3 z 7.5\n{\n0 0\n0 0\n1 1\n}\n", {"three"});
}

TEST_F(ContourInput, GarbageNamesTheLine) {
  refuse("hello\n", {"line 1", "'hello'"});
  refuse("S x\n", {"line 1", "'x'"});
  refuse("S -1\n", {"line 1"});
  refuse("S 1\nw 4 z 0\n" + square, {"line 2", "'w'"});
  refuse("S 1\nv 4 z\n" + square, {"line 3", "height"});
  refuse("S 1\nv 4 z nan\n" + square, {"line 2", "'nan'"});
  refuse("S 1\nv 4 z 0\n{\n0 0\n4 zero\n4 4\n0 4\n}\n", {"line 5", "'zero'"});
  refuse("S 1\nv 4 z 0\n{\n0 0\n4 inf\n4 4\n0 4\n}\n", {"line 5", "'inf'", "finite"});
  refuse("S 1\nv 4 z 0\n{\n0 0\n4 1e999\n4 4\n0 4\n}\n", {"line 5", "'1e999'"});
  refuse("S 1\nv 4 z 0\n{\n0 0\n4 0\n4 4,5\n0 4\n}\n", {"line 6", "'4,5'"});
  refuse("S 1\nv 4 z 0\n{\n0 0\n4\n4 4\n0 4\n}\n", {"line 5", "x and y"});
  refuse("S 1\nv 4 z 0\n" + square + "oops\n", {"line 9", "'oops'"});
  refuse("S 1\nv 4 z 0\n{\n0 0\n{\n", {"line 5", "'{'"});
}

TEST_F(ContourInput, EveryTruncationIsAnError) {
  const std::string text = "S 2\nv 4 z 0\n" + square + "v 7 z 1\n" + square + "{\n1 1\n2 1\n1 2\n}\n";
  ASSERT_NO_THROW(read_contour_file(write("a.cnt", text)));
  for (std::size_t length = 0; length + 2 < text.size(); ++length) {
    SCOPED_TRACE(length);
    refuse(text.substr(0, length), {});
  }
}

TEST_F(ContourInput, CountsThatDisagreeWarn) {
  const LabelContours more = read_contour_file(write("a.cnt", "S 1\nv 3 z 0\n" + square + "v 4 z 1\n" + square));
  EXPECT_EQ(more.sections.size(), 2u);
  EXPECT_TRUE(has_warning(more.warnings, "2 sections where its header says 1"));
  EXPECT_TRUE(has_warning(more.warnings, "4 vertices where 3"));
  const LabelContours fewer = read_contour_file(write("b.cnt", "S 2\nv 9 z 0\n" + square + "v 4 z 1\n" + square));
  EXPECT_TRUE(has_warning(fewer.warnings, "4 vertices where 9"));
  refuse("S 3\nv 4 z 0\n" + square, {"truncated", "1 sections", "3"});
  refuse("S 1\nv 9 z 0\n" + square, {"truncated", "4 vertices", "section 1"});
}

TEST_F(ContourInput, EqualHeightsAreAnError) {
  refuse("S 3\nv 4 z 1\n" + square + "v 4 z 0\n" + square + "v 4 z 1.0000000001\n" + square,
         {"same height", "sections 1 and 3"});
  EXPECT_NO_THROW(read_contour_file(write("a.cnt", "S 2\nv 4 z 1\n" + square + "v 4 z 1.00000001\n" + square)));
}

TEST_F(ContourInput, MissingFileFolderAndNoContourAreErrors) {
  expect_error([&] { read_contour_file(at("no.cnt")); }, {"does not exist", "no.cnt"});
  std::filesystem::create_directories(at("dir.cnt"));
  expect_error([&] { read_contour_file(at("dir.cnt")); }, {"folder"});
  refuse("S 1\nv 0 z 0\n", {"no contour"});
  refuse("S 0\n", {"no contour"});
}

}  // namespace
