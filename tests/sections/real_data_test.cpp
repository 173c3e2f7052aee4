#include <gtest/gtest.h>

#include <filesystem>

#include "image/read_labels.h"
#include "sections/volume_sections.h"
#include "volumes.h"

namespace stackmesh {
namespace {

using namespace testing_support;

/// Every n-th slice of a volume, from the middle of the first n that hold something.
LabelVolume every_nth(const LabelVolume& fine, int n, int& first) {
  first = 0;
  while (area(fine, first, 0) == fine.size[0] * fine.size[1]) ++first;
  first += n / 2;
  LabelVolume thick = fine;
  thick.voxels.clear();
  thick.size[2] = 0;
  for (int k = first; k < fine.size[2]; k += n, ++thick.size[2]) {
    const auto pixels = slice(fine, k);
    thick.voxels.insert(thick.voxels.end(), pixels.begin(), pixels.end());
  }
  thick.spacing_mm[2] *= n;
  return thick;
}

TEST(VolumeSections, GapsThatKeepCloserToTheSlicesAreAWarningWithTheirPlace) {
  Monitor quiet;
  const VolumeSections made =
      volume_sections(read_label_volume(STACKMESH_TESTDATA "/heart4.nii.gz"), SectionOptions{}, quiet);
  ASSERT_EQ(made.warnings.size(), 1u);
  EXPECT_EQ(made.warnings[0].code, WarningCode::held_to_slices);
  EXPECT_EQ(made.warnings[0].where, "slices 11 and 12");
  EXPECT_EQ(made.warnings[0].text.find("between slices 11 and 12 smooth sections would join or split"), 0u)
      << made.warnings[0].text;
}

TEST(VirtualSlicesOnRealData, HeartOfEveryFifthSliceIsRecovered) {
  const std::string path = STACKMESH_SHARED_DATA "/heart_totalseg/heart.nii.gz";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no real data at " << path;
  const LabelVolume fine = read_label_volume(path);
  int first = 0;
  const LabelVolume out = interpolated(every_nth(fine, 5, first), 4).volume;
  double both = 0, either = 0;
  for (int k = 0; k < out.size[2]; ++k) {
    const auto a = slice(fine, first + k), b = slice(out, k);
    for (std::size_t p = 0; p < a.size(); ++p) {
      both += a[p] != 0 && b[p] != 0;
      either += (a[p] != 0) + (b[p] != 0);
    }
  }
  EXPECT_GT(2 * both / either, 0.9724);  // linear shape interpolation on the same slices
}

TEST(VirtualSlicesOnRealData, TorsoKeepsItsComponentsAndHasNoHolesBetweenOrgans) {
  const std::string path = STACKMESH_SHARED_DATA "/torso_totalseg/torso_3mm_61labels.nii.gz";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no real data at " << path;
  int first = 0;
  const LabelVolume thick = every_nth(read_label_volume(path), 4, first);
  const LabelVolume out = interpolated(thick, 3).volume;
  EXPECT_EQ(component_count(out), component_count(thick));
  std::size_t holes = 0;
  for (int k = 0; k + 1 < thick.size[2]; ++k) {
    const auto low = slice(thick, k), high = slice(thick, k + 1);
    for (int j = 1; j <= 3; ++j) {
      const auto here = slice(out, 4 * k + j);
      for (std::size_t p = 0; p < low.size(); ++p) holes += low[p] != 0 && high[p] != 0 && here[p] == 0;
    }
  }
  EXPECT_LE(holes, 10u);  // pixels that no neighbour could take without joining components
}

}  // namespace
}  // namespace stackmesh
