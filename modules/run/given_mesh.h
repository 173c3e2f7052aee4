#pragma once
// A volume mesh that is given in place of labels: internal to the module.
#include <array>
#include <map>
#include <string>
#include <vector>

#include "meshio/read_mesh.h"
#include "run/fem_run.h"
#include "run/mesh_product.h"

namespace stackmesh {

/// Reads a volume mesh to make a solver model of it, and judges it. It is in LPS, or without anatomy, in between.
class GivenMesh {
 public:
  explicit GivenMesh(const FemRunOptions& options) : o_(options) {}

  /// The mesh with the labels that are kept; the report gets its `input` and warnings.
  /// @throws Error(input) where it has no tetrahedra, or a label that is not above 0
  /// @throws Error(usage) where the options need what it does not have
  MeshProduct read(const std::string& path, RunReport& report);

  /// Judges the mesh; the report gets its figures. Nodes at one place are joined where parts will be split again, and
  /// mid-side nodes are left out of a mesh that is to be of first order.
  /// @throws Error(input) listing the elements whose Jacobian is not positive
  void check(MeshProduct& product, RunReport& report);

  /// For each of the mesh's faces the void on its open side, 0: none; empty where the file names no voids.
  std::vector<Label> voids_behind(const std::vector<InterfaceTriangle>& faces) const;

  /// The voids that the file names.
  const std::vector<LabelInfo>& voids() const { return voids_; }

  /// The space in which the model is written.
  Space written() const { return written_; }

 private:
  void check_elements(const TetMesh& mesh, const RunReport& report) const;
  void take_labels(const MeshFile& file, const std::string& path, MeshProduct& product);
  void keep_labels(MeshProduct& product) const;
  void judge(const TetMesh& mesh, RunReport& report) const;

  const FemRunOptions& o_;
  std::map<std::array<std::int32_t, 3>, Label> walls_;  // its faces on voids, by their sorted corners
  std::vector<LabelInfo> voids_;
  Space written_ = Space::lps;
};

}  // namespace stackmesh
