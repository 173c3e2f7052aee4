// Damaged files: whatever byte is changed, cut or doubled, a reader gives a mesh or one clear error.
// STACKMESH_MUTATIONS sets how many per format (default 400); thousands are for a build with sanitizers (cmake --preset
// debug).
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <random>

#include "base/error.h"
#include "meshio/read_mesh.h"
#include "sample_mesh.h"

namespace stackmesh {
namespace {

const char* const kBase64Vtu =
    "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"><UnstructuredGrid><Piece "
    "NumberOfPoints=\"4\" NumberOfCells=\"1\">"
    "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 "
    "1</DataArray></Points>"
    "<Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"binary\">EAAAAAAAAAABAAAAAgAAAAMAAAA=</DataArray>"
    "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">4</DataArray><DataArray type=\"UInt8\" Name=\"types\" "
    "format=\"ascii\">10</DataArray></Cells>"
    "<CellData><DataArray type=\"Int32\" Name=\"label\" "
    "format=\"ascii\">5</DataArray></CellData></Piece></UnstructuredGrid></VTKFile>";
const char* const kVtk5 =
    "# vtk DataFile Version 5.1\nt\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0\n0 0 "
    "1\nMETADATA\nINFORMATION 0\n\n"
    "POLYGONS 5 12\nOFFSETS vtktypeint64\n0 3 6 9 12\nCONNECTIVITY vtktypeint64\n0 2 1 0 1 3 1 2 3 2 0 3\nCELL_DATA "
    "4\nSCALARS label int\nLOOKUP_TABLE default\n1 1 1 1\n"
    "POINT_DATA 4\nNORMALS Normals float\n0 0 1 0 0 1 0 0 1 0 0 1\n";
const char* const kDeck =
    "*HEADING\nx\n** SPACE=LPS\n*NODE\n1, 0,0,0\n2, 1.,0,0\n3,0,1e0,0\n4,0,0,1\n*ELEMENT, TYPE=C3D4, ELSET=bone\n7, "
    "1,2,3,4\n*ELSET, ELSET=all, GENERATE\n7, 7, 1\n"
    "*SOLID SECTION, ELSET=bone, MATERIAL=m\n";
const char* const kBinaryMsh4Text =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 "
    "1\n$EndNodes\n"
    "$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n";

std::string folder() {
  static const std::string path = [] {
    std::string p = ::testing::TempDir() + "stackmesh_mutate_XXXXXX";
    return std::string(::mkdtemp(p.data()));
  }();
  return path;
}

std::vector<std::pair<std::string, std::string>> samples() {
  std::vector<std::pair<std::string, std::string>> files = {
      {".vtu", kBase64Vtu}, {".vtk", kVtk5}, {".inp", kDeck}, {".msh", kBinaryMsh4Text}};
  const TetMesh mesh = sample_mesh(2);
  AtomicFiles out;
  MeshWriteOptions options;
  for (const char* e : {".vtu", ".msh", ".inp", ".vtk", ".mesh"}) write_volume(out, folder() + "/a" + e, mesh, options);
  options.msh2 = true;
  write_volume(out, folder() + "/b.msh", mesh, options);
  for (const char* e : {".stl", ".ply", ".obj", ".off", ".vtp"})
    write_surface(out, folder() + "/a" + e, sample_surface(mesh), options);
  out.commit();
  for (const char* e : {".vtu", ".msh", ".inp", ".vtk", ".mesh", ".stl", ".ply", ".obj", ".off", ".vtp"})
    files.push_back({e, read_file(folder() + "/a" + e)});
  files.push_back({".msh", read_file(folder() + "/b.msh")});
  return files;
}

std::string mutated(std::string bytes, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  static const char* const kNasty[] = {
      "-1", "0", "99999999999", "4294967295",       "nan", "inf", "1e308", "-2147483649", "18446744073709551615",
      "",   " ", "\n",          "\xff\xff\xff\xff", "\x7f"};
  for (std::size_t n = 1 + below(3); n > 0; --n) {
    const std::size_t at = below(bytes.size());
    switch (below(6)) {
      case 0:
        bytes[at] = static_cast<char>(random());
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3:
        bytes.erase(at, 1 + below(20));
        break;
      case 4:
        bytes.insert(at, bytes.substr(below(bytes.size()), 1 + below(40)));
        break;
      default: {  // a number or word becomes another
        std::size_t end = at;
        while (end < bytes.size() && bytes[end] > ' ' && bytes[end] != ',' && bytes[end] != '"') ++end;
        bytes.replace(at, end - at, kNasty[below(std::size(kNasty))]);
      }
    }
    if (bytes.empty()) return bytes;
  }
  return bytes;
}

TEST(ReadMesh, AnyDamageGivesAMeshOrOneClearError) {
  const char* asked = std::getenv("STACKMESH_MUTATIONS");
  const int rounds = asked ? std::atoi(asked) : 400;
  std::mt19937 random(2026);
  std::size_t read = 0, refused = 0;
  for (const auto& [ending, bytes] : samples()) {
    const std::string path = folder() + "/m" + ending;
    for (int round = 0; round < rounds; ++round) {
      const std::string damaged = mutated(bytes, random);
      std::ofstream(path, std::ios::binary) << damaged;
      try {
        const MeshFile mesh = read_mesh(path);
        ++read;
        for (const InterfaceTriangle& t : mesh.triangles)
          for (const std::int32_t v : t.v) ASSERT_TRUE(v >= 0 && v < static_cast<std::int32_t>(mesh.points.size()));
        if (!mesh.tets.empty()) tet_mesh_of(mesh);
      } catch (const Error& e) {
        ++refused;
        ASSERT_EQ(e.kind(), ErrorKind::input) << e.what();
        ASSERT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        ASSERT_NE(std::string(e.what()).find("; "), std::string::npos) << e.what();
      } catch (const std::exception& e) {
        std::ofstream(folder() + "/culprit" + ending, std::ios::binary) << damaged;
        FAIL() << ending << " " << round << ": " << e.what();
      }
    }
  }
  EXPECT_GT(read, 100u);
  EXPECT_GT(refused, 100u);
}

}  // namespace
}  // namespace stackmesh
