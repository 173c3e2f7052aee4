// DICOM SEG and 3D Slicer's .seg.nrrd, written by pydicom and as plain bytes.
#include "inputs.h"

namespace {

using namespace inputs;

class Segmentation : public InputTest {};

#define WRITTEN(...)                                   \
  written_by("write_segmentations.py", {__VA_ARGS__}); \
  if (IsSkipped() || HasFatalFailure()) return

TEST_F(Segmentation, DicomSegmentsKeepNumberNameColourAndPlace) {
  WRITTEN("seg", "seg_oblique", "seg_all_frames", "seg_groups", "seg_bytes", "seg_no_gap");
  EXPECT_EQ(expect_labels("seg").at("kind"), "dicomseg");
  expect_corners("seg");
  expect_labels("seg_oblique");
  expect_corners("seg_oblique");
  for (const char* name : {"seg_all_frames", "seg_groups", "seg_bytes", "seg_no_gap"}) expect_labels(name);
}

TEST_F(Segmentation, DicomOverlapGoesToTheSmallerOrTheOneNamedFirst) {
  WRITTEN("seg_overlap");
  const std::string file = in("seg_overlap.dcm");
  const Json found = expect_labels("seg_overlap");
  EXPECT_NE(found.at("warnings").dump().find("'liver' and 'spine' overlap in 8 voxels"), std::string::npos)
      << found.at("warnings");
  const double voxel = 0.8 * 0.7 * 2.0;
  Json r = mesh(file, {"--label", "spine,liver"});
  EXPECT_NEAR(row(r, 2).at("input_volume_mm3").get<double>(), 100 * voxel, 1e-9);
  EXPECT_NEAR(row(r, 1).at("input_volume_mm3").get<double>(), 67 * voxel, 1e-9);
  r = mesh(file, {"--label", "spine"});  // what was not requested takes nothing
  EXPECT_NEAR(row(r, 2).at("input_volume_mm3").get<double>(), 100 * voxel, 1e-9);
  EXPECT_FALSE(last_.warns_of("overlap"));
}

TEST_F(Segmentation, DicomFractionsAreCutAtHalfAndLabelMapsAreRead) {
  WRITTEN("seg_fractional", "seg_labelmap", "seg_labelmap8", "seg_rle");
  EXPECT_NE(expect_labels("seg_fractional").at("warnings").dump().find("fractional"), std::string::npos);
  for (const char* name : {"seg_labelmap", "seg_labelmap8", "seg_rle"}) expect_labels(name);
}

TEST_F(Segmentation, DicomFaultsAreToldInOneLine) {
  WRITTEN("seg_mixed", "seg_no_place", "seg_empty", "seg");
  refuses(in("seg_mixed.dcm"), {"different pixel sizes", "frame 2"});
  refuses(in("seg_no_place.dcm"), {"no place", "frame 1"});
  EXPECT_NE(expect_labels("seg_empty").at("warnings").dump().find("'nothing' has no voxel"), std::string::npos);
  fails(3, {"mesh", in("seg_empty.dcm"), "--label", "nothing", "-o", out("a.vtu")}, {"'nothing' has no voxel"});
  const std::string bytes = program::read_file(in("seg.dcm"));
  refuses(write("cut.dcm", bytes.substr(0, bytes.size() - 40)), {"damaged or truncated"});
}

TEST_F(Segmentation, SlicerSegmentsKeepNumberNameColourAndPlace) {
  WRITTEN("nrrd", "nrrd_oblique");
  EXPECT_EQ(expect_labels("nrrd").at("kind"), "seg.nrrd");
  expect_corners("nrrd");
  expect_labels("nrrd_oblique");
  expect_corners("nrrd_oblique");
}

TEST_F(Segmentation, SlicerLayersGoByTheSameRule) {
  WRITTEN("nrrd_layers", "nrrd_same_value", "nrrd_old", "nrrd_bad_layer");
  for (const char* name : {"nrrd_layers", "nrrd_same_value", "nrrd_old"})
    EXPECT_NE(expect_labels(name).at("warnings").dump().find("overlap in 8 voxels"), std::string::npos) << name;
  const Json r = mesh(in("nrrd_layers.seg.nrrd"), {"--label", "spine,liver"});
  EXPECT_NEAR(row(r, 1).at("input_volume_mm3").get<double>(), 67 * 0.8 * 0.7 * 2.0, 1e-9);
  fails(3, {"info", in("nrrd_bad_layer.seg.nrrd")}, {"Segment1_Layer"}, written());
}

TEST_F(Segmentation, ACroppedSlicerFileEndsRoundWhereItsImageGoesOn) {
  WRITTEN("nrrd_cropped", "nrrd_whole", "nrrd_shifted");
  expect_labels("nrrd_cropped");
  const auto ends = [&](const std::string& name) { return row(mesh(in(name + ".seg.nrrd")), 1).at("caps"); };
  EXPECT_EQ(ends("nrrd_whole").at("high"), "flat");     // the last slice is the image's border
  EXPECT_EQ(ends("nrrd_cropped").at("high"), "round");  // the reference image goes on
  EXPECT_EQ(ends("nrrd_shifted").at("high"), "round");  // cropped: where it ends is not known to be a border
}

}  // namespace
