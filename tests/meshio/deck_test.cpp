// Decks, and second-order meshes in every format: what readers that are not ours find in them.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <set>
#include <thread>

#include "base/error.h"
#include "sample_mesh.h"

namespace stackmesh {
namespace {

int run(const std::string& command) {
  std::fflush(nullptr);
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

int check_formats(const TetMesh& mesh, int order, const std::vector<std::string>& names) {
  const std::string folder = testing::TempDir() + "stackmesh_decks_" + std::to_string(order);
  ::mkdir(folder.c_str(), 0777);
  std::map<Label, int> labels;
  for (const Label l : mesh.labels) ++labels[l];
  double volume = 0;
  for (const auto& [label, count] : labels) volume += tet_volume(mesh, label);
  std::ofstream json(folder + "/expected.json");
  json.precision(17);
  std::set<std::pair<Label, Label>> pairs;
  for (const InterfaceTriangle& t : mesh.faces) pairs.insert(std::minmax(t.below, t.above));
  json << "{\"pairs\": " << pairs.size() << ", \"points\": " << mesh.points.size() - 1
       << ", \"tets\": " << mesh.tets.size() << ", \"triangles\": " << mesh.faces.size() << ", \"order\": " << order
       << ", \"volume\": " << volume << ", \"labels\": {";
  for (const auto& [label, count] : labels)
    json << (label == labels.begin()->first ? "" : ", ") << '"' << label << "\": " << count;
  json << "}, \"files\": [";
  AtomicFiles files;
  for (std::size_t i = 0; i < names.size(); ++i) {
    MeshWriteOptions options;
    options.labels = sample_labels();
    options.msh2 = names[i] == "foo2.msh";
    write_volume(files, folder + "/" + names[i], mesh, options);
    json << (i > 0 ? ", " : "") << '"' << names[i] << '"';
  }
  json << "]}\n";
  json.close();
  files.commit();
  return run("/usr/bin/python3 '" STACKMESH_SOURCE_DIR "/tests/python/decks.py' '" + folder + "'");
}

TEST(Decks, FebioAndNastranHoldTheSampleForOtherReaders) {
  const int code = check_formats(sample_mesh(), 1, {"foo.feb"});
  if (code == 77 || code == 127)
    GTEST_SKIP() << "NOT TESTED: needs /usr/bin/python3 with python3-vtk9 and python3-meshio";
  EXPECT_EQ(code, 0);
}

TEST(Decks, SecondOrderNodesAreOnTheRightEdgesInEveryFormat) {
  TetMesh mesh = sample_mesh();
  mesh = second_order(std::move(mesh));
  const int code = check_formats(mesh, 2, {"foo.vtu", "foo.vtk", "foo.msh", "foo2.msh", "foo.inp", "foo.feb"});
  if (code == 77 || code == 127)
    GTEST_SKIP() << "NOT TESTED: needs /usr/bin/python3 with python3-vtk9 and python3-meshio";
  EXPECT_EQ(code, 0);
}

TEST(Decks, AnsysDynaExodusAndMedHoldMeshAndSetsInBothOrders) {
  for (const int order : {1, 2})
    for (const char* name : {"foo.cdb", "foo.k", "foo.exo", "foo.med"}) {
      const bool med = std::string(name) == "foo.med";
      // NOT TESTED: meshio reads .med with python3-h5py
      if (med && run("/usr/bin/python3 -c 'import h5py' 2>/dev/null") != 0) continue;
      const int code = check_formats(order == 1 ? sample_mesh() : second_order_sample(), order, {name});
      if (code == 77 || code == 127)
        GTEST_SKIP() << "NOT TESTED: needs /usr/bin/python3 with python3-vtk9 and python3-meshio";
      EXPECT_EQ(code, 0) << name << ", order " << order;
    }
}

TEST(Decks, AMedFileThatCannotBeWrittenIsAnErrorAndLeavesNothing) {
  const std::string folder = testing::TempDir() + "stackmesh_full";
  ::mkdir(folder.c_str(), 0777);
  const std::string to = folder + "/full";
  for (const char* ending : {".med", ".exo"}) {
    // A bound on the size of files stands for a full disk.
    const int code =
        run("cd '" + folder +
            "' && (ulimit -f 8; '" STACKMESH_PROGRAM "' mesh '" STACKMESH_TESTDATA "/vessel.nii.gz' -o full" + ending +
            " --quiet) 2>full.log");
    EXPECT_EQ(code, 5) << read_file(folder + "/full.log");
    EXPECT_NE(run("test -e '" + to + ending + "'"), 0);
    EXPECT_NE(run("ls '" + folder + "' | grep -q part"), 0);
  }
}

TEST(Decks, MedFilesOfTheSameMeshHaveTheSameBytesWheneverTheyAreWritten) {
  const std::string folder = testing::TempDir() + "stackmesh_med_bytes";
  ::mkdir(folder.c_str(), 0777);
  const auto written = [&](const std::string& name) {
    AtomicFiles files;
    write_volume(files, folder + "/" + name, sample_mesh(), {});
    files.commit();
    return read_file(folder + "/" + name);
  };
  const std::string first = written("a.med");
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // HDF5 keeps whole seconds
  EXPECT_TRUE(first == written("b.med"));
  EXPECT_GT(first.size(), 10000u);
}

TEST(Decks, GmshReadsTheNastranDeckInBothOrders) {
  if (run("command -v gmsh >/dev/null 2>&1") != 0) GTEST_SKIP() << "NOT TESTED: gmsh is not installed";
  const std::string folder = testing::TempDir() + "stackmesh_decks_bdf";
  ::mkdir(folder.c_str(), 0777);
  for (const int order : {1, 2}) {
    TetMesh mesh = sample_mesh();
    mesh.points.pop_back();
    if (order == 2) mesh = second_order(std::move(mesh));
    AtomicFiles files;
    write_volume(files, folder + "/foo.bdf", mesh, {});
    files.commit();
    ASSERT_EQ(run("cd '" + folder + "' && gmsh foo.bdf -save -format msh22 -o again.msh >again.log 2>&1"), 0) << folder;
    // Gmsh numbers the nodes of a tet as its own format does, so it must find every element positive and the labels as
    // groups.
    std::ifstream file(folder + "/again.msh");
    std::string word;
    std::vector<Vec3> points(mesh.points.size());
    std::map<int, int> labels;
    std::size_t tets = 0;
    while (file >> word) {
      if (word == "$Nodes") {
        std::size_t n = 0, id = 0;
        file >> n;
        ASSERT_EQ(n, mesh.points.size());
        for (std::size_t i = 0; i < n; ++i) {
          Vec3 p;
          file >> id >> p.x >> p.y >> p.z;
          points.at(id - 1) = p;
        }
      } else if (word == "$Elements") {
        std::size_t n = 0;
        file >> n;
        for (std::size_t i = 0; i < n; ++i) {
          int id = 0, type = 0, tags = 0, group = 0, other = 0;
          file >> id >> type >> tags >> group >> other;
          ASSERT_EQ(type, order == 1 ? 4 : 11);
          std::array<std::size_t, 10> v{};
          for (int k = 0; k < (order == 1 ? 4 : 10); ++k) file >> v[k];
          ++labels[other];  // Gmsh takes the property for its entity
          ++tets;
          if (order == 1) continue;
          constexpr int edges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {2, 3}, {1, 3}};  // Gmsh's
          for (int e = 0; e < 6; ++e) {
            const Vec3 a = points.at(v[edges[e][0]] - 1), b = points.at(v[edges[e][1]] - 1),
                       m = points.at(v[4 + e] - 1);
            ASSERT_LT(norm(m - 0.5 * (a + b)), 0.2 * norm(b - a));
          }
        }
      }
    }
    EXPECT_EQ(tets, mesh.tets.size());
    // Gmsh numbers nodes anew.
    std::vector<Vec3> meant = mesh.points;
    for (std::vector<Vec3>* list : {&points, &meant})
      std::sort(list->begin(), list->end(), [](Vec3 a, Vec3 b) {
        const auto key = [](Vec3 p) {
          return std::array<long, 3>{std::lround(1e6 * p.x), std::lround(1e6 * p.y), std::lround(1e6 * p.z)};
        };
        return key(a) < key(b);
      });
    for (std::size_t i = 0; i < points.size(); ++i) ASSERT_LT(norm(points[i] - meant[i]), 1e-9);
    for (const Label l : {3, 7, 12}) EXPECT_EQ(labels[l], std::count(mesh.labels.begin(), mesh.labels.end(), l));
  }
}

TEST(Decks, NastranNumbersKeepWithinSixteenCharacters) {
  TetMesh mesh = sample_mesh();
  const double awkward[] = {-1.2345678901234567e-5, -0.012345678901234567, -123456.78901234567,
                            -1.2345678901234567e-105};
  for (int i = 0; i < 4; ++i) mesh.points[i].x = awkward[i];
  const std::string path = testing::TempDir() + "awkward.bdf";
  AtomicFiles files;
  write_volume(files, path, mesh, {});
  files.commit();
  std::ifstream file(path);
  std::size_t grids = 0;
  for (std::string line; std::getline(file, line);) {
    ASSERT_LE(line.size(), 80u) << line;
    if (line.rfind("GRID*", 0) != 0) continue;
    ASSERT_EQ(line.size(), 72u) << line;
    const std::string x = line.substr(40, 16);
    EXPECT_NE(x.find('.'), std::string::npos) << line;
    if (grids < 4) {
      EXPECT_NEAR(std::stod(x) / awkward[grids], 1, 1e-8) << line;
    }
    ++grids;
  }
  EXPECT_EQ(grids, mesh.points.size() - 1);
}

TEST(Decks, MeditRefusesSecondOrder) {
  AtomicFiles files;
  EXPECT_THROW(write_volume(files, testing::TempDir() + "bad.mesh", second_order(sample_mesh()), {}), Error);
}

}  // namespace
}  // namespace stackmesh
