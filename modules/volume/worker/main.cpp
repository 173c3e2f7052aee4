// stackmesh-tetgen: the process in which TetGen runs, started by fill_volume() and by nobody else.
#include "volume/worker/tetgen_worker.h"

int main() {
  return stackmesh::tetgen_worker_main();
}
