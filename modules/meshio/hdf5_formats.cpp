// .exo and .med: their writers are in the part stackmesh-hdf5 (parts/hdf5_part.cpp), which is loaded when such a file
// is asked for.
#include "base/installed_part.h"
#include "meshio/formats.h"

namespace stackmesh {
namespace {

template <class Function>
Function* function(const char* name) {
  return reinterpret_cast<Function*>(function_of_part("stackmesh-hdf5", name, ".exo and .med files"));
}

}  // namespace

void write_exodus(const std::string& path, const PreparedMesh& mesh) {
  function<decltype(write_exodus)>("stackmesh_write_exodus")(path, mesh);
}
void write_med(std::FILE* file, const PreparedMesh& mesh) {
  function<decltype(write_med)>("stackmesh_write_med")(file, mesh);
}
void require_hdf5_writers() {
  function<decltype(write_med)>("stackmesh_write_med");
}

}  // namespace stackmesh
