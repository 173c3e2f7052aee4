// The part stackmesh-hdf5: the writers of .exo and .med, with their forty libraries.
#include "base/part.h"
#include "meshio/formats.h"

STACKMESH_PART_VERSION_IS(STACKMESH_PART_VERSION)

STACKMESH_OF_PART void stackmesh_write_exodus(const std::string& path, const stackmesh::PreparedMesh& mesh) {
  stackmesh::write_exodus(path, mesh);
}
STACKMESH_OF_PART void stackmesh_write_med(std::FILE* file, const stackmesh::PreparedMesh& mesh) {
  stackmesh::write_med(file, mesh);
}
