// Reads every format back with other people's programs: VTK, meshio, Gmsh.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <set>

#include "sample_mesh.h"

namespace stackmesh {
namespace {

const std::vector<std::string> kVolumes = {".vtu", ".msh", ".inp", ".vtk", ".mesh"};
const std::vector<std::string> kSecondOrderVolumes = {".vtu", ".msh", ".inp", ".vtk"};
const std::vector<std::string> kSurfaces = {".stl", ".ply", ".obj", ".off", ".vtp"};

int run(const std::string& command) {
  std::fflush(nullptr);
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Writes the sample in every format into `folder`, with what a reader must find there.
std::vector<std::string> write_sample(const std::string& folder, Space space) {
  ::mkdir(folder.c_str(), 0777);
  TetMesh mesh = sample_mesh();
  InterfaceComplex surface = sample_surface(mesh);
  mesh.space = surface.space = space;
  MeshWriteOptions options;
  options.labels = sample_labels();
  std::vector<std::string> names;
  AtomicFiles files;
  for (const std::string& e : kVolumes) {
    write_volume(files, folder + "/foo" + e, mesh, options);
    names.push_back("foo" + e);
  }
  options.msh2 = true;
  write_volume(files, folder + "/foo2.msh", mesh, options);
  names.push_back("foo2.msh");
  for (const std::string& e : kSurfaces) {
    options.per_label = false;
    write_surface(files, folder + "/foo" + e, surface, options);
    names.push_back("foo" + e);
    options.per_label = true;
    write_surface(files, folder + "/foo" + e, surface, options);
    for (const char* label : {"_3", "_7", "_12"}) names.push_back(std::string("foo") + label + e);
  }
  files.commit();
  return names;
}

void write_expectation(const std::string& folder, const std::vector<std::string>& names, const std::string& space,
                       const TetMesh& mesh = sample_mesh()) {
  std::ofstream points(folder + "/points.bin", std::ios::binary);
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    if (mesh.points[i].x < 1e6)  // the unused one
      points.write(reinterpret_cast<const char*>(&mesh.points[i]), sizeof(Vec3));
  std::set<std::int32_t> on_surface;
  for (const InterfaceTriangle& t : mesh.faces) on_surface.insert(t.v.begin(), t.v.end());

  std::ofstream json(folder + "/expected.json");
  json.precision(17);
  json << "{\"order\": " << (mesh.mid.empty() ? 1 : 2) << ", \"space\": \"" << space
       << "\", \"points\": " << mesh.points.size() - 1 << ", \"surface_points\": " << on_surface.size()
       << ", \"tets\": " << mesh.tets.size() << ", \"triangles\": " << mesh.faces.size() << ",\n\"files\": [";
  for (std::size_t i = 0; i < names.size(); ++i) json << (i > 0 ? ", " : "") << '"' << names[i] << '"';
  json << "],\n\"labels\": [";
  const struct {
    Label label;
    const char *name, *set;
  } labels[] = {{3, "femur left", "femur_left"}, {7, "label_7", "label_7"}, {12, "femur left_2", "femur_left_2"}};
  for (const auto& l : labels)
    json << (l.label == 3 ? "" : ",\n") << "{\"label\": " << l.label << ", \"name\": \"" << l.name << "\", \"set\": \""
         << l.set << "\", \"tets\": " << std::count(mesh.labels.begin(), mesh.labels.end(), l.label)
         << ", \"volume\": " << tet_volume(mesh, l.label) << "}";
  json << "],\n\"pairs\": [";
  const struct {
    Label below, above;
    const char* name;
  } pairs[] = {{3, 0, "femur left|background"},
               {3, 7, "femur left|label_7"},
               {3, 12, "femur left|femur left_2"},
               {7, 0, "label_7|background"},
               {7, 12, "label_7|femur left_2"}};
  for (const auto& p : pairs) {
    const auto count = std::count_if(mesh.faces.begin(), mesh.faces.end(), [&](const InterfaceTriangle& t) {
      return (t.below == p.below && t.above == p.above) || (t.below == p.above && t.above == p.below);
    });
    json << (p.below == 3 && p.above == 0 ? "" : ",\n") << "{\"below\": " << p.below << ", \"above\": " << p.above
         << ", \"name\": \"" << p.name << "\", \"triangles\": " << count << "}";
  }
  json << "]}\n";
}

int read_back(const std::string& folder) {
  return run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/readback.py' '" + folder + "'");
}

class Readback : public testing::TestWithParam<std::pair<Space, const char*>> {};

TEST_P(Readback, VtkAndMeshioFindTheSameCountsLabelsAndVolumes) {
  const auto [space, name] = GetParam();
  const std::string folder = testing::TempDir() + "stackmesh_readback_" + name;
  write_expectation(folder, write_sample(folder, space), name);
  const int code = read_back(folder);
  if (code == 77 || code == 127)
    GTEST_SKIP() << "NOT TESTED: reading back needs /usr/bin/python3 with python3-vtk9 and python3-meshio";
  EXPECT_EQ(code, 0) << "see the lines above; files in " << folder;
}
INSTANTIATE_TEST_SUITE_P(Spaces, Readback,
                         testing::Values(std::make_pair(Space::lps, "LPS"), std::make_pair(Space::ras, "RAS"),
                                         std::make_pair(Space::none, "")));

/// Writes the second-order sample; the surface file is that of the corners.
std::vector<std::string> write_second_order(const std::string& folder, const TetMesh& mesh) {
  ::mkdir(folder.c_str(), 0777);
  MeshWriteOptions options;
  options.labels = sample_labels();
  std::vector<std::string> names = {"foo.vtp"};
  AtomicFiles files;
  write_surface(files, folder + "/foo.vtp", sample_surface(sample_mesh()), options);
  for (const std::string& e : kSecondOrderVolumes) {
    write_volume(files, folder + "/foo" + e, mesh, options);
    names.push_back("foo" + e);
  }
  options.msh2 = true;
  write_volume(files, folder + "/foo2.msh", mesh, options);
  names.push_back("foo2.msh");
  files.commit();
  return names;
}

TEST(SecondOrderReadback, EveryNodeIsOnItsEdgeInEveryFormat) {
  const std::string folder = testing::TempDir() + "stackmesh_readback_order2";
  const TetMesh mesh = second_order_sample();
  write_expectation(folder, write_second_order(folder, mesh), "LPS", mesh);
  const int code = read_back(folder);
  if (code == 77 || code == 127)
    GTEST_SKIP() << "NOT TESTED: needs /usr/bin/python3 with python3-vtk9 and python3-meshio";
  EXPECT_EQ(code, 0) << "see the lines above; files in " << folder;
}

TEST(SecondOrderReadback, TheScriptSeesTwoNodesExchanged) {
  const std::string folder = testing::TempDir() + "stackmesh_readback_order2_bad";
  TetMesh mesh = second_order_sample();
  for (auto& m : mesh.mid) std::swap(m[4], m[5]);
  write_expectation(folder, write_second_order(folder, mesh), "LPS", mesh);
  const int code = read_back(folder);
  if (code == 77 || code == 127)
    GTEST_SKIP() << "NOT TESTED: needs /usr/bin/python3 with python3-vtk9 and python3-meshio";
  EXPECT_EQ(code, 1);
}

TEST(SecondOrderReadback, GmshChecksTheFilesAndGivesVtkTheSameOrder) {
  if (run("command -v gmsh >/dev/null 2>&1") != 0) GTEST_SKIP() << "NOT TESTED: gmsh is not installed";
  const std::string folder = testing::TempDir() + "stackmesh_gmsh_order2";
  const TetMesh mesh = second_order_sample();
  write_second_order(folder, mesh);
  for (const std::string name : {"foo.msh", "foo2.msh"}) {
    const std::string log = folder + "/" + name + ".log";
    EXPECT_EQ(run("gmsh '" + folder + "/" + name + "' -check - >'" + log + "' 2>&1"), 0) << read_file(log);
    const std::string text = read_file(log);
    EXPECT_NE(text.find(std::to_string(mesh.points.size() - 1) + " nodes"), std::string::npos) << text;
    EXPECT_EQ(text.find("Error"), std::string::npos) << text;
    EXPECT_EQ(text.find("Warning"), std::string::npos) << text;
  }
  // Gmsh writes VTK in VTK's order from what it read in its own.
  ASSERT_EQ(run("cd '" + folder + "' && gmsh foo.msh -save -format vtk -o again.vtk >again.log 2>&1"), 0)
      << read_file(folder + "/again.log");
  std::ofstream(folder + "/order.py") << R"(
import sys
try:
    import vtk, numpy as np
    from vtk.util.numpy_support import vtk_to_numpy
except ImportError:
    sys.exit(77)
reader = vtk.vtkUnstructuredGridReader()
reader.SetFileName('again.vtk')
reader.Update()
grid = reader.GetOutput()
points = vtk_to_numpy(grid.GetPoints().GetData())
seen = 0
for c in range(grid.GetNumberOfCells()):
    if grid.GetCellType(c) != 24:
        continue
    seen += 1
    ids = [grid.GetCell(c).GetPointId(i) for i in range(10)]
    for k, (i, j) in enumerate(((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))):
        a, b, m = points[ids[i]], points[ids[j]], points[ids[4 + k]]
        assert np.linalg.norm(m - (a + b) / 2) < 0.2 * np.linalg.norm(b - a), (c, k)
assert seen == 384, seen
)";
  const int code = run("cd '" + folder + "' && /usr/bin/python3 order.py");
  if (code == 77 || code == 127) GTEST_SKIP() << "NOT TESTED: needs python3-vtk9";
  EXPECT_EQ(code, 0);
}

TEST(ReadbackScript, SeesASwappedLabelAndAMovedPoint) {
  const std::string folder = testing::TempDir() + "stackmesh_readback_bad";
  ::mkdir(folder.c_str(), 0777);
  TetMesh mesh = sample_mesh();
  const std::vector<std::string> names = {"foo.vtp", "foo.vtu"};
  const auto write_and_read = [&](const TetMesh& m) {
    MeshWriteOptions options;
    options.labels = sample_labels();
    AtomicFiles files;
    write_volume(files, folder + "/foo.vtu", m, options);
    write_surface(files, folder + "/foo.vtp", sample_surface(sample_mesh()), options);
    files.commit();
    write_expectation(folder, names, "LPS");
    return read_back(folder);
  };
  const int good = write_and_read(mesh);
  if (good == 77 || good == 127) GTEST_SKIP() << "NOT TESTED: needs python3-vtk9 and python3-meshio";
  EXPECT_EQ(good, 0);
  TetMesh relabelled = mesh;
  std::swap(relabelled.labels[0], *std::find(relabelled.labels.begin(), relabelled.labels.end(), 7));
  relabelled.labels[1] = 12;
  EXPECT_EQ(write_and_read(relabelled), 1);
  TetMesh moved = mesh;
  moved.points[0].x = std::nextafter(moved.points[0].x, 1e9);
  EXPECT_EQ(write_and_read(moved), 1);
}

TEST(Gmsh, ChecksBothVersionsWithoutAComplaint) {
  if (run("command -v gmsh >/dev/null 2>&1") != 0) GTEST_SKIP() << "NOT TESTED: gmsh is not installed";
  const std::string folder = testing::TempDir() + "stackmesh_gmsh";
  write_sample(folder, Space::lps);
  for (const char* name : {"foo.msh", "foo2.msh"}) {
    const std::string log = folder + "/" + name + ".log";
    EXPECT_EQ(run("gmsh '" + folder + "/" + name + "' -check - >'" + log + "' 2>&1"), 0) << read_file(log);
    const std::string text = read_file(log);
    EXPECT_NE(text.find("125 nodes"), std::string::npos) << text;
    EXPECT_NE(text.find("648 elements"), std::string::npos) << text;
    EXPECT_EQ(text.find("Error"), std::string::npos) << text;
    EXPECT_EQ(text.find("Warning"), std::string::npos) << text;
  }
}

TEST(Gmsh, KeepsGroupsAndBoundariesWhenItWritesTheFileAgain) {
  if (run("command -v gmsh >/dev/null 2>&1") != 0) GTEST_SKIP() << "NOT TESTED: gmsh is not installed";
  const std::string folder = testing::TempDir() + "stackmesh_gmsh_again";
  write_sample(folder, Space::lps);
  ASSERT_EQ(run("cd '" + folder + "' && gmsh foo.msh -save -format msh41 -o again.msh >again.log 2>&1"), 0)
      << read_file(folder + "/again.log");
  const std::string text = read_file(folder + "/again.msh");
  EXPECT_NE(text.find("3 3 \"femur left\""), std::string::npos);
  EXPECT_NE(text.find("\"femur left|label_7\""), std::string::npos);
  // Volume 12 lies between surfaces 15 and 17, whose normals point into it.
  EXPECT_NE(text.find("1 12 2 -15 -17"), std::string::npos) << text.substr(0, 2000);
}

}  // namespace
}  // namespace stackmesh
