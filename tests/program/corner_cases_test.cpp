// Small and touching shapes through the whole pipeline, with no option at all.
#include <functional>
#include <string>

#include "program.h"

namespace program {
namespace {

class CornerCases : public ProgramTest {
 protected:
  /// A volume of 14 x 13 x 9 voxels of 1 x 1 x `gap` mm.
  std::string volume(double gap, const std::function<int(int, int, int)>& label) const {
    std::string bytes =
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nDimSize = 14 13 "
        "9\nElementSpacing = 1 1 " +
        std::to_string(gap) + "\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n";
    for (int k = 0; k < 9; ++k)
      for (int j = 0; j < 13; ++j)
        for (int i = 0; i < 14; ++i) bytes += static_cast<char>(label(i, j, k));
    return write("v.mha", bytes);
  }

  /// Meshed, closed, filled, and every piece of every label kept; for thin and thick slices.
  void holds(const std::function<int(int, int, int)>& label) const {
    for (double gap : {1.0, 4.0}) {
      SCOPED_TRACE(gap);
      const Ended run = succeeds({"mesh", volume(gap, label), "-o", out("a.vtu"), "--report", out("R.json")});
      const Json r = report();
      EXPECT_EQ(r.at("volume").at("closure"), "verified");
      EXPECT_EQ(r.at("volume").at("inverted"), 0);
      EXPECT_EQ(r.at("surface").at("open_edges"), 0);
      EXPECT_EQ(r.at("surface").at("self_intersections"), 0);
      for (const Json& l : r.at("labels")) {
        SCOPED_TRACE(l.at("label").dump());
        EXPECT_EQ(l.at("closed"), true);
        EXPECT_EQ(l.at("components"), l.at("input_components"));
      }
      EXPECT_FALSE(run.warns_of("components")) << run.err;
    }
  }
};

bool within(int i, int j, int k, int low, int high) {
  return i >= low && i < high && j >= low && j < high && k >= low && k < high;
}

TEST_F(CornerCases, ALabelOfOneVoxelIsKept) {
  holds([](int i, int j, int k) { return i == 4 && j == 5 && k == 4 ? 7 : within(i, j, k, 6, 9) && k < 8 ? 2 : 0; });
}

TEST_F(CornerCases, OneVoxelInsideAnotherLabelIsKept) {
  holds([](int i, int j, int k) { return i == 5 && j == 5 && k == 4 ? 3 : within(i, j, k, 1, 8) ? 1 : 0; });
}

TEST_F(CornerCases, LabelsMayTouchInAVertex) {
  holds([](int i, int j, int k) { return within(i, j, k, 1, 5) ? 1 : within(i, j, k, 5, 8) ? 2 : 0; });
}

TEST_F(CornerCases, LabelsMayTouchInAnEdge) {
  holds([](int i, int j, int k) {
    if (k < 1 || k > 7) return 0;
    return i >= 1 && i < 5 && j >= 1 && j < 6 ? 1 : i >= 5 && i < 10 && j >= 6 && j < 11 ? 2 : 0;
  });
}

TEST_F(CornerCases, PartsOfALabelThatTouchInAnEdgeStayTwo) {
  holds([](int i, int j, int k) {
    if (k < 1 || k > 7) return 0;
    return (i >= 1 && i < 5 && j >= 1 && j < 6) || (i >= 5 && i < 10 && j >= 6 && j < 11) ? 1 : 0;
  });
}

TEST_F(CornerCases, HolesAndCavitiesOfOneVoxelKeepTheLabelClosed) {
  holds([](int i, int j, int k) {
    if (!(i >= 1 && i < 12 && j >= 1 && j < 11 && k >= 1 && k < 8)) return 0;
    if (i == 3 && j == 3) return 0;             // a hole right through
    return i == 8 && j == 7 && k == 4 ? 0 : 1;  // a cavity
  });
}

TEST_F(CornerCases, AShellOfOneVoxelStaysClosed) {
  holds([](int i, int j, int k) {
    const bool outer = i >= 1 && i < 13 && j >= 1 && j < 12 && k >= 1 && k < 8;
    const bool inner = i >= 2 && i < 12 && j >= 2 && j < 11 && k >= 2 && k < 7;
    return outer && !inner ? 4 : 0;
  });
}

TEST_F(CornerCases, NestedShellsOfOneVoxelShareTheirFaces) {
  holds([](int i, int j, int k) {
    const auto box = [&](int by) { return i >= by && i < 14 - by && j >= by && j < 13 - by && k >= by && k < 9 - by; };
    return box(3) ? 3 : box(2) ? 2 : box(1) ? 1 : 0;
  });
}

}  // namespace
}  // namespace program
