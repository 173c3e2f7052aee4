// DICOM RTSTRUCT: what is read from files that pydicom wrote, against volumes known by hand.
#include <cmath>
#include <filesystem>

#include "image/read_contours.h"
#include "inputs.h"

namespace {

using namespace inputs;

class StructureSet : public InputTest {
 protected:
  std::string drawn(const std::string& name) {
    written_by("write_rtstruct.py", {name});
    return in(name + ".dcm");
  }
};

#define DRAWN(variable, name)               \
  const std::string variable = drawn(name); \
  if (IsSkipped() || HasFatalFailure()) return

TEST_F(StructureSet, BecomesLabelsWithNamesAndPlace) {
  DRAWN(file, "box");
  const Json r = mesh(file);
  EXPECT_EQ(r.at("input").at("kind"), "rtstruct");
  EXPECT_EQ(r.at("input").at("space"), "lps");
  EXPECT_EQ(r.at("input").at("sections"), 10);
  ASSERT_EQ(r.at("labels").size(), 1u);
  EXPECT_EQ(row(r, 1).at("name"), "Lt Lung");
  EXPECT_NEAR(volume(r, 1), 20 * 20 * 20, 1e-6);  // a contour stands for 2 mm: half a gap beyond either end
  EXPECT_TRUE(last_.warns_of("'Areola', 'Iso'"));
  expect_bounds(bounds(), {10, 30, -40, -20, 99, 119}, 1e-3);
  mesh(file, {"--space", "ras"});
  expect_bounds(bounds(), {-30, -10, 20, 40, 99, 119}, 1e-3);
}

TEST_F(StructureSet, IsReadInEveryEncoding) {
  for (const char* name : {"implicit", "bare"}) {
    DRAWN(file, name);
    EXPECT_NEAR(volume(mesh(file), 1), 8000, 1e-6) << name;
  }
  DRAWN(latin, "latin");
  EXPECT_EQ(row(mesh(latin), 1).at("name"), "H\u00fcfte");
}

TEST_F(StructureSet, NamesInTheCharacterSetsOfTheFarEastAreDecoded) {
  DRAWN(japanese, "japanese");
  const Json j = mesh(japanese);
  EXPECT_EQ(row(j, 1).at("name"), "左肺");
  EXPECT_EQ(row(j, 2).at("name"), "ｼﾝｿﾞｳ heart");
  EXPECT_EQ(row(j, 3).at("name"), "本");
  mesh(japanese, {"--label", "左肺"});
  DRAWN(korean, "korean");
  EXPECT_EQ(row(mesh(korean), 1).at("name"), "왼쪽 폐");
  DRAWN(chinese, "chinese");
  EXPECT_EQ(row(mesh(chinese), 1).at("name"), "左肺");
}

TEST_F(StructureSet, ContoursInsideOthersAreHolesAndIslands) {
  DRAWN(ring, "ring");
  const Json r = mesh(ring);
  EXPECT_NEAR(volume(r, 1), (400 - 100 + 16) * 20, 1e-6);
  EXPECT_EQ(row(r, 1).at("components"), 2);
  DRAWN(two, "several");
  EXPECT_NEAR(volume(mesh(two), 1), 2 * 100 * 20, 1e-6);
}

TEST_F(StructureSet, TheBridgeOfAKeyholeIsNoEdge) {
  DRAWN(file, "keyhole");
  const Json r = mesh(file);
  EXPECT_NEAR(volume(r, 1), (400 - 100) * 20, 1e-6);
  EXPECT_EQ(row(r, 1).at("euler"), 0);  // a ring
}

TEST_F(StructureSet, MissingSectionsAreFilledAndNamed) {
  DRAWN(file, "missing");
  const Json r = mesh(file);
  EXPECT_NEAR(volume(r, 1), 8000, 1e-2);
  EXPECT_NEAR(volume(r, 2), 2000, 1e-2);
  EXPECT_TRUE(last_.warns_of("'B' has no contour at z = 4, 14 mm"));
  EXPECT_TRUE(last_.warns_of("'A' has no contour at about z = 8, 10 mm"));
}

TEST_F(StructureSet, AMissingSectionIsWhatTheStitchedSurfaceHasThere) {
  // B's own sections alone are stitched over the gap; with A beside it, its missing sections are cut from that surface.
  DRAWN(file, "missing");
  const double alone = volume(mesh(file, {"--label", "B"}), 2);
  EXPECT_NEAR(volume(mesh(file), 2), alone, 1e-3 * alone);
}

TEST_F(StructureSet, NearlyEqualHeightsAreOneSection) {
  DRAWN(file, "heights");
  const Json r = mesh(file);
  EXPECT_EQ(r.at("input").at("sections"), 10);
  EXPECT_NEAR(volume(r, 1), 4000, 1);
}

TEST_F(StructureSet, OverlapGoesToTheSmallerOrTheOneNamedFirst) {
  DRAWN(file, "overlap");
  Json r = mesh(file);
  EXPECT_NEAR(volume(r, 1), 18000 - 4000, 1e-6);
  EXPECT_NEAR(volume(r, 2), 8000, 1e-6);
  EXPECT_TRUE(last_.warns_of("'Small' and 'Large' overlap in 4000 mm3"));
  r = mesh(file, {"--label", "Large,Small"});
  EXPECT_NEAR(volume(r, 1), 18000, 1e-6);
  EXPECT_NEAR(volume(r, 2), 4000, 1e-6);
  EXPECT_TRUE(last_.warns_of("which went to 'Large'"));
  r = mesh(file, {"--label", "Small,Large", "--merge"});
  EXPECT_NEAR(volume(r, 1), 18000 + 8000 - 4000, 1e-6);
}

TEST_F(StructureSet, WhatLiesInsideIsNeverEatenUp) {
  DRAWN(file, "nested");
  for (const char* order : {"Outer,Inner", "Inner,Outer"}) {
    const Json r = mesh(file, {"--label", order});
    EXPECT_NEAR(volume(r, 1), 18000 - 2000, 1e-6) << order;
    EXPECT_NEAR(volume(r, 2), 2000, 1e-6) << order;
    EXPECT_TRUE(last_.warns_of("inside 'Outer', and taken out of it: 'Inner' (2000 mm3)")) << order;
  }
}

TEST_F(StructureSet, OpenContoursAreClosedAndNamed) {
  DRAWN(file, "open");
  const Json r = mesh(file);
  EXPECT_NEAR(volume(r, 1), 8000, 1e-6);
  EXPECT_NEAR(volume(r, 2), 2000, 1e-6);
  EXPECT_TRUE(last_.warns_of("'Open': open contours closed by a straight line: 1, 2, 3"));
}

TEST_F(StructureSet, ContoursThatBoundNothingAreLeftOutAndNamed) {
  DRAWN(file, "odd");
  EXPECT_NEAR(volume(mesh(file), 1), 8000, 1e-6);
  EXPECT_TRUE(last_.warns_of(
      "'Box': contours that bound no area (fewer than three points, or on a line) left out: 11, 12, 13"));
  EXPECT_TRUE(last_.warns_of("points and curves that are no outlines left out: 14, 15"));
}

TEST_F(StructureSet, ContoursThatCrossALittleAreUnited) {
  DRAWN(file, "drawn_over");
  // The square, and what the pen drew past its start: 1 x 1 below the square (its left half mm drawn once).
  EXPECT_NEAR(volume(mesh(file), 1), 401 * 20, 1);
  EXPECT_TRUE(last_.warns_of("'Pen' has contours that cross"));
}

TEST_F(StructureSet, ContoursThatCrossALotAreRefused) {
  DRAWN(file, "crossing");
  fails(3, {"mesh", file, "-o", out("a.vtu")}, {"overlaps contour", "'Bad'", "z = 6"});
  EXPECT_NEAR(volume(mesh(file, {"--label", "Good"}), 1), 2000, 1e-6);
}

TEST_F(StructureSet, AnyFamilyOfParallelPlanesIsRead) {
  DRAWN(sagittal, "sagittal");
  EXPECT_NEAR(volume(mesh(sagittal), 1), 8000, 1e-6);
  expect_bounds(bounds(), {99, 119, 10, 30, -40, -20}, 1e-3);
  DRAWN(oblique, "oblique");
  EXPECT_NEAR(volume(mesh(oblique), 1), 8000, 0.1);
  DRAWN(tenths, "oblique_tenths");
  EXPECT_NEAR(volume(mesh(tenths), 1), 8000, 0.01 * 8000);
  DRAWN(unparallel, "unparallel");
  fails(3, {"mesh", unparallel, "-o", out("b.vtu")}, {"parallel", "'Tilted', contour 1"}, {"R.json", "a.obj", "a.vtu"});
}

TEST_F(StructureSet, NumbersAndMoreThanSixtyFourStructures) {
  DRAWN(numbers, "numbers");
  Json r = mesh(numbers);
  EXPECT_EQ(row(r, 1).at("name"), "Zero");
  EXPECT_EQ(row(r, 7).at("name"), "Seven");
  DRAWN(many, "many");
  r = mesh(many);
  ASSERT_EQ(r.at("labels").size(), 90u);
  for (int label = 1; label <= 90; ++label) EXPECT_NEAR(volume(r, label), 600, 1e-3);
}

TEST_F(StructureSet, AskedForButNotDrawnIsAnError) {
  DRAWN(file, "empty");
  fails(3, {"mesh", file, "--label", "Nothing", "-o", out("a.vtu")}, {"'Nothing' has no closed contour", file});
  fails(3, {"mesh", file, "--label", "Heart", "-o", out("a.vtu")}, {"'Heart' is not in the input", "Box"});
  DRAWN(none, "none");
  refuses(none, {"no structure has a closed contour"});
}

TEST_F(StructureSet, DamageIsToldInOneLine) {
  DRAWN(wrong_vr, "wrong_vr");
  refuses(wrong_vr, {"'Box', contour 1"});
  DRAWN(no_number, "no_number");
  refuses(no_number, {"ContourData (3006,0050)", "'Box', contour 1"});
  DRAWN(file, "box");
  const std::string bytes = program::read_file(file);
  refuses(write("half.dcm", bytes.substr(0, bytes.size() / 2)), {"damaged or truncated"});
  refuses(write("start.dcm", bytes.substr(0, 140)), {});
  refuses(write("text.dcm", "this is no DICOM file"), {});
}

double area(const stackmesh::ContourSection& section) {
  double sum = 0;
  for (const stackmesh::ContourPolygon& polygon : section.polygons) {
    double twice = 0;
    for (std::size_t i = 0; i < polygon.points.size(); ++i) {
      const auto &p = polygon.points[i], &q = polygon.points[(i + 1) % polygon.points.size()];
      twice += p[0] * q[1] - p[1] * q[0];
    }
    sum += std::abs(twice) / 2;
  }
  return sum;
}

TEST_F(StructureSet, RealStructuresMeshAndAgreeWithTheirTextContours) {
  const std::string file = program::shared_data("thorax_rtstruct_dicompyler/rtss.dcm");
  if (file.empty()) GTEST_SKIP() << STACKMESH_SHARED_DATA "/thorax_rtstruct_dicompyler/rtss.dcm is not there";
  for (const auto& [label, name] : std::vector<std::pair<int, std::string>>{{5, "Heart"}, {7, "Nodes"}}) {
    // Slices (RTSTRUCT) reach beyond their last contour, plane cuts (.cnt) do not: a round end holds a half of the gap
    // for the ones and a third for the others. All else is the same.
    const double dicom = volume(mesh(file, {"--label", name, "--caps", "round"}), label);
    const std::string text = program::shared_data("thorax_rtstruct_dicompyler/contours/" + name + ".cnt");
    const std::vector<stackmesh::ContourSection> sections = stackmesh::read_contour_file(text).sections;
    const std::size_t n = sections.size();
    const double ends = (area(sections[0]) * (sections[1].z_mm - sections[0].z_mm) +
                         area(sections[n - 1]) * (sections[n - 1].z_mm - sections[n - 2].z_mm)) /
                        6;
    EXPECT_NEAR(volume(mesh(text, {"--caps", "round"}), 1) + ends, dicom, 1e-3 * dicom) << name;
  }
  const Json together = mesh(file, {"--label", "Heart,Lt_Lung,BODY"});
  ASSERT_EQ(together.at("labels").size(), 3u);
  for (const Json& l : together.at("labels")) EXPECT_TRUE(l.at("closed"));
  EXPECT_EQ(info(file).at("labels").size(), 9u);
}

}  // namespace
