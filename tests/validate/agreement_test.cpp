// The judge's figures against VTK's, on real meshes; tests/python/judge_agreement.py does the measuring.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <random>

#include "files.h"
#include "meshio/read_mesh.h"

namespace stackmesh {
namespace {

using namespace test;

int run(const std::string& command) {
  std::fflush(nullptr);
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void agrees(const std::string& surface, const std::string& labels, const std::string& label, const std::string& space) {
  const std::string report = folder() + "/agreement.json";
  const int code = run(std::string(STACKMESH_PROGRAM) + " validate " + surface + " --against " + labels + " --label " +
                       label + " --as-stored --mesh-space " + space + " --report " + report + " --quiet 2>/dev/null");
  ASSERT_TRUE(code == 0 || code == 4 || code == 6) << code;
  const int verdict = run("/usr/bin/python3 " STACKMESH_SOURCE_DIR "/tests/python/judge_agreement.py " + surface + " " +
                          labels + " " + label + " " + report + " --space " + space);
  if (verdict == 77) GTEST_SKIP() << "python3-vtk9 or python3-nibabel is missing";
  EXPECT_EQ(verdict, 0);
}

/// A surface of the label with its points shaken, so that many triangles cross.
std::string shaken(const std::string& path, double by, const std::string& name) {
  const MeshFile m = read_mesh(path);
  InterfaceComplex c{m.points, m.triangles};
  std::mt19937 random(5);
  std::uniform_real_distribution<double> step(-by, by);
  for (Vec3& p : c.points) p = p + Vec3{step(random), step(random), step(random)};
  return write_mesh_file(name, c);
}

TEST(JudgeAgreesWithVtk, OnTheHeartShakenUntilItCrosses) {
  const std::string labels = STACKMESH_SHARED_DATA "/heart_totalseg/heart.nii.gz";
  if (!std::filesystem::exists(labels)) GTEST_SKIP() << labels << " is not there";
  const std::string path = folder() + "/heart.vtp";
  ASSERT_EQ(run(std::string(STACKMESH_PROGRAM) + " surface " + labels + " --edge-length 4 --quiet -o " + path), 0);
  agrees(shaken(path, 1.6, "heart_shaken.vtp"), labels, "1", "lps");
}

TEST(JudgeAgreesWithVtk, OnAPublishedMeshOfVentricles) {
  const std::string base = STACKMESH_SHARED_DATA "/ventricles_mri_itksnap/";
  if (!std::filesystem::exists(base)) GTEST_SKIP() << base << " is not there";
  agrees(base + "MRIcrop-ventricle-mesh.vtk", base + "MRIcrop-seg.nii.gz", "1", "lps");
}

TEST(JudgeAgreesWithVtk, OnOneOfManyTouchingLabels) {
  const std::string labels = STACKMESH_SHARED_DATA "/ventricles_mri_itksnap/MRIcrop-seg.nii.gz";
  if (!std::filesystem::exists(labels)) GTEST_SKIP() << labels << " is not there";
  const std::string path = folder() + "/callosum.vtp";
  ASSERT_EQ(run(std::string(STACKMESH_PROGRAM) + " surface " + labels + " --label 8 --band 0 --quiet -o " + path), 0);
  agrees(shaken(path, 0.5, "callosum_shaken.vtp"), labels, "8", "lps");
}

}  // namespace
}  // namespace stackmesh
