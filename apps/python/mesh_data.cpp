#include "mesh_data.h"

#include <cstddef>
#include <utility>

#include "base/error.h"
#include "meshio/prepared_mesh.h"

namespace stackmesh::python {
namespace {

namespace py = pybind11;

static_assert(sizeof(Vec3) == 3 * sizeof(double), "points are rows of three numbers");
static_assert(offsetof(InterfaceTriangle, above) == offsetof(InterfaceTriangle, below) + sizeof(Label),
              "labels of a triangle are a row of two numbers");

}  // namespace

MeshData::MeshData(MadeMesh made) : write_(std::move(made.write)), has_voids_(made.has_voids) {
  // As files have them: preparing what was prepared changes nothing.
  PreparedMesh surface = prepare_surface(made.surface, write_, "the mesh");
  surface_.space = made.surface.space;
  surface_.points = std::move(surface.points);
  surface_.triangles = std::move(surface.triangles);
  labels_ = std::move(surface.named);
  if (!made.tets) return;
  PreparedMesh volume = prepare_volume(*made.tets, write_, "the mesh");
  const Space space = made.tets->space;
  made.tets.reset();
  tets_.emplace().space = space;
  tets_->points = std::move(volume.points);
  tets_->tets = std::move(volume.tets);
  tets_->mid = std::move(volume.tet_mids);
  tets_->faces = std::move(volume.triangles);
  tets_->wedges = std::move(volume.wedges);
  tets_->wedge_mid = std::move(volume.wedge_mids);
  for (const LabelGroup& g : volume.labels) tets_->labels.resize(g.end, g.label);
  const std::size_t tets = tets_->labels.size();
  for (const LabelGroup& g : volume.labels) tets_->labels.resize(tets + g.wedge_end, g.label);
  labels_ = std::move(volume.named);
}

const std::vector<Vec3>& MeshData::points_of(bool surface) const {
  return surface || !tets_ ? surface_.points : tets_->points;
}

const std::vector<InterfaceTriangle>& MeshData::triangles_of(bool surface) const {
  return surface || !tets_ ? surface_.triangles : tets_->faces;
}

py::array MeshData::view(const char* type, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
                         const void* at) const {
  static const double nothing = 0;  // what an empty array points to
  py::array array(py::dtype(type), std::move(shape), std::move(strides), at != nullptr ? at : &nothing,
                  py::cast(shared_from_this()));
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

py::array MeshData::points(bool surface) const {
  const auto& p = points_of(surface);
  return view("f8", {static_cast<py::ssize_t>(p.size()), 3}, {sizeof(Vec3), sizeof(double)}, p.data());
}

py::array MeshData::triangles(bool surface) const {
  const auto& t = triangles_of(surface);
  return view("i4", {static_cast<py::ssize_t>(t.size()), 3}, {sizeof(InterfaceTriangle), sizeof(std::int32_t)},
              t.empty() ? nullptr : t[0].v.data());
}

py::array MeshData::triangle_labels(bool surface) const {
  const auto& t = triangles_of(surface);
  return view("i4", {static_cast<py::ssize_t>(t.size()), 2}, {sizeof(InterfaceTriangle), sizeof(Label)},
              t.empty() ? nullptr : &t[0].below);
}

py::array MeshData::tets() const {
  const py::ssize_t n = tets_ ? static_cast<py::ssize_t>(tets_->tets.size()) : 0;
  return view("i4", {n, 4}, {4 * sizeof(std::int32_t), sizeof(std::int32_t)}, n > 0 ? tets_->tets.data() : nullptr);
}

py::array MeshData::tet_mids() const {
  const py::ssize_t n = tets_ ? static_cast<py::ssize_t>(tets_->mid.size()) : 0;
  return view("i4", {n, 6}, {6 * sizeof(std::int32_t), sizeof(std::int32_t)}, n > 0 ? tets_->mid.data() : nullptr);
}

py::array MeshData::tet_labels() const {
  const py::ssize_t n = tets_ ? static_cast<py::ssize_t>(tets_->tets.size()) : 0;
  return view("i4", {n}, {sizeof(Label)}, n > 0 ? tets_->labels.data() : nullptr);
}

py::array MeshData::wedges() const {
  const py::ssize_t n = tets_ ? static_cast<py::ssize_t>(tets_->wedges.size()) : 0;
  return view("i4", {n, 6}, {6 * sizeof(std::int32_t), sizeof(std::int32_t)}, n > 0 ? tets_->wedges.data() : nullptr);
}

py::array MeshData::wedge_mids() const {
  const py::ssize_t n = tets_ ? static_cast<py::ssize_t>(tets_->wedge_mid.size()) : 0;
  return view("i4", {n, 9}, {9 * sizeof(std::int32_t), sizeof(std::int32_t)},
              n > 0 ? tets_->wedge_mid.data() : nullptr);
}

py::array MeshData::wedge_labels() const {
  const py::ssize_t n = tets_ ? static_cast<py::ssize_t>(tets_->wedges.size()) : 0;
  return view("i4", {n}, {sizeof(Label)}, n > 0 ? tets_->labels.data() + tets_->tets.size() : nullptr);
}

void MeshData::save(const std::string& path, bool surface_only, std::optional<bool> per_label,
                    std::optional<bool> msh2) const {
  MeshWriteOptions write = write_;
  if (per_label && *per_label != write.per_label) {
    if (has_voids_)
      fail_usage("a mesh with voids has one form of surface", "per_label of save('" + path + "')",
                 "give per_label to mesh() or surface()");
    write.per_label = *per_label;
  }
  if (msh2) write.msh2 = *msh2;
  AtomicFiles files;
  if (is_surface_format(path)) write_surface(files, path, surface_, write);
  else if (tets_ && !surface_only) write_volume(files, path, *tets_, write);
  else
    fail_usage(
        is_volume_format(path) ? "a surface cannot be written to a volume format" : "unknown ending of an output",
        "'" + path + "'", "choose " + surface_endings());
  files.commit();
}

}  // namespace stackmesh::python
