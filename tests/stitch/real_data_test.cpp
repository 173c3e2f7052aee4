// Raw cracks of real label volumes: closed, no intersections, column volumes, one piece a component.
#include <filesystem>

#include "checks.h"
#include "image/read_labels.h"
#include "validate/check_fidelity.h"

namespace stackmesh {
namespace {

using namespace testing_support;

class RealVolumes : public ::testing::TestWithParam<const char*> {};

TEST_P(RealVolumes, RawAndSimplifiedSurfacesAreClosedAndKeepEveryComponent) {
  const std::string path = std::string(STACKMESH_SHARED_DATA) + "/" + GetParam();
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "SKIPPED: no shared data at " << path;
  const LabelVolume volume = read_label_volume(path);
  for (const double simplify_px : {0.0, 0.5}) {
    StitchOptions options;
    options.caps = Caps::flat;
    Stitched s = stitch_volume(volume, simplify_px, options);
    EXPECT_EQ(defects(s.complex()), "") << "simplify " << simplify_px;  // includes the column integral, to 1e-9
    for (Vec3& p : s.result.complex.points) p = s.stack.frame.to_world(p);
    if (s.stack.frame.mirrors())
      for (InterfaceTriangle& t : s.result.complex.triangles) std::swap(t.v[1], t.v[2]);
    FidelityOptions fidelity;
    fidelity.stack_axis = stacking_axis(volume, StackAxis::automatic);
    fidelity.face_samples = fidelity.surface_samples = 2000;
    for (const LabelFidelity& f : check_fidelity(s.complex(), volume, fidelity)) {
      EXPECT_TRUE(f.components_match) << "label " << f.label << ", simplify " << simplify_px;
      // every voxel centre keeps its label
      EXPECT_EQ(f.dice, 1.0) << "label " << f.label << ", simplify " << simplify_px;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Shared, RealVolumes,
    ::testing::Values("heart_totalseg/heart.nii.gz", "spinal_cord_thick_sct/mt1_wm1_gm2_labels.nii.gz",
                      "spinal_cord_thick_sct/t2_seg-manual_labeled.nii.gz", "ventricles_mri_itksnap/MRIcrop-seg.nii.gz",
                      "torso_totalseg/torso_3mm_61labels.nii.gz", "skull_ct_invesalius/bone_mask.nii.gz"));

}  // namespace
}  // namespace stackmesh
