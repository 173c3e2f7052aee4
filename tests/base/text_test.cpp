// Text, and integers that join into sets.
#include "base/text.h"

#include <gtest/gtest.h>

#include "base/disjoint_sets.h"

namespace stackmesh {
namespace {

TEST(Text, LowerCaseTouchesAsciiLettersOnly) {
  EXPECT_EQ(lower_case("Femur_LEFT.NII.gz"), "femur_left.nii.gz");
  EXPECT_EQ(lower_case("\xc3\x84@[`{Z"), "\xc3\x84@[`{z");
}

TEST(Text, EndsWithComparesTheEnd) {
  EXPECT_TRUE(ends_with("a.vtu", ".vtu"));
  EXPECT_TRUE(ends_with(".vtu", ".vtu"));
  EXPECT_FALSE(ends_with("vtu", ".vtu"));
  EXPECT_FALSE(ends_with("a.vtu.gz", ".vtu"));
}

TEST(Text, NearestNamesComeFirstWhateverTheirCase) {
  const std::vector<std::string> known = {"femur_outer", "femur_cap_low", "femur_cap_high", "tibia_cap_low"};
  EXPECT_EQ(nearest_names("Femur_Cap_Lo", known, 2), "femur_cap_low, femur_cap_high");  // 1 and 4 letters away
  EXPECT_EQ(nearest_names("tibia_cap", known, 1), "tibia_cap_low");
  EXPECT_EQ(nearest_names("x", {}, 3), "");
}

TEST(DisjointSets, TheSmallestMemberNamesASet) {
  DisjointSets sets(5);
  EXPECT_EQ(sets.add(), 5);
  sets.join(5, 3);
  sets.join(3, 1);
  sets.join(0, 4);
  EXPECT_EQ(sets.size(), 6u);
  const std::vector<std::int32_t> meant = {0, 1, 2, 1, 0, 1};
  for (std::int32_t i = 0; i < 6; ++i) EXPECT_EQ(sets.find(i), meant[i]);
}

}  // namespace
}  // namespace stackmesh
