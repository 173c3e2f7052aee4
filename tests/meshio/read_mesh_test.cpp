// The mesh readers against our own writers (which other programs read back, see readback_test) and against files of
// VTK, meshio and Gmsh.
#include "meshio/read_mesh.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <numeric>

#include "base/error.h"
#include "sample_mesh.h"

namespace stackmesh {
namespace {

std::string folder() {
  static const std::string path = [] {
    std::string p = ::testing::TempDir() + "stackmesh_read_XXXXXX";
    return std::string(::mkdtemp(p.data()));
  }();
  return path;
}

std::string written(const std::string& name, const std::string& bytes) {
  const std::string path = folder() + "/" + name;
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

/// Volume enclosed by a label's triangles.
double enclosed(const std::vector<Vec3>& points, const std::vector<InterfaceTriangle>& triangles, Label label) {
  double six = 0;
  const Vec3 o = points[0];
  for (const InterfaceTriangle& t : triangles) {
    const double part = six_volumes(points[t.v[0]] - o, points[t.v[1]] - o, points[t.v[2]] - o);
    if (t.below == label) six += part;
    if (t.above == label) six -= part;
  }
  return six / 6;
}

std::string error_of(const std::string& path, const MeshReadOptions& options = {}) {
  try {
    read_mesh(path, options);
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::input);
    return e.what();
  }
  return "";
}

class ReadsWhatWeWrite : public ::testing::TestWithParam<std::string> {};

TEST_P(ReadsWhatWeWrite, VolumesWithLabelsFrameAndNames) {
  TetMesh mesh = sample_mesh();
  mesh.space = Space::ras;
  MeshWriteOptions options;
  options.labels = sample_labels();
  options.msh2 = GetParam() == "2.msh";
  AtomicFiles files;
  const std::string path = folder() + "/volume" + GetParam();
  write_volume(files, path, mesh, options);
  files.commit();

  const MeshFile read = read_mesh(path);
  ASSERT_EQ(read.tets.size(), mesh.tets.size());
  EXPECT_EQ(read.space, Space::ras);
  EXPECT_EQ(read.points.size(), mesh.points.size() - 1);  // one is used by nothing
  EXPECT_EQ(std::vector<Label>({3, 7, 12}), [&] {
    std::vector<Label> labels = read.tet_labels;
    std::sort(labels.begin(), labels.end());
    labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
    return labels;
  }());
  const TetMesh again = tet_mesh_of(read);
  EXPECT_EQ(again.faces.size(), mesh.faces.size());
  for (const Label label : {3, 7, 12}) {
    EXPECT_NEAR(tet_volume(again, label), tet_volume(mesh, label), 1e-9);
    EXPECT_NEAR(enclosed(again.points, again.faces, label), tet_volume(mesh, label), 1e-9);
  }
  if (GetParam() == "2.msh" || GetParam() == ".msh" || GetParam() == ".inp") {
    ASSERT_EQ(read.names.size(), 3u);
    EXPECT_EQ(read.names[0].number, 3);
    EXPECT_EQ(read.names[0].name, "femur left");
    EXPECT_FALSE(read.numbers_from_names);
  }
}
INSTANTIATE_TEST_SUITE_P(Formats, ReadsWhatWeWrite,
                         ::testing::Values(".vtu", ".vtk", ".msh", "2.msh", ".inp", ".mesh"));

class ReadsSurfacesWeWrite : public ::testing::TestWithParam<std::string> {};

TEST_P(ReadsSurfacesWeWrite, WithVolumeOfEachLabelFile) {
  const TetMesh mesh = sample_mesh();
  MeshWriteOptions options;
  options.per_label = true;
  AtomicFiles files;
  write_surface(files, folder() + "/surface" + GetParam(), sample_surface(mesh), options);
  files.commit();
  for (const Label label : {3, 7, 12}) {
    const MeshFile read = read_mesh(folder() + "/surface_" + std::to_string(label) + GetParam());
    EXPECT_EQ(read.space, Space::lps);
    const bool sides = read.label_source == LabelSource::sides, sets = read.label_source == LabelSource::sets;
    EXPECT_EQ(sides, GetParam() == ".ply" || GetParam() == ".vtp");
    EXPECT_NEAR(enclosed(read.points, read.triangles, sides || sets ? label : 1), tet_volume(mesh, label),
                GetParam() == ".stl" ? 1e-3 : 1e-9)
        << label;
    EXPECT_TRUE(read.tets.empty());
    EXPECT_EQ(read.dropped_triangles, 0u);
    if (GetParam() == ".stl") {
      EXPECT_GT(read.merged_points, 0u);
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Formats, ReadsSurfacesWeWrite, ::testing::Values(".stl", ".ply", ".obj", ".off", ".vtp"));

TEST(ReadMesh, SurfaceOfSeveralLabelsKeepsBothSidesOfEachTriangle) {
  const TetMesh mesh = sample_mesh();
  MeshWriteOptions options;
  options.labels = {{0, ""}, {3, "a"}, {7, "b"}, {12, "c"}};
  AtomicFiles files;
  for (const char* e : {".ply", ".vtp", ".obj"})
    write_surface(files, folder() + "/all" + e, sample_surface(mesh), options);
  files.commit();
  for (const char* e : {".ply", ".vtp"}) {
    const MeshFile read = read_mesh(folder() + "/all" + e);
    for (const Label label : {3, 7, 12})
      EXPECT_NEAR(enclosed(read.points, read.triangles, label), tet_volume(mesh, label), 1e-9) << e;
  }
  const MeshFile named = read_mesh(folder() + "/all.obj");  // an OBJ has the names only
  EXPECT_TRUE(named.numbers_from_names);
  ASSERT_EQ(named.names.size(), 3u);
  for (int k = 0; k < 3; ++k) {
    const Label meant = named.names[k].name == "a" ? 3 : named.names[k].name == "b" ? 7 : 12;
    EXPECT_NEAR(enclosed(named.points, named.triangles, named.names[k].number), tet_volume(mesh, meant), 1e-9);
  }
}

TEST(ReadMesh, TurnsASwappedTetRoundForItsFaces) {
  TetMesh mesh = sample_mesh();
  mesh.faces.clear();
  const double before = enclosed(mesh.points, faces_of_tets(mesh), 3);
  std::swap(mesh.tets[0][0], mesh.tets[0][1]);  // a corner of the block
  EXPECT_NEAR(enclosed(mesh.points, faces_of_tets(mesh), 3), before, 1e-12);
}

const char* const kTetrahedron =
    "solid t\nfacet normal 0 0 nan\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\n"
    "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet\n"
    "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0\nendloop\nendfacet\n"
    "facet normal 0 0 0\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\nendsolid t\n";

TEST(ReadMesh, TextStlWithNormalsThatAreNoNumbers) {
  const MeshFile read = read_mesh(written("t.stl", kTetrahedron));
  EXPECT_EQ(read.points.size(), 4u);
  EXPECT_EQ(read.triangles.size(), 4u);
  EXPECT_NEAR(enclosed(read.points, read.triangles, 1), 1.0 / 6, 1e-12);
}

TEST(ReadMesh, QuadsAndPolygonsBecomeTrianglesAndItSaysSo) {
  const MeshFile read =
      read_mesh(written("box.off",
                        "OFF # SPACE=RAS\n8 6 12\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n"
                        "4 0 3 2 1 255 0 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n"));
  EXPECT_EQ(read.triangles.size(), 12u);
  EXPECT_EQ(read.space, Space::ras);
  EXPECT_NEAR(enclosed(read.points, read.triangles, 1), 1, 1e-12);
  ASSERT_FALSE(read.notes.empty());
  EXPECT_NE(read.notes[0].find("6 quads or polygons"), std::string::npos);
}

TEST(ReadMesh, CoincidentTrianglesOfTwoLabelsBecomeOneInterface) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\nelement face 8\n"
      "property list uchar int vertex_indices\nproperty uchar label\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 -1\n"
      "3 0 2 1 4\n3 0 1 3 4\n3 0 3 2 4\n3 1 2 3 4\n3 0 1 2 9\n3 0 4 1 9\n3 0 2 4 9\n3 1 4 2 9\n";
  const MeshFile read = read_mesh(written("two.ply", text));
  EXPECT_EQ(read.triangles.size(), 7u);
  EXPECT_NEAR(enclosed(read.points, read.triangles, 4), 1.0 / 6, 1e-12);
  EXPECT_NEAR(enclosed(read.points, read.triangles, 9), 1.0 / 6, 1e-12);
}

TEST(ReadMesh, RefusesInOneLine) {
  const struct {
    const char *name, *bytes, *part;
  } kCases[] = {{"a.stl", "", "empty"},
                {"b.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0", "ends within"},
                {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n", "not a finite number"},
                {"b.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "names a point that is not there"},
                {"c.off", "OFF\n900000000 1 0\n0 0 0\n", "claims 900000000 points"},
                {"d.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "no triangle"},
                {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 x\n", "not a number"},
                {"a.ply",
                 "ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nproperty float y\nproperty "
                 "float z\nend_header\n",
                 "claims 99999999999"},
                {"a.vtk",
                 "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 float\n0 0 0 1 0 0 1 1 0 0 "
                 "1 0 0 0 1 1 0 1 1 1 1 0 1 1\n"
                 "CELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n",
                 "1 hexahedra"},
                {"b.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\n", "structured_points"},
                {"a.vtu", "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"4\"",
                 "XML cannot be read"},
                {"a.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n99\n1 0 0 0\n", "claims 99 nodes"},
                {"b.msh", "$MeshFormat\n4.0 0 8\n$EndMeshFormat\n", "4.0 is not read"},
                {"a.inp", "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D8\n1, 1, 1, 1, 1, 1, 1, 1, 1\n", "1 hexahedra"},
                {"b.inp", "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 1,\n", "too few nodes"},
                {"a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n5000000\n0 0 0 0\n", "claims 5000000"},
                {"a.txt", "hello", "ending"}};
  for (const auto& c : kCases) {
    const std::string text = error_of(written(c.name, c.bytes));
    EXPECT_NE(text.find(c.part), std::string::npos) << c.name << ": " << text;
    EXPECT_NE(text.find(c.name), std::string::npos) << text;
    EXPECT_NE(text.find("; "), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
  EXPECT_NE(error_of(folder() + "/absent.stl").find("cannot be opened"), std::string::npos);
}

TEST(ReadMesh, AnStlThatClaimsTwoGigabytesIsRefusedAtOnce) {
  std::string bytes(1024, '\0');
  const std::uint32_t claimed = 40000000;
  std::memcpy(bytes.data() + 80, &claimed, 4);
  const std::string text = error_of(written("big.stl", bytes));
  EXPECT_NE(text.find("claims 40000000 triangles (2000000084 bytes), the file has 1024 bytes"), std::string::npos)
      << text;
}

TEST(ReadMesh, LabelArrayIsNamedOrRefused) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\n"
      "property list uchar int vertex_indices\nproperty int organ\nproperty float density\nend_header\n0 0 0\n1 0 0\n0 "
      "1 0\n0 0 1\n"
      "3 0 2 1 6 0.5\n3 0 1 3 6 0.5\n3 0 3 2 6 0.5\n3 1 2 3 6 0.5\n";
  const std::string path = written("organ.ply", text);
  EXPECT_EQ(read_mesh(path).triangles[0].below, 1);
  MeshReadOptions options;
  options.label_array = "organ";
  EXPECT_EQ(read_mesh(path, options).triangles[0].below, 6);
  options.label_array = "density";
  EXPECT_NE(error_of(path, options).find("holds 0.5, not a whole number"), std::string::npos);
  options.label_array = "absent";
  EXPECT_NE(error_of(path, options).find("no cell array 'absent'"), std::string::npos);
}

}  // namespace
}  // namespace stackmesh
