// Drawn contours and thresholded volumes with no option: what made needles and folds, as surfaces and meshes that
// serve.
#include "program.h"

namespace program {
namespace {

class Drawings : public ProgramTest {
 protected:
  void serves(const std::string& name, double least_angle_deg, double least_dihedral_deg) const {
    SCOPED_TRACE(name);
    const std::string path = shared_data(name);
    if (path.empty()) GTEST_SKIP() << "NOT TESTED: needs ../shared/data/" << name;
    succeeds({"mesh", path, "-o", out("a.vtu"), "--report", out("R.json")});
    const Json r = report();
    EXPECT_EQ(r.at("surface").at("level"), "enhanced");
    EXPECT_EQ(r.at("surface").at("open_edges"), 0);
    EXPECT_EQ(r.at("surface").at("self_intersections"), 0);
    EXPECT_GT(r.at("surface").at("angle_min_deg"), least_angle_deg);
    EXPECT_EQ(r.at("volume").at("closure"), "verified");
    EXPECT_GT(r.at("volume").at("dihedral_min_deg"), least_dihedral_deg);
  }
};

TEST_F(Drawings, AFemursFoldsAreTakenOut) {
  serves("femur_proximal/sections/femur_12_50.cnt", 12, 8);
}

TEST_F(Drawings, AVentriclesNeedlesAreTakenOut) {
  serves("heart_sax_sunnybrook/SC-HF-I-1/endo_ED.cnt", 12, 8);
}

TEST_F(Drawings, ASpeckOfATwentiethOfAMillimetreIsKeptAndMeshed) {
  serves("thorax_rtstruct_dicompyler/contours/Lt_Lung.cnt", 5, 5);
}

}  // namespace
}  // namespace program
