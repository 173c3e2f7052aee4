#include "files.h"

#include <stdlib.h>

#include <filesystem>
#include <fstream>

#include "meshio/write_mesh.h"

namespace stackmesh::test {
namespace {

struct Folder {
  std::string path = std::filesystem::temp_directory_path().string() + "/stackmesh_validate_XXXXXX";
  Folder() { path = ::mkdtemp(path.data()); }
  ~Folder() {
    std::error_code none;
    std::filesystem::remove_all(path, none);
  }
};

template <class Mesh>
Mesh marked(Mesh mesh, const std::string& space) {
  mesh.space = space == "lps" ? Space::lps : space == "ras" ? Space::ras : Space::none;
  return mesh;
}

}  // namespace

const std::string& folder() {
  static const Folder one;
  return one.path;
}

std::string write_bytes(const std::string& name, const std::string& bytes) {
  const std::string path = folder() + "/" + name;
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

std::string write_volume_file(const std::string& name, const LabelVolume& v) {
  std::string head = "NRRD0004\ntype: unsigned short\ndimension: 3\nspace: left-posterior-superior\nsizes:";
  for (const int n : v.size) head += " " + std::to_string(n);
  head += "\nspace directions:";
  const auto vector = [](const Vec3& p) {
    char text[128];
    std::snprintf(text, sizeof text, "(%.17g,%.17g,%.17g)", p.x, p.y, p.z);
    return std::string(text);
  };
  for (int k = 0; k < 3; ++k) head += " " + vector(v.spacing_mm[k] * v.axes[k]);
  head += "\nkinds: domain domain domain\nendian: little\nencoding: raw\nspace origin: " + vector(v.origin_mm) + "\n\n";
  std::vector<std::uint16_t> numbers;
  for (const std::uint16_t i : v.voxels) numbers.push_back(static_cast<std::uint16_t>(v.labels[i].number));
  return write_bytes(name, head + std::string(reinterpret_cast<const char*>(numbers.data()), 2 * numbers.size()));
}

std::string write_mesh_file(const std::string& name, const InterfaceComplex& surface, const std::string& space) {
  AtomicFiles files;
  write_surface(files, folder() + "/" + name, marked(surface, space));
  files.commit();
  return folder() + "/" + name;
}

std::string write_mesh_file(const std::string& name, const TetMesh& mesh, const std::string& space) {
  AtomicFiles files;
  write_volume(files, folder() + "/" + name, marked(mesh, space));
  files.commit();
  return folder() + "/" + name;
}

}  // namespace stackmesh::test
