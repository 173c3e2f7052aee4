#include "volume/find_worker.h"

#include <unistd.h>

#include <cstdlib>

#include "base/installed_part.h"

namespace stackmesh::worker {

std::string find_worker() {
  if (const char* set = std::getenv("STACKMESH_WORKER"); set != nullptr && *set != '\0') return set;
  return find_installed("stackmesh-tetgen", X_OK);
}

}  // namespace stackmesh::worker
