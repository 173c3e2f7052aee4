// DICOM series as labels and as images, and the place of an asymmetric object for each reader.
#include <filesystem>

#include "image/read_image.h"
#include "inputs.h"

namespace {

using namespace inputs;

class Series : public InputTest {};

#define WRITTEN(...)                                   \
  written_by("write_segmentations.py", {__VA_ARGS__}); \
  if (IsSkipped() || HasFatalFailure()) return

TEST_F(Series, OfWholeNumbersIsALabelVolume) {
  WRITTEN("series", "series_oblique", "series_rescaled");
  EXPECT_EQ(expect_labels("series").at("kind"), "dicom");
  expect_corners("series");
  expect_labels("series_oblique");
  expect_corners("series_oblique");
  expect_labels("series_rescaled");
  EXPECT_EQ(info(in("series") + "/s3.dcm").at("labels"), info(in("series")).at("labels"));  // any one of its files
}

TEST_F(Series, MissingDuplicatedAndUnevenSlicesAreNamed) {
  WRITTEN("series_missing", "series_twice", "series_uneven", "series_sheared");
  // The fourth slice comes from a neighbour: the object has the same outline there.
  EXPECT_NE(expect_labels("series_missing").at("warnings").dump().find("missing slices at heights 39 mm"),
            std::string::npos);
  const std::string twice = info(in("series_twice")).at("warnings").dump();
  EXPECT_NE(twice.find("duplicated slices"), std::string::npos) << twice;
  EXPECT_NE(info(in("series_uneven")).at("warnings").dump().find("uneven"), std::string::npos);
  // Intensities are linear between true positions: 1 at 0 mm, 2 at 1, 3 at 3.3, 4 at 4 and 5 at 9 mm, times 7.
  const stackmesh::IntensityVolume image = stackmesh::read_image(in("series_uneven"));
  const auto at = [&](double z) { return *image.sample({-11.5, 20.25, 33.0 + z}); };
  EXPECT_NEAR(at(0), 7, 1e-5);
  EXPECT_NEAR(at(9), 35, 1e-5);
  EXPECT_NEAR(at(6.5), 7 * 4.5, 0.3);
  EXPECT_NEAR(at(2), 7 * (2 + 1 / 2.3), 0.5);
  refuses(in("series_sheared"), {"tilted gantry"});
}

TEST_F(Series, AFolderOfSeveralListsThem) {
  WRITTEN("series_two");
  const Json uids = expected("series_two").at("labels");
  const std::string first = uids[0].at("uid"), second = uids[1].at("uid");
  refuses(in("series_two"), {"2 series", first, second, "--series"});
  EXPECT_EQ(info(in("series_two"), {"--series", second}).at("labels").size(), 2u);
  EXPECT_EQ(info(in("series_two") + "/a2.dcm").at("labels").size(), 2u);
  fails(3, {"info", in("series_two"), "--series", "1.2.3"}, {"1.2.3", first});
}

TEST_F(Series, ACtIsNoLabelVolume) {
  WRITTEN("series_ct");
  refuses(in("series_ct"), {"intensity image", "pixel ("});
}

TEST_F(Series, DamageIsToldInOneLine) {
  WRITTEN("series");
  const std::string file = in("series") + "/s2.dcm", bytes = program::read_file(file);
  const auto replace = [&](const std::string& text) { write("series/s2.dcm", text); };
  replace(bytes.substr(0, bytes.size() - 60));
  refuses(in("series"), {"damaged or truncated"});
  // Pixels in a transfer syntax that nobody decodes here: they are named MPEG-2, and wrapped as compressed pixels are.
  written_by("write_segmentations.py", {"series_mpeg"});
  refuses(in("series_mpeg"), {"MPEG2 Main Profile", "1.2.840.10008.1.2.4.100"});
}

TEST_F(Series, AnImageIsItsNiftiTwin) {
  const std::string folder = program::shared_data("torso_totalseg/ct_dicom");
  if (folder.empty()) GTEST_SKIP() << STACKMESH_SHARED_DATA "/torso_totalseg/ct_dicom is not there";
  const Ended r = program::python("dicom_twin.py", {folder, out("twin.nii.gz")});
  if (r.code == 77) GTEST_SKIP() << r.out;
  ASSERT_EQ(r.code, 0) << r.err;
  const stackmesh::IntensityVolume a = stackmesh::read_image(folder), b = stackmesh::read_image(out("twin.nii.gz"));
  EXPECT_EQ(a.kind, "dicom");
  ASSERT_EQ(a.values.size(), b.values.size());
  double differs = 0;
  for (int k = 0; k < a.size[2]; ++k)
    for (int j = 0; j < a.size[1]; j += 3)
      for (int i = 0; i < a.size[0]; i += 3) {
        const auto there = b.sample(a.world(i, j, k));
        differs = std::max(differs, there ? std::abs(*there - a.values[a.index(i, j, k)]) : 1e9);
      }
  EXPECT_LT(differs, 1e-6 * 3000);

  // Moduli of the elements, bit by bit.
  const std::string law_file = program::testdata("femur_ct_law.json"),
                    labels = program::shared_data("torso_totalseg/abdomen_2mm_slab_31labels.nii.gz");
  for (const auto& [image, name] :
       std::vector<std::pair<std::string, std::string>>{{folder, "dicom.vtu"}, {out("twin.nii.gz"), "nifti.vtu"}})
    succeeds({"fem", labels, "--label", "33", "--no-enhance", "--interpolate", "0", "--order", "1", "--materials",
              law_file, "--image", image, "-o", out(name)});
  EXPECT_NE(program::read_file(out("dicom.vtu")).find("modulus_MPa"), std::string::npos);
  EXPECT_EQ(program::read_file(out("dicom.vtu")), program::read_file(out("nifti.vtu")));
}

TEST_F(Series, EveryOtherVolumeLandsWhereAPythonReaderPutsIt) {
  WRITTEN("nifti", "nifti_oblique", "nifti_left", "meta");
  for (const char* name : {"nifti", "nifti_left", "meta"}) {
    expect_labels(name);
    expect_corners(name);
  }
}

}  // namespace
