#pragma once
#include <string>

namespace stackmesh::worker {

/// The program stackmesh-tetgen: the environment's STACKMESH_WORKER; beside the running program or the library that
/// holds this code, or in their ../libexec/stackmesh; where it was installed. "": it is nowhere.
std::string find_worker();

}  // namespace stackmesh::worker
