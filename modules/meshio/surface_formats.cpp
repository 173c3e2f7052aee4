#include <array>
#include <cstdint>
#include <string>

#include "meshio/formats.h"
#include "meshio/output_buffer.h"

namespace stackmesh {
namespace {

std::string mark_or_empty(const PreparedMesh& mesh, const std::string& before, const std::string& after) {
  return mesh.space.empty() ? "" : before + mesh.space_mark() + after;
}

}  // namespace

// Binary: 80 bytes of header, a count, then 50 bytes a triangle.
void write_stl(std::FILE* file, const PreparedMesh& mesh) {
  OutputBuffer out(file);
  // A header that begins with "solid" would be taken for ASCII.
  std::string header = "stackmesh binary STL, mm" + mark_or_empty(mesh, ". ", "");
  header.resize(80, ' ');
  out << header;
  out.binary(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const InterfaceTriangle& t : mesh.triangles) {
    std::array<float, 12> values{};
    std::array<Vec3, 3> p;
    for (int k = 0; k < 3; ++k) {
      const Vec3 q = mesh.points[t.v[k]];
      values[3 + 3 * k] = static_cast<float>(q.x);
      values[4 + 3 * k] = static_cast<float>(q.y);
      values[5 + 3 * k] = static_cast<float>(q.z);
      // The normal is that of the rounded triangle, which is the one that readers see.
      p[k] = {values[3 + 3 * k], values[4 + 3 * k], values[5 + 3 * k]};
    }
    const Vec3 normal = cross(p[1] - p[0], p[2] - p[0]);
    const double length = norm(normal);
    if (length > 0) {
      values[0] = static_cast<float>(normal.x / length);
      values[1] = static_cast<float>(normal.y / length);
      values[2] = static_cast<float>(normal.z / length);
    }
    out.bytes(values.data(), sizeof values);
    out.binary(std::uint16_t{0});
  }
}

void write_ply(std::FILE* file, const PreparedMesh& mesh) {
  OutputBuffer out(file);
  out << "ply\nformat binary_little_endian 1.0\ncomment stackmesh, mm\n"
      << mark_or_empty(mesh, "comment ", "\n") << "element vertex " << mesh.points.size()
      << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << mesh.triangles.size()
      << "\nproperty list uchar int vertex_indices\nproperty int label_below\nproperty int "
         "label_above\nend_header\n";
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  out.bytes(mesh.points.data(), mesh.points.size() * sizeof(Vec3));
  for (const InterfaceTriangle& t : mesh.triangles) {
    out << '\3';
    out.bytes(t.v.data(), sizeof t.v);
    out.binary(t.below);
    out.binary(t.above);
  }
}

void write_obj(std::FILE* file, const PreparedMesh& mesh) {
  OutputBuffer out(file);
  out << "# stackmesh, mm\n" << mark_or_empty(mesh, "# ", "\n");
  for (const Vec3 p : mesh.points) out << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
  for (const PairGroup& pair : mesh.pairs) {
    std::string name = pair.name;
    for (char& c : name)
      if (c == ' ') c = '_';  // a blank would begin another group
    out << "g " << name << '\n';
    for (std::size_t i = pair.begin; i < pair.end; ++i) {
      const auto& v = mesh.triangles[i].v;
      out << "f " << v[0] + 1 << ' ' << v[1] + 1 << ' ' << v[2] + 1 << '\n';
    }
  }
}

void write_off(std::FILE* file, const PreparedMesh& mesh) {
  OutputBuffer out(file);
  out << "OFF\n# stackmesh, mm" << mark_or_empty(mesh, ". ", "") << '\n';
  out << mesh.points.size() << ' ' << mesh.triangles.size() << " 0\n";
  for (const Vec3 p : mesh.points) out << p.x << ' ' << p.y << ' ' << p.z << '\n';
  for (const InterfaceTriangle& t : mesh.triangles) out << "3 " << t.v[0] << ' ' << t.v[1] << ' ' << t.v[2] << '\n';
}

}  // namespace stackmesh
