#pragma once
// Files that a test writes for the judge.
#include <string>

#include "model/complex.h"
#include "model/label_volume.h"
#include "model/tet_mesh.h"

namespace stackmesh::test {

/// A folder that is removed when the test program ends.
const std::string& folder();

/// Writes a label volume as NRRD (raw, LPS).
std::string write_volume_file(const std::string& name, const LabelVolume& volume);
/// Writes a surface or tets with stackmesh's own writer, marked LPS unless told.
std::string write_mesh_file(const std::string& name, const InterfaceComplex& surface, const std::string& space = "lps");
std::string write_mesh_file(const std::string& name, const TetMesh& mesh, const std::string& space = "lps");
std::string write_bytes(const std::string& name, const std::string& bytes);

}  // namespace stackmesh::test
