// Small parsers of our own for what the files must hold, byte by byte.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstring>
#include <limits>
#include <set>

#include "base/error.h"
#include "sample_mesh.h"

namespace stackmesh {
namespace {

using Triangle = std::array<std::int32_t, 3>;

std::string temporary(const std::string& name) {
  return testing::TempDir() + "stackmesh_" + name;
}

std::string written_surface(const std::string& ending, const InterfaceComplex& surface,
                            const MeshWriteOptions& options) {
  const std::string path = temporary("surface" + ending);
  AtomicFiles files;
  write_surface(files, path, surface, options);
  files.commit();
  return read_file(path);
}

std::string written_volume(const std::string& ending, const TetMesh& mesh, const MeshWriteOptions& options) {
  const std::string path = temporary("volume" + ending);
  AtomicFiles files;
  write_volume(files, path, mesh, options);
  files.commit();
  return read_file(path);
}

/// A unit tetrahedron of label 2, given with its triangles wound inward (from the background into the label).
TetMesh one_tet(Space space = Space::lps) {
  TetMesh mesh;
  mesh.space = space;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.tets = {{0, 1, 2, 3}};
  mesh.labels = {2};
  mesh.faces = {{{0, 1, 2}, 0, 2}, {{0, 3, 1}, 0, 2}, {{0, 2, 3}, 0, 2}, {{1, 3, 2}, 0, 2}};
  return mesh;
}

double enclosed(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  double sum = 0;
  for (const Triangle& t : triangles) sum += six_volumes(points[t[0]], points[t[1]], points[t[2]]) / 6;
  return sum;
}

TEST(WriteSurface, OrientsASingleLabelOutward) {
  const InterfaceComplex surface = sample_surface(one_tet());
  std::istringstream text(written_surface(".off", surface, {}));
  std::string line;
  std::getline(text, line);
  EXPECT_EQ(line, "OFF");
  std::getline(text, line);
  EXPECT_NE(line.find("SPACE=LPS"), std::string::npos);
  std::size_t points = 0, triangles = 0, edges = 0;
  text >> points >> triangles >> edges;
  ASSERT_EQ(points, 4u);
  ASSERT_EQ(triangles, 4u);
  std::vector<Vec3> p(points);
  for (Vec3& q : p) text >> q.x >> q.y >> q.z;
  std::vector<Triangle> t(triangles);
  for (Triangle& v : t) {
    int three = 0;
    text >> three >> v[0] >> v[1] >> v[2];
    EXPECT_EQ(three, 3);
  }
  EXPECT_TRUE(text.good());
  EXPECT_DOUBLE_EQ(enclosed(p, t), 1.0 / 6);
}

TEST(WriteSurface, StlHoldsTheLengthTheMarkAndUnitNormalsOutward) {
  const std::string bytes = written_surface(".stl", sample_surface(one_tet()), {});
  ASSERT_EQ(bytes.size(), 84u + 4 * 50);
  EXPECT_NE(bytes.substr(0, 5), "solid");
  EXPECT_NE(bytes.substr(0, 80).find("SPACE=LPS"), std::string::npos);
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  EXPECT_EQ(count, 4u);
  for (std::uint32_t i = 0; i < count; ++i) {
    float v[12];
    std::memcpy(v, bytes.data() + 84 + 50 * i, sizeof v);
    const Vec3 n{v[0], v[1], v[2]}, a{v[3], v[4], v[5]}, b{v[6], v[7], v[8]}, c{v[9], v[10], v[11]};
    EXPECT_NEAR(norm(n), 1, 1e-6);
    EXPECT_GT(dot(n, cross(b - a, c - a)), 0);
    EXPECT_GT(dot(n, a - Vec3{0.2, 0.2, 0.2}), 0);
  }
}

TEST(WriteSurface, StlMarksRasAndLeavesTheMarkOutWithoutAnatomy) {
  EXPECT_NE(written_surface(".stl", sample_surface(one_tet(Space::ras)), {}).find("SPACE=RAS"), std::string::npos);
  for (const char* ending : {".stl", ".ply", ".obj", ".off", ".vtp"})
    EXPECT_EQ(written_surface(ending, sample_surface(one_tet(Space::none)), {}).find("SPACE"), std::string::npos)
        << ending;
  for (const char* ending : {".vtu", ".msh", ".inp", ".feb", ".bdf", ".vtk", ".mesh"})
    EXPECT_EQ(written_volume(ending, one_tet(Space::none), {}).find("SPACE"), std::string::npos) << ending;
}

TEST(WriteSurface, EveryFormatSaysItsSpace) {
  for (const char* ending : {".stl", ".ply", ".obj", ".off", ".vtp"})
    EXPECT_NE(written_surface(ending, sample_surface(one_tet()), {}).find("SPACE=LPS"), std::string::npos) << ending;
  for (const char* ending : {".vtu", ".msh", ".inp", ".feb", ".bdf", ".vtk", ".mesh"})
    EXPECT_NE(written_volume(ending, one_tet(), {}).find("SPACE=LPS"), std::string::npos) << ending;
}

TEST(WriteSurface, ObjCoordinatesReadBackBitExactAndGroupsFollowThePairs) {
  const TetMesh mesh = sample_mesh();
  MeshWriteOptions options;
  options.labels = sample_labels();
  std::istringstream text(written_surface(".obj", sample_surface(mesh), options));
  std::set<std::array<double, 3>> meant, found;
  for (const InterfaceTriangle& t : mesh.faces)
    for (const std::int32_t v : t.v) meant.insert({mesh.points[v].x, mesh.points[v].y, mesh.points[v].z});
  std::vector<std::string> groups;
  std::string key;
  while (text >> key) {
    if (key == "v") {
      std::string x, y, z;
      text >> x >> y >> z;
      found.insert({std::strtod(x.c_str(), nullptr), std::strtod(y.c_str(), nullptr), std::strtod(z.c_str(), nullptr)});
    } else if (key == "g") {
      groups.emplace_back();
      text >> groups.back();
    } else {
      std::getline(text, key);
    }
  }
  EXPECT_EQ(found, meant);
  EXPECT_EQ(groups, (std::vector<std::string>{"femur_left|background", "femur_left|label_7", "femur_left|femur_left_2",
                                              "label_7|background", "label_7|femur_left_2"}));
}

TEST(WriteSurface, PerLabelFilesAreClosedOutwardAndNamedByTheirLabel) {
  const TetMesh mesh = sample_mesh();
  MeshWriteOptions options;
  options.per_label = true;
  AtomicFiles files;
  write_surface(files, temporary("parts.v1.off"), sample_surface(mesh), options);
  files.commit();
  for (const Label label : {3, 7, 12}) {
    std::istringstream text(read_file(temporary("parts.v1_" + std::to_string(label) + ".off")));
    std::string line;
    std::getline(text, line);
    std::getline(text, line);
    std::size_t points = 0, triangles = 0;
    text >> points >> triangles >> line;
    std::vector<Vec3> p(points);
    for (Vec3& q : p) text >> q.x >> q.y >> q.z;
    std::vector<Triangle> t(triangles);
    std::multiset<std::pair<int, int>> edges;
    for (Triangle& v : t) {
      text >> line >> v[0] >> v[1] >> v[2];
      for (int k = 0; k < 3; ++k) edges.insert({v[k], v[(k + 1) % 3]});
    }
    ASSERT_TRUE(text.good()) << label;
    for (const auto& e : edges) EXPECT_EQ(edges.count(e), edges.count({e.second, e.first}));
    EXPECT_NEAR(enclosed(p, t), tet_volume(mesh, label), 1e-9) << label;
  }
}

TEST(WriteVolume, DeckSurfaceNamesTheFacesOfTheTet) {
  const std::string text = written_volume(".inp", one_tet(), {});
  EXPECT_NE(text.find("*ELEMENT, TYPE=C3D4, ELSET=label_2\n1, 1, 2, 3, 4\n"), std::string::npos) << text;
  EXPECT_NE(text.find("*SURFACE, NAME=S_label_2_background, TYPE=ELEMENT\n1, S1\n1, S2\n1, S4\n1, S3\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("*NSET, NSET=N_label_2_background\n1, 2, 3, 4\n"), std::string::npos) << text;
}

TEST(WriteVolume, DeckNumbersStayWithinTwentyCharactersAndClose) {
  TetMesh mesh = one_tet();
  const double awkward[] = {-1.2345678901234567e-5, -0.012345678901234567, -123456.78901234567,
                            -1.2345678901234567e-105};
  for (int i = 0; i < 4; ++i) mesh.points[i].x += awkward[i];
  std::istringstream text(written_volume(".inp", mesh, {}));
  std::string line;
  while (std::getline(text, line) && line.rfind("*NODE", 0) != 0) continue;
  for (const Vec3 p : mesh.points) {
    std::getline(text, line);
    const std::size_t begin = line.find(", ") + 2, end = line.find(',', begin);
    const std::string number = line.substr(begin, end - begin);
    EXPECT_LE(number.size(), 20u);
    EXPECT_NEAR(std::strtod(number.c_str(), nullptr), p.x, 1e-12 * std::abs(p.x)) << number;
  }
}

TEST(WriteVolume, DeckSetNamesAreLegalAndDistinct) {
  TetMesh mesh = sample_mesh();
  MeshWriteOptions options;
  options.labels = {{3, "3rd rib \"left\""}, {7, "FEMUR"}, {12, "femur"}};
  const std::string text = written_volume(".inp", mesh, options);
  EXPECT_NE(text.find("ELSET=L_3rd_rib__left_\n"), std::string::npos);
  EXPECT_NE(text.find("ELSET=FEMUR\n"), std::string::npos);
  EXPECT_NE(text.find("ELSET=femur_2\n"), std::string::npos);
}

TEST(WriteVolume, RefusesADeckWhoseInterfaceIsNotMadeOfTetFaces) {
  AtomicFiles files;
  TetMesh mesh = one_tet();
  mesh.faces[0].below = 5;  // no tet of label 5: a void on one side, and then nothing on the other
  EXPECT_NO_THROW(write_volume(files, temporary("void.inp"), mesh, {}));
  mesh.faces[0].above = 0;
  EXPECT_THROW(write_volume(files, temporary("bad.inp"), mesh, {}), Error);
  mesh = one_tet();
  mesh.points.push_back({1, 1, 1});
  mesh.tets.push_back({1, 2, 3, 4});
  mesh.labels.push_back(2);
  mesh.faces[0].v = {0, 1, 4};  // corners of the mesh, but no face
  EXPECT_THROW(write_volume(files, temporary("bad.inp"), mesh, {}), Error);
}

TEST(WriteVolume, GmshVolumesListTheirSurfacesWithTheSignOfTheNormal) {
  MeshWriteOptions options;
  options.labels = sample_labels();
  const std::string text = written_volume(".msh", sample_mesh(), options);
  EXPECT_NE(text.find("$MeshFormat\n4.1 0 8\n"), std::string::npos);
  EXPECT_NE(text.find("\n3 3 \"femur left\"\n3 7 \"label_7\"\n3 12 \"femur left_2\"\n"), std::string::npos);
  EXPECT_NE(text.find(" 1 3 3 13 14 15\n"), std::string::npos);
  EXPECT_NE(text.find(" 1 7 3 -14 16 17\n"), std::string::npos);
  EXPECT_NE(text.find(" 1 12 2 -15 -17\n"), std::string::npos);
  options.msh2 = true;
  EXPECT_NE(written_volume(".msh", sample_mesh(), options).find("$MeshFormat\n2.2 0 8\n"), std::string::npos);
}

TEST(WriteVolume, RefusesGmshLabelsBelowOne) {
  TetMesh mesh = one_tet();
  mesh.labels = {-2};
  for (InterfaceTriangle& t : mesh.faces) t.above = -2;
  try {
    AtomicFiles files;
    write_volume(files, temporary("negative.msh"), mesh, {});
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::output);
    EXPECT_NE(std::string(e.what()).find("label -2"), std::string::npos);
  }
}

TEST(WriteVolume, MeditHoldsLabelsAsReferences) {
  const std::string text = written_volume(".mesh", one_tet(), {});
  EXPECT_NE(text.find("Dimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n"), std::string::npos) << text;
  EXPECT_NE(text.find("Tetrahedra\n1\n1 2 3 4 2\nEnd\n"), std::string::npos) << text;
}

TEST(WriteMesh, ASecondWriteIsBitIdentical) {
  const TetMesh mesh = sample_mesh(6);
  for (const char* ending : {".vtu", ".msh", ".inp", ".feb", ".bdf", ".vtk", ".mesh"}) {
    const std::string first = written_volume(ending, mesh, {});
    EXPECT_FALSE(first.empty());
    EXPECT_EQ(first, written_volume(ending, mesh, {})) << ending;
  }
  for (const char* ending : {".stl", ".ply", ".obj", ".off", ".vtp"}) {
    const std::string first = written_surface(ending, sample_surface(mesh), {});
    EXPECT_FALSE(first.empty());
    EXPECT_EQ(first, written_surface(ending, sample_surface(mesh), {})) << ending;
  }
}

TEST(WriteMesh, WindingOfTheInputDoesNotShow) {
  TetMesh turned = sample_mesh();
  for (InterfaceTriangle& t : turned.faces) {
    // The same triangle seen from its other side, beginning with the same corner.
    std::swap(t.v[1], t.v[2]);
    std::swap(t.below, t.above);
  }
  EXPECT_EQ(written_surface(".ply", sample_surface(sample_mesh()), {}),
            written_surface(".ply", sample_surface(turned), {}));
  EXPECT_EQ(written_volume(".vtu", sample_mesh(), {}), written_volume(".vtu", turned, {}));
}

TEST(WriteMesh, KnowsEndingsInAnyCase) {
  EXPECT_TRUE(is_surface_format("a/b.c/heart.STL"));
  EXPECT_TRUE(is_surface_format("x.vtp"));
  EXPECT_TRUE(is_volume_format("x.Msh"));
  EXPECT_FALSE(is_volume_format("x.stl"));
  EXPECT_FALSE(is_surface_format("x.vtu"));
  EXPECT_FALSE(is_surface_format("a.stl/heart"));
  EXPECT_FALSE(is_surface_format("stl"));
  EXPECT_FALSE(is_surface_format(""));
}

ErrorKind kind_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& e) {
    return e.kind();
  }
  ADD_FAILURE() << "no error";
  return ErrorKind::internal;
}

TEST(WriteMesh, ErrorsSayWhatIsWrongAndLeaveNoFile) {
  const std::string path = temporary("broken.vtu");
  AtomicFiles files;
  EXPECT_EQ(kind_of([&] { write_volume(files, temporary("x.docx"), one_tet(), {}); }), ErrorKind::usage);
  EXPECT_EQ(kind_of([&] { write_surface(files, temporary("x.msh"), sample_surface(one_tet()), {}); }),
            ErrorKind::usage);
  EXPECT_EQ(kind_of([&] { write_volume(files, path, TetMesh{}, {}); }), ErrorKind::no_result);
  EXPECT_EQ(kind_of([&] { write_surface(files, temporary("x.stl"), {}, {}); }), ErrorKind::no_result);
  TetMesh mesh = one_tet();
  mesh.tets[0][3] = 4;
  EXPECT_EQ(kind_of([&] { write_volume(files, path, mesh, {}); }), ErrorKind::internal);
  mesh = one_tet();
  mesh.points[2].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(kind_of([&] { write_volume(files, path, mesh, {}); }), ErrorKind::internal);
  files.commit();
  struct stat info;
  EXPECT_NE(::stat(path.c_str(), &info), 0);
}

}  // namespace
}  // namespace stackmesh
