#pragma once
#include <pybind11/numpy.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "run/mesh_run.h"

namespace stackmesh::python {

/// The mesh of a run as its files number it: row n of points() is node n of every file (from 0), row n of tets() its
/// element n. The arrays are views: they copy nothing, keep the mesh alive and cannot be written to.
class MeshData : public std::enable_shared_from_this<MeshData> {
 public:
  explicit MeshData(MadeMesh made);

  bool has_tets() const { return tets_.has_value(); }
  std::string space() const { return to_text(surface_.space); }     ///< "lps", "ras" or "none"
  const std::vector<LabelInfo>& labels() const { return labels_; }  ///< of the mesh, with names that are unique

  /// Of the tetrahedra or, with `surface` (and where there are none), of the surface.
  pybind11::array points(bool surface) const;     ///< (n, 3) float64, mm
  pybind11::array triangles(bool surface) const;  ///< (n, 3) int32
  /// (n, 2) int32: behind and before the triangle, as its normal points
  pybind11::array triangle_labels(bool surface) const;
  pybind11::array tets() const;        ///< (n, 4) int32
  pybind11::array tet_mids() const;    ///< (n, 6) int32; n is 0 for linear tetrahedra
  pybind11::array tet_labels() const;  ///< (n,) int32
  /// (n, 6) int32; of layers. Where corners 2 and 5 are one point it is a pyramid
  pybind11::array wedges() const;
  pybind11::array wedge_mids() const;    ///< (n, 9) int32; n is 0 for linear wedges
  pybind11::array wedge_labels() const;  ///< (n,) int32

  /// Writes one file, in the format of its ending: the bytes that the command line writes. @throws Error
  void save(const std::string& path, bool surface_only, std::optional<bool> per_label, std::optional<bool> msh2) const;

 private:
  const std::vector<Vec3>& points_of(bool surface) const;
  const std::vector<InterfaceTriangle>& triangles_of(bool surface) const;
  pybind11::array view(const char* type, std::vector<pybind11::ssize_t> shape, std::vector<pybind11::ssize_t> strides,
                       const void* at) const;

  InterfaceComplex surface_;
  std::optional<TetMesh> tets_;
  MeshWriteOptions write_;
  bool has_voids_;
  std::vector<LabelInfo> labels_;
};

}  // namespace stackmesh::python
